//! Results for other programs, and other programs' results: summaries on standard output, runs as campaigns, foreign tables.

mod support;

use std::path::Path;

use serde_json::Value;
use support::{complaint, run, summary};

/// What a run printed, which must have succeeded.
fn printed(arguments: &[&str]) -> String {
    let output = run(arguments);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.status.success(),
        "{text}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    text
}

/// A summary without what the wall clock decides.
fn steady(mut summary: Value) -> Value {
    for key in ["wall_s", "real_time_factor", "runtime_s"] {
        summary.as_object_mut().expect("an object").remove(key);
    }
    summary
}

#[test]
fn the_summary_on_standard_output_is_that_of_the_folder() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, arguments) in [
        ("hil", &["hil", "--duration-s", "1"][..]),
        ("drive", &["drive", "--manoeuvre", "straight", "--duration-s", "1"]),
        ("rig", &["rig", "bulk-modulus"]),
    ] {
        let out = folder.path().join(name);
        let written = [arguments, &["--format", "json", "--out", out.to_str().expect("a path")]].concat();
        let text = printed(&written);
        assert_eq!(
            text,
            std::fs::read_to_string(out.join("summary.json")).expect("a summary"),
            "{name}"
        );
        // Without a folder nothing is left, and the same is printed.
        let nowhere = [arguments, &["--format", "json", "--no-out"]].concat();
        let text = printed(&nowhere);
        let said: Value = serde_json::from_str(&text).expect("JSON");
        assert_eq!(steady(said), steady(summary(&out)), "{name}");
    }
}

/// The plant's own model, given as the belief, explains what the plant did.
#[test]
fn a_recorded_strut_is_consistent_with_the_model_of_the_plant() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("run");
    let arguments = [
        "hil",
        "--road",
        "iso-c",
        "--duration-s",
        "8",
        "--record",
        "rear-left",
        "--out",
        out.to_str().expect("a path"),
    ];
    let text = printed(&arguments);
    let campaign = out.join("rear-left");
    assert!(
        text.contains(&format!("next: oleo diagnose {}", campaign.display())),
        "{text}"
    );
    let found = folder.path().join("found");
    let diagnosed = printed(&[
        "diagnose",
        campaign.to_str().expect("a path"),
        "--format",
        "json",
        "--out",
        found.to_str().expect("a path"),
    ]);
    let report: Value = serde_json::from_str(&diagnosed).expect("JSON");
    assert_eq!(report["verdict"], "consistent", "{report}");

    // The same recording as a German spreadsheet writes it is the same recording.
    let foreign = folder.path().join("foreign");
    std::fs::create_dir(&foreign).expect("a folder");
    std::fs::copy(campaign.join("model.toml"), foreign.join("model.toml")).expect("a copy");
    let recording = std::fs::read_to_string(campaign.join("belgian.csv")).expect("a recording");
    std::fs::write(foreign.join("belgian.csv"), in_german(&recording)).expect("a file");
    let map = folder.path().join("map.toml");
    std::fs::write(&map, MAP).expect("a file");
    let predict = |recording: &Path, more: &[&str]| {
        let (model, sim) = (campaign.join("model.toml"), folder.path().join("sim.csv"));
        let paths = [&model, &sim].map(|path| path.to_str().expect("a path").to_owned());
        let arguments = [
            &[
                "predict",
                "--model",
                &paths[0],
                recording.to_str().expect("a path"),
                "--out",
                &paths[1],
                "--force",
            ],
            more,
        ]
        .concat();
        printed(&arguments)
    };
    let map = map.to_str().expect("a path");
    let (ours, theirs) = (
        predict(&campaign.join("belgian.csv"), &[]),
        predict(&foreign.join("belgian.csv"), &["--columns", map]),
    );
    assert_eq!(ours, theirs);
    let unmapped = run(&["diagnose", foreign.to_str().expect("a path"), "--no-out"]);
    assert_eq!(unmapped.status.code(), Some(2));
    assert!(complaint(&unmapped).contains("time_s"), "{}", complaint(&unmapped));
    let again = printed(&[
        "diagnose",
        foreign.to_str().expect("a path"),
        "--columns",
        map,
        "--format",
        "json",
        "--no-out",
    ]);
    let again: Value = serde_json::from_str(&again).expect("JSON");
    assert_eq!((&again["verdict"], &again["fit"]), (&report["verdict"], &report["fit"]));
}

const MAP: &str = "separator = \";\"\ndecimal_comma = true\nskip_lines = 1\n[columns]\n\
    time_s = { title = \"Zeit\" }\ndisplacement_m = { title = \"Federweg\" }\nforce_N = { title = \"Kraft\" }\n\
    valve3 = { title = \"Ventil 3\", open = \"auf\", closed = \"zu\" }\n";

/// As a spreadsheet set to German writes it, with a line of its own on top.
fn in_german(recording: &str) -> String {
    let (header, rows) = recording.split_once('\n').expect("a header");
    let header = header
        .replace("time_s", "Zeit")
        .replace("displacement_m", "Federweg")
        .replace("force_N", "Kraft")
        .replace("valve3", "Ventil 3");
    let mut out = format!("\u{feff}Messung am Fahrzeug\r\n{}\r\n", header.replace(',', ";"));
    for row in rows.lines() {
        let (rest, valve3) = row.rsplit_once(',').expect("columns");
        let word = if valve3.starts_with('1') { "auf" } else { "zu" };
        out += &format!("{};{word}\r\n", rest.replace(',', ";").replace('.', ","));
    }
    out
}
