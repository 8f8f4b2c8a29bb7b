//! `oleo drive` and `oleo study` as a user meets them: files whole, the same on any number of threads, one clear line on
//! bad input.

mod support;

use std::path::Path;
use std::process::{Command, Output};

fn oleo(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_oleo"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn summary(folder: &Path) -> serde_json::Value {
    let file = std::fs::read_to_string(folder.join("summary.json")).expect("a summary");
    serde_json::from_str(&file).expect("JSON")
}

#[test]
fn every_manoeuvre_leaves_table_data_summary_and_page() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, more) in [
        ("lane-change", &["--setting", "controlled"][..]),
        ("lane-change-2", &["--setting", "stiff", "--speed-km-h", "50"]),
        ("step-steer", &["--setting", "baseline", "--duration-s", "4"]),
        (
            "constant-radius",
            &["--setting", "baseline", "--duration-s", "20", "--speed-km-h", "40"],
        ),
        (
            "belgian",
            &["--model", "both", "--setting", "baseline", "--duration-s", "3"],
        ),
        ("bump", &["--model", "both", "--setting", "soft", "--speed-km-h", "10"]),
        // `hil` has the same short names.
        (
            "straight",
            &["--model", "ride", "--road", "iso-d", "--duration", "3", "--speed", "50"],
        ),
        ("braking", &["--setting", "soft", "--speed-km-h", "40"]),
        ("braking-in-bend", &["--setting", "baseline", "--road", "iso-c"]),
        ("acceleration", &["--setting", "baseline", "--duration-s", "3"]),
    ] {
        let arguments = [&["drive", "--manoeuvre", name, "--out", name], more].concat();
        let run = oleo(folder.path(), &arguments);
        assert!(run.status.success(), "{name}: {}", text(&run.stderr));
        assert!(text(&run.stdout).contains("completed"), "{name}: {}", text(&run.stdout));
        assert!(run.stderr.is_empty(), "{name}: {}", text(&run.stderr));
        let out = folder.path().join(name);
        support::is_as_documented(&out, "drive");
        let page = std::fs::metadata(out.join("report.html")).expect("a page");
        assert!(page.len() < 8_000_000, "{name}: {} bytes", page.len());
        let data = if name == "straight" {
            "ride-model.csv"
        } else {
            "handling-model.csv"
        };
        assert!(out.join(data).exists(), "{name}");
    }
}

/// Any manoeuvre on any road, by any driver and with any load; a vehicle that rolls over is an outcome, told as one.
#[test]
fn manoeuvres_go_with_roads_drivers_and_loads() {
    let folder = tempfile::tempdir().expect("a folder");
    let lane_change = |name: &str, more: &[&str]| {
        let arguments = [&["drive", "--manoeuvre", "lane-change-2", "--out", name], more].concat();
        let run = oleo(folder.path(), &arguments);
        assert!(run.status.success(), "{name}: {}", text(&run.stderr));
        summary(&folder.path().join(name))["handling_model"].clone()
    };
    let felt = |run: &serde_json::Value| run["weighted_rms_driver_m_s2"].as_f64().expect("a number");
    let flat = lane_change("flat", &["--setting", "soft", "--speed-km-h", "50"]);
    let rough = lane_change(
        "rough",
        &[
            "--setting",
            "soft",
            "--speed-km-h",
            "50",
            "--road",
            "belgian",
            "--entry-m",
            "60",
        ],
    );
    assert_eq!(
        (&flat["ending"], &rough["ending"]),
        (&"completed".into(), &"completed".into())
    );
    assert!(felt(&rough) > 5.0 * felt(&flat), "{flat} {rough}");
    let cold = lane_change(
        "cold",
        &["--setting", "soft", "--speed-km-h", "50", "--gas-temperature-c", "-20"],
    );
    let rise_m = cold["front_rise_m"].as_f64().expect("a number");
    assert!((-0.045..-0.030).contains(&rise_m), "{cold}");
    let roll = |run: &serde_json::Value| run["max_roll_deg"].as_f64().expect("a number");
    assert!(roll(&cold) < roll(&flat), "cold gas is stiffer: {cold} {flat}");
    let slope = &[
        "--setting",
        "baseline",
        "--side-slope-percent",
        "-10",
        "--speed-km-h",
        "40",
    ];
    assert_eq!(lane_change("slope", slope)["ending"], "completed");
    let hard = &["--setting", "baseline", "--driver", "hard", "--load", "roof"];
    assert_eq!(lane_change("hard", hard)["ending"], "rolled over");
}

#[test]
fn bad_input_is_one_line_and_nothing_written() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("car.toml"), "name = \"x\"\n").expect("a file");
    for (arguments, says) in [
        (
            &["drive", "--manoeuvre", "lane-change", "--model", "ride", "--out", "o"][..],
            "neither steer",
        ),
        (
            &["drive", "--manoeuvre", "straight", "--road", "mars", "--out", "o"],
            "mars",
        ),
        (
            &["drive", "--manoeuvre", "bump", "--road", "iso-c", "--out", "o"],
            "a road of its own",
        ),
        (
            &[
                "drive",
                "--manoeuvre",
                "straight",
                "--side-slope-percent",
                "90",
                "--out",
                "o",
            ],
            "--side-slope-percent",
        ),
        (
            &[
                "drive",
                "--manoeuvre",
                "straight",
                "--setting",
                "baseline",
                "--gas-temperature-c",
                "0",
                "--out",
                "o",
            ],
            "no gas",
        ),
        (
            &["drive", "--manoeuvre", "belgian", "--speed-km-h", "-3", "--out", "o"],
            "speed-km-h",
        ),
        (
            &["drive", "--manoeuvre", "belgian", "--vehicle", "car.toml", "--out", "o"],
            "car.toml:1",
        ),
        (
            &[
                "drive",
                "--manoeuvre",
                "belgian",
                "--handling",
                "none.toml",
                "--out",
                "o",
            ],
            "none.toml",
        ),
        (
            &["drive", "--manoeuvre", "step-steer", "--entry-m", "50", "--out", "o"],
            "--entry-m does not belong to the manoeuvre step-steer",
        ),
        (
            &[
                "drive",
                "--manoeuvre",
                "straight",
                "--model",
                "ride",
                "--driver",
                "hard",
                "--out",
                "o",
            ],
            "--driver has nothing to steer in the ride model",
        ),
        (&["study", "optimise", "--ride", "-1", "--out", "o"], "--ride"),
    ] {
        let run = oleo(folder.path(), arguments);
        let line = text(&run.stderr);
        assert_eq!(run.status.code(), Some(2), "{arguments:?}: {line}");
        assert_eq!(line.trim_end().lines().count(), 1, "{line}");
        assert!(line.contains(says), "{line}");
        assert!(!folder.path().join("o").exists(), "{arguments:?}");
    }
}

#[test]
fn the_optimiser_shares_finished_runs_and_does_not_depend_on_threads() {
    let folder = tempfile::tempdir().expect("a folder");
    let optimise = |out: &str, threads: &str| {
        let arguments = [
            "study",
            "optimise",
            "--duration-s",
            "3",
            "--iterations",
            "2",
            "--roll",
            "1",
            "--out",
            out,
        ];
        let run = oleo(folder.path(), &[&arguments[..], &["--threads", threads]].concat());
        assert!(run.status.success(), "{}", text(&run.stderr));
        support::is_as_documented(&folder.path().join(out), "study-optimise");
        (
            summary(&folder.path().join(out)),
            std::fs::read(folder.path().join(out).join("path.csv")).expect("a path"),
        )
    };
    let one = optimise("one", "1");
    assert_eq!(one, optimise("two", "2"));
    let before = std::fs::read(folder.path().join("one").join("runs.csv")).expect("finished runs");
    assert_eq!(one, optimise("one", "2"));
    assert_eq!(
        before,
        std::fs::read(folder.path().join("one").join("runs.csv")).expect("finished runs")
    );
}

/// The comparison of the controller, small: its summary has what is promised, a second run only reads, and the threads do not matter.
#[test]
fn the_control_study_scores_resumes_and_does_not_depend_on_threads() {
    let folder = tempfile::tempdir().expect("a folder");
    let study = |out: &str, threads: &str| {
        let small = ["study", "control", "--quick", "--seeds", "1", "--duration-s", "5"];
        let run = oleo(
            folder.path(),
            &[&small[..], &["--threads", threads, "--out", out]].concat(),
        );
        assert!(run.status.success(), "{}", text(&run.stderr));
        support::is_as_documented(&folder.path().join(out), "study-control");
        summary(&folder.path().join(out))
    };
    let first = study("a", "2");
    for key in [
        "ride_ratio_to_soft",
        "ride_ratio_to_best_fixed",
        "roll_ratio_to_stiff",
        "roll_ratio_to_baseline",
        "decision_s",
        "false_entries_per_km",
    ] {
        assert!(first[key].is_f64(), "{key}: {}", first[key]);
    }
    // Stiff on a flat road, and never worse than the vehicle as sold.
    assert!(first["roll_ratio_to_stiff"].as_f64() < Some(1.01));
    assert!(first["roll_ratio_to_baseline"].as_f64() < Some(1.0));
    let drives = || std::fs::read_to_string(folder.path().join("a/drives.csv")).expect("finished drives");
    let lines = drives().lines().count();
    assert_eq!(study("a", "1"), first);
    assert_eq!(drives().lines().count(), lines, "a second run drives nothing");
    assert_eq!(study("b", "1"), first);
}

#[test]
fn the_robustness_study_draws_the_same_vehicle_alone_and_among_others() {
    let folder = tempfile::tempdir().expect("a folder");
    let vehicles = |out: &str, first: &str, count: &str| {
        let run = oleo(
            folder.path(),
            &["study", "robust", "--first", first, "--vehicles", count, "--out", out],
        );
        assert!(run.status.success(), "{}", text(&run.stderr));
        support::is_as_documented(&folder.path().join(out), "study-robust");
        let file = std::fs::read_to_string(folder.path().join(out).join("vehicles.csv")).expect("vehicles");
        file.lines().skip(1).map(str::to_owned).collect::<Vec<_>>()
    };
    let two = vehicles("two", "3", "2");
    assert_eq!(two.len(), 2);
    assert_eq!(vehicles("one", "4", "1"), two[1..]);
}

#[test]
fn studies_of_the_controller_refuse_what_cannot_be() {
    let folder = tempfile::tempdir().expect("a folder");
    for (arguments, expected) in [
        (
            &["study", "control", "--first-seed", "0"][..],
            "--first-seed 0: give a number from 1 to 1000000",
        ),
        (
            &["study", "control", "--seeds", "0"][..],
            "--seeds 0: give a number from 1 to 1000",
        ),
        (
            &["study", "control", "--duration-s", "NaN"],
            "--duration-s NaN: give a value from 5 to 600",
        ),
        (
            &["study", "robust", "--vehicles", "0"],
            "--vehicles 0: give a number from 1 to 10000000",
        ),
    ] {
        let run = oleo(folder.path(), arguments);
        assert_eq!(run.status.code(), Some(2), "{arguments:?}");
        assert_eq!(text(&run.stderr).trim_end(), format!("error: {expected}"));
    }
}
