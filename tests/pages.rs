//! What a reader of a page finds first, and that it does not contradict the table below it.

mod support;

use std::path::Path;

use support::{run, summary};

/// Runs a command with an output folder, and returns what it printed and its page.
fn page_of(arguments: &[&str], out: &Path) -> (String, String) {
    let all = [arguments, &["--out", out.to_str().expect("a path")]].concat();
    let output = run(&all);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.status.success(),
        "{text}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let page = std::fs::read_to_string(out.join("report.html")).expect("a page");
    (text, page)
}

/// The sentence in the coloured field at the top, and its colour.
fn verdict(page: &str) -> (&str, &str) {
    let field = page.split("<div class=\"verdict ").nth(1).expect("a verdict");
    let (class, rest) = field.split_once("\">").expect("a class");
    (class, rest.split("</div>").next().expect("a sentence"))
}

/// Data of the figure with this title.
fn figure(page: &str, title: &str) -> serde_json::Value {
    let begin = page
        .split(&format!("<h3>{title}</h3>"))
        .nth(1)
        .unwrap_or_else(|| panic!("no figure {title}"));
    let data = begin
        .split("-data\">")
        .nth(1)
        .and_then(|rest| rest.split("</script>").next());
    serde_json::from_str(&data.expect("data").replace("<\\/", "</")).expect("JSON")
}

#[test]
fn a_run_with_a_fault_begins_with_what_happened_and_zooms_to_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("silence");
    let (_, page) = page_of(&["hil", "--scenario", "bus-silence", "--duration-s", "6"], &out);
    let (class, sentence) = verdict(&page);
    let figures = summary(&out);
    let ms = 5.0 * figures["ticks_to_closed"].as_f64().expect("closed");
    assert_eq!(class, "good");
    assert!(
        sentence.contains("Injected from 3.00 s to 3.50 s: messages disturbed."),
        "{sentence}"
    );
    assert!(
        sentence.contains(&format!("all valves were closed after {ms:.1} ms")),
        "{sentence}"
    );
    assert!(sentence.ends_with("all 4 checks are met."), "{sentence}");
    // The verdict stands before every figure, and the lanes before the other figures.
    let at = |text: &str| page.find(text).unwrap_or_else(|| panic!("{text}"));
    assert!(
        at("class=\"verdict") < at("<h3>What happened</h3>")
            && at("<h3>What happened</h3>") < at("<h3>The vehicle</h3>")
    );
    let lanes = figure(&page, "What happened");
    assert_eq!(lanes["layout"]["xaxis"]["range"], serde_json::json!([2.5, 5.0]));
    let names: Vec<&str> = lanes["layout"]["yaxis"]["ticktext"]
        .as_array()
        .expect("lanes")
        .iter()
        .filter_map(|name| name.as_str())
        .collect();
    assert_eq!(names.len(), 17, "{names:?}");
    assert!(
        ["injected", "bus", "mode", "fault", "front left 1", "rear right 3"]
            .iter()
            .all(|name| names.contains(name))
    );
    let states: Vec<&str> = lanes["data"]
        .as_array()
        .expect("states")
        .iter()
        .filter_map(|state| state["name"].as_str())
        .collect();
    assert!(
        ["messages disturbed", "no command arrives", "safe", "open"]
            .iter()
            .all(|state| states.contains(state)),
        "{states:?}"
    );
    // One strut at a time, with the pressure differences across its dampers.
    assert_eq!(page.matches("type=\"radio\"").count(), 4);
    let strut = figure(&page, "Strut rear left");
    let series: Vec<&str> = strut["data"]
        .as_array()
        .expect("series")
        .iter()
        .filter_map(|line| line["name"].as_str())
        .collect();
    assert!(
        series.contains(&"p1 - p2 (damper 1)") && series.contains(&"p3 - p4 (valve 3)"),
        "{series:?}"
    );
    assert!(page.contains("<td>fault injected</td>") && page.contains("<td>mode safe</td>"));
    assert!(
        page.contains("class=\"gauge\"") && page.len() < 3_000_000,
        "{} bytes",
        page.len()
    );
}

#[test]
fn a_failed_check_is_in_the_sentence() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("strict.toml");
    let text = "name = \"strict\"\ndescription = \"A limit that no vehicle meets.\"\nroad = \"iso-c\"\nspeed_km_h = 60\nduration_s = 2\n\
                [[check]]\nmetric = \"max_roll_deg\"\nat_most = 0.001\n";
    std::fs::write(&file, text).expect("a file");
    let out = folder.path().join("strict");
    let arguments = [
        "hil",
        "--scenario",
        file.to_str().expect("a path"),
        "--out",
        out.to_str().expect("a path"),
    ];
    assert_eq!(run(&arguments).status.code(), Some(1));
    let page = std::fs::read_to_string(out.join("report.html")).expect("a page");
    let (class, sentence) = verdict(&page);
    assert!(
        class == "bad" && sentence.contains("1 of 1 checks is not met: max_roll_deg at most 0.001 (is "),
        "{sentence}"
    );
}

#[test]
fn a_drive_that_hits_a_cone_is_not_simply_completed() {
    let folder = tempfile::tempdir().expect("a folder");
    let drive = |name: &str, more: &[&str]| {
        let out = folder.path().join(name);
        let (text, page) = page_of(&[&["drive", "--setting", "baseline"], more].concat(), &out);
        let run = summary(&out)["handling_model"].clone();
        (text, page, run)
    };
    let (text, page, run) = drive("hit", &["--manoeuvre", "lane-change", "--speed-km-h", "60"]);
    assert!(
        run["cone_margin_m"].as_f64().expect("cones") < 0.0,
        "choose another speed: {run}"
    );
    assert_eq!(run["cone_hit"], true);
    let (class, sentence) = verdict(&page);
    assert!(class == "bad" && !sentence.contains("without touching"), "{sentence}");
    if run["ending"] == "completed" {
        assert!(
            sentence.contains("hit a cone") && text.contains("completed, but a cone was hit"),
            "{text}"
        );
    }
    let (_, page, run) = drive("through", &["--manoeuvre", "lane-change", "--speed-km-h", "40"]);
    assert_eq!(
        (&run["cone_hit"], &run["ending"]),
        (&false.into(), &"completed".into()),
        "{run}"
    );
    let (class, sentence) = verdict(&page);
    assert!(
        class == "good" && sentence.contains("without touching a cone"),
        "{sentence}"
    );
    let plan = figure(&page, "From above, to scale");
    assert_eq!(plan["layout"]["xaxis"]["scaleanchor"], "y");
    // Panels are corners, and a colour is a model.
    let loads = figure(&page, "Wheel loads");
    let axes = ["yaxis", "yaxis2", "yaxis3", "yaxis4"].map(|axis| loads["layout"][axis]["title"]["text"].clone());
    assert_eq!(
        axes,
        ["front left, kN", "front right, kN", "rear left, kN", "rear right, kN"]
    );
}

#[test]
fn a_steady_circle_is_drawn_over_lateral_acceleration() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = [
        "drive",
        "--manoeuvre",
        "constant-radius",
        "--setting",
        "baseline",
        "--speed-km-h",
        "40",
        "--duration-s",
        "20",
    ];
    let (_, page) = page_of(&arguments, &folder.path().join("circle"));
    let drawn = figure(&page, "Roll and steer over lateral acceleration");
    assert_eq!(drawn["layout"]["xaxis"]["title"]["text"], "Lateral acceleration, m/s2");
    assert_eq!(drawn["layout"]["yaxis2"]["title"]["text"], "Steer angle, degrees");
    assert!(verdict(&page).1.contains("10.8 to 40.0 km/h"), "{}", verdict(&page).1);
}
