//! Recordings of instruments as they are: `oleo diagnose` says what is wrong with them, and takes none of it for physics.
//!
//! Each campaign is made by the self-test with a complete model and one flaw of the instruments. The last lines of it are those of
//! anybody's campaign: files in a folder.

mod support;

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

/// A campaign with a complete model and this flaw, written by the self-test.
fn campaign(folder: &Path, flaw: &str) -> PathBuf {
    let out = folder.join(flaw);
    let arguments = [
        "diagnose",
        "--self-test",
        "--terms",
        "none",
        "--campaigns",
        "1",
        "--seed",
        "31",
    ];
    let more = ["--instruments", flaw, "--save", "--out", support_text(&out)];
    let run = support::run(&[&arguments[..], &more].concat());
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let entry = fs::read_dir(&out).expect("a folder").next().expect("a campaign");
    entry.expect("an entry").path()
}

fn support_text(path: &Path) -> &str {
    path.to_str().expect("a path of letters")
}

/// The report on a campaign, and what was printed.
fn diagnosed(campaign: &Path, out: &Path) -> (Value, String) {
    let run = support::run(&["diagnose", support_text(campaign), "--out", support_text(out)]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let report = fs::read_to_string(out.join("report.json")).expect("a report");
    let page = fs::read_to_string(out.join("report.html")).expect("a page");
    let report: Value = serde_json::from_str(&report).expect("JSON");
    let said = String::from_utf8_lossy(&run.stdout).into_owned();
    for finding in report["instruments"].as_array().expect("a list") {
        let text = finding["text"].as_str().expect("a text");
        let first = text.split('.').next().expect("a sentence");
        assert!(said.contains(first), "the terminal does not say: {text}");
    }
    let any = !report["instruments"].as_array().expect("a list").is_empty();
    assert_eq!(page.contains("The instruments"), any);
    (report, said)
}

#[test]
fn hum_spikes_and_a_missing_force_are_said_and_are_no_physics() {
    let folder = tempfile::tempdir().expect("a folder");
    for (flaw, name, columns) in [
        ("hum", "mains_hum", 1),
        ("spikes", "spikes", 6),
        ("no_force", "not_recorded", 1),
    ] {
        let campaign = campaign(folder.path(), flaw);
        let (report, _) = diagnosed(&campaign, &folder.path().join(format!("{flaw}-out")));
        assert_eq!(report["verdict"], "consistent", "{flaw}: {}", report["effects"]);
        let findings = report["instruments"].as_array().expect("a list");
        assert!(
            findings.len() == columns && findings.iter().all(|f| f["flaw"] == name),
            "{flaw}: {findings:?}"
        );
        if flaw == "hum" {
            let frequency = &findings[0]["numbers"]["frequency_Hz"];
            let hz = frequency["value"].as_f64().expect("a number");
            assert!(
                (hz - 50.0).abs() < 0.15 && frequency["ci95"][0].as_f64().expect("a number") < hz,
                "{frequency}"
            );
        }
        if flaw == "no_force" {
            let not_tested = report["not_tested"].as_array().expect("a list");
            let seal = not_tested
                .iter()
                .find(|n| n["id"] == "seal_friction")
                .expect("not tested");
            assert!(seal["why"].as_str().expect("a reason").contains("load cell"), "{seal}");
            assert!(report["fit"]["force_N"].is_null() && report["fit"]["p1_Pa"].is_object());
        }
    }
}

/// What the self-test leaves out as NaN is a missing column in a file.
#[test]
fn a_column_that_is_not_in_the_file_is_not_recorded() {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = campaign(folder.path(), "noise_half");
    let recordings = || {
        let entries = fs::read_dir(&campaign)
            .expect("a folder")
            .map(|e| e.expect("an entry").path());
        entries
            .filter(|p| p.extension().is_some_and(|e| e == "csv"))
            .collect::<Vec<_>>()
    };
    without(&recordings(), "p3_Pa");
    let opened = oleo_diagnose::Campaign::open(&campaign).expect("a campaign");
    let channels: Vec<&str> = opened.specimen.channels().iter().map(|c| c.column.as_str()).collect();
    assert_eq!(channels, ["force_N", "p1_Pa", "p2_Pa", "p4_Pa"]);
    let findings = opened.specimen.instruments();
    assert!(
        findings[0].text().starts_with("p3_Pa is not recorded"),
        "{}",
        findings[0].text()
    );
    // The noise of the others is half of what the model states.
    assert_eq!(findings.len(), 6);
    assert!(findings[1..].iter().all(|f| f.flaw.name() == "other_noise"));
    // With another column less too little is left.
    without(&recordings(), "p1_Pa");
    let run = support::run(&[
        "diagnose",
        support_text(&campaign),
        "--out",
        support_text(&folder.path().join("out")),
    ]);
    let error = String::from_utf8_lossy(&run.stderr).into_owned();
    assert_eq!(run.status.code(), Some(2));
    assert!(
        error.trim_end().lines().count() == 1 && error.contains("hold no p1_Pa, p3_Pa"),
        "{error}"
    );
}

/// Takes a column out of CSV files.
fn without(files: &[PathBuf], column: &str) {
    for file in files {
        let text = fs::read_to_string(file).expect("a recording");
        let at = text
            .lines()
            .next()
            .and_then(|header| header.split(',').position(|name| name == column));
        let at = at.expect("a column of this name");
        let row = |line: &str| {
            let cells: Vec<&str> = line
                .split(',')
                .enumerate()
                .filter(|(k, _)| *k != at)
                .map(|(_, cell)| cell)
                .collect();
            cells.join(",") + "\n"
        };
        fs::write(file, text.lines().map(row).collect::<String>()).expect("written");
    }
}
