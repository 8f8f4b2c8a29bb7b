//! Runs beside each other: what differs, by how much, and whether that is within tolerances.

mod support;

use std::path::Path;

use serde_json::Value;
use support::{complaint, run, summary};

/// Runs a command that must end with this status, and returns what it printed.
fn printed(arguments: &[&str], status: i32) -> String {
    let output = run(arguments);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{text}{complaint}");
    text
}

fn path(path: &Path) -> &str {
    path.to_str().expect("a path")
}

fn entry<'a>(list: &'a Value, name: &str) -> &'a Value {
    (list.as_array().expect("a list").iter())
        .find(|entry| entry["name"] == name)
        .unwrap_or_else(|| panic!("no {name}"))
}

#[test]
fn four_suspensions_are_driven_and_compared() {
    let folder = tempfile::tempdir().expect("a folder");
    let (four, alone, out) = (
        folder.path().join("four"),
        folder.path().join("alone"),
        folder.path().join("out"),
    );
    let drive = ["drive", "--manoeuvre", "step-steer", "--duration-s", "3", "--setting"];
    let text = printed(
        &[&drive[..], &["soft,stiff,controlled,baseline", "--out", path(&four)]].concat(),
        0,
    );
    assert!(text.contains("With all valves open the vehicle"), "{text}");
    printed(&[&drive[..], &["soft", "--out", path(&alone)]].concat(), 0);
    let together = summary(&four);
    assert_eq!(
        together["soft"],
        summary(&alone)["handling_model"],
        "alone and together are the same drive"
    );

    printed(
        &["compare", path(&four), "--reference", "stiff", "--out", path(&out)],
        0,
    );
    let found = &summary(&out)["groups"][0];
    assert_eq!(
        found["runs"],
        serde_json::json!(["stiff", "baseline", "controlled", "soft"])
    );
    let roll = entry(&found["figures"], "max_roll_deg");
    for (run, value) in found["runs"]
        .as_array()
        .expect("runs")
        .iter()
        .zip(roll["values"].as_array().expect("values"))
    {
        assert_eq!(*value, together[run.as_str().expect("a name")]["max_roll_deg"]);
    }
    // The difference of the peaks bounds the largest difference of the traces from below.
    let apart = entry(&found["traces"], "roll_rad")["differences"][2]["largest"]
        .as_f64()
        .expect("a number")
        .abs();
    let peaks = (roll["values"][3].as_f64().expect("soft") - roll["values"][0].as_f64().expect("stiff")).abs();
    assert!(apart.to_degrees() > 0.999 * peaks, "{} {peaks}", apart.to_degrees());
}

#[test]
fn a_run_is_equal_to_itself_and_not_to_another_seed() {
    let folder = tempfile::tempdir().expect("a folder");
    let [first, second, other] = ["first", "second", "other"].map(|name| folder.path().join(name));
    for (seed, out) in [("1", &first), ("1", &second), ("2", &other)] {
        printed(&["hil", "--duration-s", "1", "--seed", seed, "--out", path(out)], 0);
    }
    let text = printed(&["compare", path(&first), path(&second), "--equal", "--no-out"], 0);
    assert!(text.starts_with("All ") && text.contains("are the same"), "{text}");
    let text = printed(&["compare", path(&first), path(&other), "--equal", "--no-out"], 1);
    assert!(text.contains("differ"), "{text}");

    let out = folder.path().join("out");
    let tolerances = folder.path().join("tolerances.toml");
    std::fs::write(&tolerances, "[tolerance]\nticks = 0\nmax_roll_deg = \"0.001 %\"\n").expect("a file");
    let arguments = [
        "--tolerances",
        path(&tolerances),
        "--tolerance",
        "heave_m=1",
        "--out",
        path(&out),
    ];
    let text = printed(&[&["compare", path(&first), path(&other)], &arguments[..]].concat(), 1);
    assert!(text.starts_with("1 of 3 tolerances are not met."), "{text}");
    let checks = &summary(&out)["groups"][0]["checks"];
    for (name, passed) in [("heave_m", true), ("ticks", true), ("max_roll_deg", false)] {
        assert_eq!(entry(checks, name)["passed"], passed, "{name}");
    }
}

/// The plant's own model predicts the recording within twice its noise (the noise of the displacement adds to it); one with less gas
/// does not.
#[test]
fn a_recording_is_held_against_models() {
    let folder = tempfile::tempdir().expect("a folder");
    let (campaign, out) = (folder.path().join("run"), folder.path().join("out"));
    printed(
        &[
            "hil",
            "--duration-s",
            "4",
            "--record",
            "front-left",
            "--out",
            path(&campaign),
        ],
        0,
    );
    let strut = campaign.join("front-left");
    let model = strut.join("model.toml");
    let recording = (std::fs::read_dir(&strut).expect("a folder").flatten())
        .map(|entry| entry.path())
        .find(|file| file.extension().is_some_and(|extension| extension == "csv"))
        .expect("a recording");
    let text = std::fs::read_to_string(&model).expect("a model");
    let wrong = folder.path().join("wrong.toml");
    let gas = text
        .lines()
        .find(|line| line.starts_with("static_gas_volume_m3"))
        .expect("a volume");
    std::fs::write(&wrong, text.replacen(gas, "static_gas_volume_m3 = 2e-4", 1)).expect("a file");
    let arguments = [
        "compare",
        path(&recording),
        "--model",
        path(&model),
        "--model",
        path(&wrong),
        "--out",
        path(&out),
    ];
    printed(&[&arguments[..], &["--tolerance", "p1_Pa=2x"]].concat(), 1);
    let found = &summary(&out)["groups"][0];
    assert_eq!(
        found["runs"],
        serde_json::json!(["recording", "model.toml", "wrong.toml"])
    );
    let ratio = |i: usize| {
        entry(&found["traces"], "p1_Pa")["differences"][i]["noise_ratio"]
            .as_f64()
            .expect("a ratio")
    };
    assert!(ratio(0) < 2.0 && ratio(1) > 10.0, "{} {}", ratio(0), ratio(1));
}

#[test]
fn refusals_are_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let [good, backwards, words] = ["good.csv", "backwards.csv", "words.csv"].map(|name| folder.path().join(name));
    std::fs::write(&good, "time_s,roll_rad\n0,0\n1,1\n").expect("a file");
    std::fs::write(&backwards, "time_s,roll_rad\n1,0\n0,1\n").expect("a file");
    std::fs::write(&words, "time_s,roll_rad\n0,0\n1,much\n").expect("a file");
    let good = path(&good);
    for (arguments, part) in [
        (&["compare", good][..], "is one run; give a second one"),
        (&["compare", good, "nowhere"], "nowhere: cannot be read"),
        (&["compare", good, path(folder.path())], "summary.json: cannot read it"),
        (
            &["compare", good, path(&backwards)],
            "backwards.csv: time_s does not increase at 0",
        ),
        (
            &["compare", good, path(&words)],
            "words.csv:3: roll_rad is \"much\"; a number is needed",
        ),
        (
            &["compare", good, good, "--over", "distance"],
            "there is no column station_m",
        ),
        (&["compare", good, good, "--trace", "rol_rad"], "did you mean roll_rad?"),
        (&["compare", good, good, "--tolerance", "roll_rad"], "write NAME=VALUE"),
        (
            &["compare", good, good, "--tolerance", "roll_rad=-1"],
            "is no tolerance",
        ),
        (
            &["compare", good, good, "--tolerance", "rol_rad=1"],
            "did you mean roll_rad?",
        ),
        (
            &["compare", good, good, "--reference", "bad"],
            "--reference bad: is no run",
        ),
        (
            &["compare", good, "--model", "nowhere.toml"],
            "nowhere.toml: cannot read the model",
        ),
    ] {
        let line = complaint(&run(&[arguments, &["--no-out"]].concat()));
        assert!(line.contains(part), "{arguments:?}: {line}");
    }
}
