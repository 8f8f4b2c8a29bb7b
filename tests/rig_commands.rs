//! `oleo rig` and `oleo predict` as a user meets them: files whole, exit status, one clear line on bad input.

mod support;

use std::path::Path;
use std::process::{Command, Output};

use oleo_plant_sim::strut::StrutModel;

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

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[test]
fn every_measurement_leaves_table_data_summary_and_page() {
    let folder = tempfile::tempdir().expect("a folder");
    for (measurement, data) in [
        ("spring", "characteristic_stiff.csv"),
        ("damping", "damping_low.csv"),
        ("bulk-modulus", "oil.csv"),
        ("valve-response", "valve_response.csv"),
        ("replay", "illustrative.csv"),
        ("limits", "summary.json"),
    ] {
        let run = oleo(folder.path(), &["rig", measurement, "--out", measurement]);
        assert!(run.status.success(), "{measurement}: {}", text(&run.stderr));
        assert!(text(&run.stdout).lines().count() > 4, "{measurement} prints a table");
        let said = text(&run.stderr);
        assert!(
            !said.contains(['\r', '\u{1b}']),
            "no progress bar without a terminal: {said}"
        );
        let written = files(&folder.path().join(measurement));
        for name in [data, "summary.json", "report.html"] {
            assert!(
                written.iter().any(|file| file == name),
                "{measurement}: {name} in {written:?}"
            );
        }
        let summary = std::fs::read_to_string(folder.path().join(measurement).join("summary.json")).expect("a file");
        serde_json::from_str::<serde_json::Value>(&summary).expect("JSON");
        support::is_as_documented(&folder.path().join(measurement), &format!("rig-{measurement}"));
        let page = std::fs::metadata(folder.path().join(measurement).join("report.html")).expect("a file");
        assert!(page.len() < 8_000_000, "{measurement}: {} bytes", page.len());
    }
    assert_eq!(files(folder.path()).len(), 6, "nothing else is left behind");
}

/// A page does not contradict its table: captions have the figures of the table, and a limit says where it is judged.
#[test]
fn sentences_have_the_figures_of_the_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let said = |measurement: &str| text(&oleo(folder.path(), &["rig", measurement, "--out", measurement]).stdout);
    let page = |measurement: &str| {
        std::fs::read_to_string(folder.path().join(measurement).join("report.html")).expect("a page")
    };
    let (table, spring) = (said("spring"), page("spring"));
    let row = table
        .lines()
        .find(|line| line.contains("largest deviation from isothermal "))
        .expect("a row");
    for figure in row
        .split_whitespace()
        .filter(|word| word.starts_with(['+', '-']) && word.len() > 1)
    {
        assert!(spring.contains(&format!("by {figure} % at most")), "{figure}");
    }
    assert!(row.matches(['+', '-']).count() >= 2, "{row}");
    let (table, limits) = (said("limits"), page("limits"));
    for said in [&table, &limits] {
        assert!(said.contains("at full bump of the test rig (+40 mm)"), "{table}");
    }
    let met = table.lines().filter(|line| line.ends_with("yes")).count();
    assert!(
        limits.contains(&format!("{met} of 7 design specifications are met")),
        "{table}"
    );
}

#[test]
fn two_runs_have_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let page = || {
        assert!(oleo(folder.path(), &["rig", "replay", "--out", "out"]).status.success());
        let read = |name: &str| std::fs::read(folder.path().join("out").join(name)).expect("a file");
        (read("report.html"), read("illustrative.csv"), read("summary.json"))
    };
    assert!(page() == page());
}

#[test]
fn a_specification_not_met_is_exit_status_1() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut model = StrutModel::defender110(8000.0);
    model.accumulator[0].static_gas_volume_m3 = 8e-5;
    std::fs::write(folder.path().join("small.toml"), model.to_toml()).expect("written");
    let run = oleo(folder.path(), &["rig", "limits", "--strut", "small.toml"]);
    assert_eq!(run.status.code(), Some(1), "{}", text(&run.stderr));
    assert!(text(&run.stdout).contains("NO"));
}

#[test]
fn bad_input_is_one_line_exit_status_2_and_nothing_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut model = StrutModel::defender110(8000.0);
    model.cylinder.bore_m = -0.05;
    std::fs::write(folder.path().join("bad.toml"), model.to_toml()).expect("written");
    let before = files(folder.path());
    for (arguments, part) in [
        (
            &["rig", "spring", "--strut", "bad.toml", "--out", "out"][..],
            "bad.toml:",
        ),
        (
            &["rig", "spring", "--strut", "no.toml", "--out", "out"],
            "no.toml: cannot read the model",
        ),
        (
            &["rig", "spring", "--bump-mm", "400", "--out", "out"],
            "--bump-mm 400: give",
        ),
        (
            &["rig", "damping", "--speed-m-s", "nan", "--out", "out"],
            "--speed-m-s NaN: give",
        ),
        (&["rig", "limits", "--out", "bad.toml/such/out"], "not a folder"),
        (&["rig", "limits", "--out", "bad.toml"], "not a folder"),
        (
            &["rig", "replay", "no.csv", "--out", "out"],
            "no.csv: cannot read the recording",
        ),
        (&["rig", "limits", "--static-load-n", "-5"], "--static-load-n"),
        (
            &["predict", "--model", "bad.toml", "bad.toml", "--out", "sim.csv"],
            "bad.toml",
        ),
    ] {
        let run = oleo(folder.path(), arguments);
        let line = text(&run.stderr);
        assert_eq!(run.status.code(), Some(2), "{arguments:?}: {line}");
        assert_eq!(line.trim_end().lines().count(), 1, "{arguments:?}: {line}");
        assert!(line.contains(part), "{arguments:?}: {line}");
        assert!(run.stdout.is_empty());
    }
    assert_eq!(files(folder.path()), before);
}

#[test]
fn a_prediction_with_the_specimens_own_model_is_the_recording() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut model = StrutModel::defender110(8000.0);
    // The rig plays its displacement without noise.
    model.noise.insert("displacement_m".into(), 0.0);
    std::fs::write(folder.path().join("model.toml"), model.to_toml()).expect("written");
    assert!(
        oleo(
            folder.path(),
            &["rig", "replay", "--strut", "model.toml", "--out", "rig"]
        )
        .status
        .success()
    );
    let arguments = [
        "predict",
        "--model",
        "model.toml",
        "rig/comparison.csv",
        "--out",
        "sim.csv",
    ];
    let run = oleo(folder.path(), &arguments);
    assert!(run.status.success(), "{}", text(&run.stderr));
    let table = text(&run.stdout);
    for channel in ["force_N", "p1_Pa", "p2_Pa", "p3_Pa", "p4_Pa"] {
        let ratio: f64 = table
            .lines()
            .find(|line| line.contains(channel))
            .and_then(|line| line.split_whitespace().last())
            .and_then(|ratio| ratio.parse().ok())
            .expect("a noise ratio");
        assert!(ratio < 1.0, "{table}");
    }
    let head = |name: &str, columns: usize| {
        let content = std::fs::read_to_string(folder.path().join(name)).expect("a file");
        let line = content.lines().next().unwrap_or_default().to_owned();
        line.split(',').take(columns).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(head("sim.csv", 99), head("rig/comparison.csv", 10));
}

#[test]
fn a_reader_that_stops_early_is_no_failure() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = Command::new("sh")
        .arg("-c")
        .arg(format!(
            "{} rig limits | head -1 > /dev/null",
            env!("CARGO_BIN_EXE_oleo")
        ))
        .current_dir(folder.path())
        .output()
        .expect("a shell");
    assert!(run.stderr.is_empty(), "{}", text(&run.stderr));
}
