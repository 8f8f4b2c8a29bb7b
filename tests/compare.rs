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
    assert!(
        text.starts_with("The tolerances are not met in 1 of 3 comparisons."),
        "{text}"
    );
    let checks = &summary(&out)["groups"][0]["checks"];
    for (name, passed) in [("heave_m", true), ("ticks", true), ("max_roll_deg", false)] {
        assert_eq!(entry(checks, name)["passed"], passed, "{name}");
    }
}

/// The plant's own model predicts the recording within its noise; one with less gas does not. The road is one without impacts.
#[test]
fn a_recording_is_held_against_models() {
    let folder = tempfile::tempdir().expect("a folder");
    let (campaign, out) = (folder.path().join("run"), folder.path().join("out"));
    printed(
        &[
            "hil",
            "--road",
            "iso-c",
            "--seed",
            "2",
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
    printed(&[&arguments[..], &["--tolerance", "p1_Pa=1.2x"]].concat(), 1);
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
    assert!(ratio(0) < 1.2 && ratio(1) > 10.0, "{} {}", ratio(0), ratio(1));
}

/// What is cut off, missing, undefined or infinite is not "the same", and not within a tolerance.
#[test]
fn what_cannot_be_compared_is_not_equal() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| {
        let file = folder.path().join(name);
        std::fs::write(&file, text).expect("a file");
        file
    };
    let whole = write("whole.csv", "time_s,roll_rad,mode\n0,1,a\n1,nan,a\n2,1,a\n3,1,b\n");
    let again = write("again.csv", "time_s,roll_rad,mode\n0,1.0,a\n1,,a\n2,1,a\n3,1,b\n");
    let equal = |other: &Path, status| {
        let arguments = ["compare", path(&whole), path(other), "--equal", "--no-out"];
        printed(&arguments, status);
        printed(
            &[&arguments[..3], &["--tolerance", "roll_rad=0", "--no-out"]].concat(),
            status,
        );
    };
    equal(&again, 0);
    for (name, text) in [
        ("short.csv", "time_s,roll_rad,mode\n0,1,a\n1,nan,a\n"),
        (
            "undefined.csv",
            "time_s,roll_rad,mode\n0,1,a\n1,nan,a\n2,nan,a\n3,1,b\n",
        ),
        ("infinite.csv", "time_s,roll_rad,mode\n0,1,a\n1,nan,a\n2,inf,a\n3,1,b\n"),
        ("without.csv", "time_s,mode\n0,a\n1,a\n2,a\n3,b\n"),
    ] {
        equal(&write(name, text), 1);
    }
    // More than the reference has is not the same, but within: all of the reference is compared.
    let longer = write(
        "longer.csv",
        "time_s,roll_rad,mode,more\n0,1,a,1\n1,nan,a,1\n2,1,a,1\n3,1,b,1\n4,1,b,1\n",
    );
    printed(&["compare", path(&whole), path(&longer), "--equal", "--no-out"], 1);
    printed(
        &[
            "compare",
            path(&whole),
            path(&longer),
            "--tolerance",
            "roll_rad=0",
            "--no-out",
        ],
        0,
    );
}

/// Two recordings or models of one name keep apart, and one without the channel is not within.
#[test]
fn recordings_and_models_of_one_name_keep_apart() {
    let folder = tempfile::tempdir().expect("a folder");
    let [x, y, out] = ["x", "y", "out"].map(|name| folder.path().join(name));
    let model = String::from_utf8(run(&["show", "strut"]).stdout).expect("text");
    let rows: String = (0..200)
        .map(|i| format!("{},0,4e6,4e6,0,0,0\n", 0.002 * f64::from(i)))
        .collect();
    for place in [&x, &y] {
        std::fs::create_dir(place).expect("a folder");
        std::fs::write(place.join("model.toml"), &model).expect("a file");
        std::fs::write(
            place.join("r.csv"),
            format!("time_s,displacement_m,p1_Pa,p2_Pa,valve1,valve2,valve3\n{rows}"),
        )
        .expect("a file");
    }
    let other = y.join("s.csv");
    let text = std::fs::read_to_string(y.join("r.csv")).expect("a file");
    std::fs::write(&other, text.replacen("p1_Pa", "p3_Pa", 1)).expect("a file");
    let files = [
        x.join("r.csv"),
        y.join("r.csv"),
        x.join("model.toml"),
        y.join("model.toml"),
    ];
    let [a, b, m, n] = files.each_ref().map(|file| path(file));
    printed(&["compare", a, b, "--model", m, "--model", n, "--out", path(&out)], 0);
    let written = std::fs::read_dir(&out).expect("a folder").flatten();
    let tables = written
        .filter(|file| file.path().extension().is_some_and(|end| end == "csv"))
        .count();
    assert_eq!(tables, 2, "a file for each recording");
    let arguments = [
        "compare",
        a,
        path(&other),
        "--model",
        m,
        "--tolerance",
        "p1_Pa=1e9",
        "--no-out",
    ];
    let text = printed(&arguments, 1);
    assert!(text.contains("cannot be compared"), "{text}");
}

#[test]
fn refusals_are_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let names = [
        "good.csv",
        "other.csv",
        "twins.csv",
        "bad.toml",
        "backwards.csv",
        "words.csv",
    ];
    let [good, other, twins, bad, backwards, words] = names.map(|name| folder.path().join(name));
    for file in [&good, &other] {
        std::fs::write(file, "time_s,roll_rad\n0,0\n1,1\n").expect("a file");
    }
    std::fs::write(&twins, "time_s,roll_rad,roll_rad\n0,0,0\n1,1,1\n").expect("a file");
    std::fs::write(&bad, "[tolerance]\nroll_rad = \"some\"\n").expect("a file");
    std::fs::write(&backwards, "time_s,roll_rad\n1,0\n0,1\n").expect("a file");
    std::fs::write(&words, "time_s,roll_rad\n0,0\n1,much\n").expect("a file");
    let (good, other) = (path(&good), path(&other));
    for (arguments, part) in [
        (&["compare", good][..], "is one run; give a second one"),
        (&["compare", good, good], "good.csv: is given twice"),
        (
            &["compare", good, path(&twins)],
            "twins.csv:1: there are two columns roll_rad",
        ),
        (
            &["compare", good, other, "--tolerances", path(&bad)],
            "bad.toml:1: tolerance roll_rad: \"some\" is no tolerance",
        ),
        (
            &["compare", good, other, "--tolerance", "roll_rad=2x"],
            "no model states a noise of roll_rad",
        ),
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
            &["compare", good, other, "--over", "distance"],
            "there is no column station_m",
        ),
        (
            &["compare", good, other, "--trace", "rol_rad"],
            "did you mean roll_rad?",
        ),
        (&["compare", good, other, "--tolerance", "roll_rad"], "write NAME=VALUE"),
        (
            &["compare", good, other, "--tolerance", "roll_rad=-1"],
            "is no tolerance",
        ),
        (
            &["compare", good, other, "--tolerance", "rol_rad=1"],
            "did you mean roll_rad?",
        ),
        (
            &["compare", good, other, "--reference", "bad"],
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
