//! `oleo diagnose --self-test` as a user meets it: the same tables on any number of threads, going on where it stopped, one
//! clear line on bad input.

mod support;

use std::path::Path;
use std::process::{Command, Output};

use oleo_plant_sim::strut::StrutModel;
use serde_json::Value;

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

/// Saves the first campaigns of a self-test into `saved`, and diagnoses one of them into `found`.
fn diagnose_saved(folder: &Path, campaigns: &str, campaign: &str) {
    let save = format!("diagnose --self-test {campaigns} --save --out saved");
    let diagnose = format!("diagnose saved/{campaign} --out found");
    for command in [save, diagnose] {
        let ran = oleo(folder, &command.split(' ').collect::<Vec<_>>());
        assert!(ran.status.success(), "{command}: {}", text(&ran.stderr));
    }
}

#[test]
fn a_self_test_goes_on_where_it_stopped_and_is_the_same_on_any_number_of_threads() {
    let folder = tempfile::tempdir().expect("a folder");
    let common = ["diagnose", "--self-test", "--terms", "none", "--seed", "7"];
    let with = |more: &[&str]| oleo(folder.path(), &[&common[..], more].concat());
    let first = with(&["--campaigns", "1", "--out", "a", "--threads", "1"]);
    assert!(first.status.success(), "{}", text(&first.stderr));
    let both = with(&["--campaigns", "2", "--out", "a", "--threads", "2"]);
    assert!(both.status.success(), "{}", text(&both.stderr));
    let anew = with(&["--campaigns", "2", "--out", "b", "--threads", "1"]);
    // The last line is the path of the page.
    let said = |output: &[u8]| {
        text(output)
            .lines()
            .rev()
            .skip(1)
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    assert_eq!(said(&both.stdout), said(&anew.stdout));
    for name in [
        "summary.json",
        "power.csv",
        "confusion.csv",
        "coverage.csv",
        "trials.csv",
    ] {
        let of = |out: &str| std::fs::read_to_string(folder.path().join(out).join(name)).expect(name);
        assert_eq!(of("a"), of("b"), "{name}");
    }
    assert!(folder.path().join("a/report.html").exists());
    support::is_as_documented(&folder.path().join("a"), "self-test");
    // Three lines: what wrote it, and two campaigns, none made twice.
    let ledger = std::fs::read_to_string(folder.path().join("a/trials.jsonl")).expect("a ledger");
    assert_eq!(ledger.lines().count(), 3);
    let summary: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path().join("a/summary.json")).expect("a summary"))
            .expect("JSON");
    assert_eq!(summary["false_alarms"], serde_json::json!({ "hits": 0, "of": 2 }));
}

#[test]
fn a_saved_campaign_is_one_like_any_other() {
    let folder = tempfile::tempdir().expect("a folder");
    let saved = oleo(
        folder.path(),
        &[
            "diagnose",
            "--self-test",
            "--terms",
            "sensor_gain",
            "--campaigns",
            "1",
            "--save",
            "--out",
            "saved",
        ],
    );
    assert!(saved.status.success(), "{}", text(&saved.stderr));
    let campaign = std::fs::read_dir(folder.path().join("saved"))
        .expect("a folder")
        .next()
        .expect("a campaign")
        .expect("a campaign")
        .path();
    let answer = std::fs::read_to_string(campaign.join("answer.json")).expect("an answer");
    assert!(answer.contains("sensor_gain"));
    let predicted = oleo(
        folder.path(),
        &[
            "predict",
            "--model",
            &campaign.join("model.toml").to_string_lossy(),
            &campaign.join("sine_low_soft.csv").to_string_lossy(),
            "--out",
            "simulated.csv",
        ],
    );
    assert!(predicted.status.success(), "{}", text(&predicted.stderr));
}

#[test]
fn a_wrong_number_is_named_and_the_improved_model_states_the_true_one() {
    let folder = tempfile::tempdir().expect("a folder");
    // The second one is a bore, which looks like the gains of two sensors.
    let campaign = "41_wrong_number_0_19_5";
    diagnose_saved(folder.path(), "--terms wrong_number --seed 41 --campaigns 2", campaign);
    let json = |path: &str| -> Value {
        let text = std::fs::read_to_string(folder.path().join(path)).expect("a file");
        serde_json::from_str(&text).expect("JSON")
    };
    let report = json("found/report.json");
    let effects = report["effects"].as_array().expect("a list");
    assert_eq!(effects.len(), 1, "{effects:?}");
    let (effect, bore) = (&effects[0], &effects[0]["parameters"]["bore_m"]);
    assert_eq!(
        (&effect["id"], &effect["place"]),
        (&"unlisted".into(), &"main-chamber".into())
    );
    let number = |value: &Value| value.as_f64().expect("a number");
    let bore_of = |path: String| {
        let text = std::fs::read_to_string(folder.path().join(&path)).expect("a model");
        StrutModel::from_toml(&text, &path).expect("a strut").cylinder.bore_m
    };
    let (believed, found) = (
        bore_of(format!("saved/{campaign}/model.toml")),
        bore_of("found/model.toml".into()),
    );
    let truth = number(&json(&format!("saved/{campaign}/answer.json"))["truth"][0]["value"]);
    let ends = [0, 1].map(|end| number(&bore["ci95"][end]));
    assert!(ends[0] <= truth && truth <= ends[1] && (believed - truth).abs() > 3.0 * (ends[1] - ends[0]));
    assert!((found - number(&bore["value"])).abs() < 1e-9);
    let equation = effect["equation"].as_str().expect("a text");
    assert!(
        equation.starts_with("bore_m = ") && equation.contains("believed to be"),
        "{equation}"
    );
}

#[test]
fn a_spot_between_the_points_of_a_table_and_a_change_at_a_moment_are_found() {
    let folder = tempfile::tempdir().expect("a folder");
    // Friction about a place of the bore, and a damper that is suddenly stronger.
    for (campaign, place, depends_on, points) in [
        ("3_unfamiliar_0_37_60", "main-seal", "displacement", 31),
        ("3_unfamiliar_0_43_60", "path-1", "time", 4),
    ] {
        let folder = folder.path().join(campaign);
        std::fs::create_dir(&folder).expect("a folder");
        diagnose_saved(&folder, "--terms unfamiliar --seed 3 --campaigns 12", campaign);
        let text = std::fs::read_to_string(folder.join("found/report.json")).expect("a report");
        let report: Value = serde_json::from_str(&text).expect("JSON");
        let effects = report["effects"].as_array().expect("a list");
        assert_eq!(effects.len(), 1, "{effects:?}");
        let law = &effects[0]["law"];
        assert_eq!(
            (&effects[0]["place"], &law["depends_on"]),
            (&place.into(), &depends_on.into())
        );
        assert_eq!(law["argument"].as_array().map(Vec::len), Some(points));
        let ratio = effects[0]["held_out_noise_ratio"]["with"].as_f64().expect("a ratio");
        assert!(ratio < 1.1, "{campaign}: {ratio}");
    }
}

/// A stop whose stiffness was fitted to nothing at half its clearance, and a displacement that is read by half, which six other effects together did not explain.
#[test]
fn an_effect_is_not_left_in_a_local_minimum_and_a_gross_fault_of_the_displacement_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    for (term, size) in [("bump_stop", "3"), ("sensor_gain", "300")] {
        let campaign = format!("5_{term}_21_{size}");
        let folder = folder.path().join(term);
        std::fs::create_dir(&folder).expect("a folder");
        diagnose_saved(&folder, &format!("--terms {term} --seed 5 --campaigns 22"), &campaign);
        let read = |name: &str| -> Value {
            let text = std::fs::read_to_string(folder.join(name)).expect(name);
            serde_json::from_str(&text).expect("JSON")
        };
        let effects = read("found/report.json")["effects"].take();
        let truth = read(&format!("saved/{campaign}/answer.json"))["truth"].take();
        let effects = effects.as_array().expect("a list");
        assert_eq!((effects.len(), &effects[0]["id"]), (1, &term.into()), "{effects:?}");
        for number in truth.as_array().expect("a list") {
            let key = number["key"].as_str().expect("a key");
            let ends = &effects[0]["parameters"][key]["ci95"];
            let [low, high] = [0, 1].map(|end| ends[end].as_f64().expect("an end"));
            let truth = number["value"].as_f64().expect("a number");
            assert!(low <= truth && truth <= high, "{key}: {truth} in {low} to {high}");
        }
    }
}

/// One block alone determines the square of the response's polynomial. A law of valve 3, which that block does not shake, had taken the effect's place.
#[test]
fn a_name_that_one_block_determines_is_kept_and_the_verdict_says_why() {
    let (effects, page) = effects_and_page("--terms valve_delay --seed 5 --campaigns 24", "5_valve_delay_23_1");
    assert_eq!(effects, ["valve_delay"]);
    assert!(page.contains("Where the model was fitted, the error is 1.0"));
}

/// The oil column of a line, which brings finer steps, had stood beside it.
#[test]
fn a_floating_piston_that_holds_back_five_bar_brings_no_other_effect() {
    let campaigns = "--terms accumulator_piston_friction --seed 31 --campaigns 9";
    let (effects, _) = effects_and_page(campaigns, "31_accumulator_piston_friction_8_300");
    assert_eq!(effects, ["accumulator_piston_friction"]);
}

/// The effects that are found in one of the first campaigns of a self-test, and the page about it.
fn effects_and_page(campaigns: &str, campaign: &str) -> (Vec<String>, String) {
    let folder = tempfile::tempdir().expect("a folder");
    diagnose_saved(folder.path(), campaigns, campaign);
    let read = |name: &str| std::fs::read_to_string(folder.path().join("found").join(name)).expect(name);
    let report: Value = serde_json::from_str(&read("report.json")).expect("JSON");
    let effects = report["effects"].as_array().expect("a list");
    let id = |effect: &Value| effect["id"].as_str().expect("an id").to_owned();
    (effects.iter().map(id).collect(), read("report.html"))
}

/// Under all that the recordings hold a mount that yields does the same as a larger volume of oil that yields.
#[test]
fn a_number_that_may_be_wrong_in_the_place_of_an_effect_is_said_with_its_value() {
    let folder = tempfile::tempdir().expect("a folder");
    let campaigns = "--terms mount_compliance --seed 3 --campaigns 4";
    diagnose_saved(folder.path(), campaigns, "3_mount_compliance_3_1");
    let read = |name: &str| std::fs::read_to_string(folder.path().join("found").join(name)).expect(name);
    let report: Value = serde_json::from_str(&read("report.json")).expect("JSON");
    let effects = report["effects"].as_array().expect("a list");
    assert_eq!((effects.len(), &effects[0]["id"]), (1, &"mount_compliance".into()));
    assert!(
        effects[0]["confidence"].as_f64().expect("a number") > 0.9,
        "{effects:?}"
    );
    assert_eq!(
        report["ambiguous"],
        serde_json::json!([["mount_compliance", "unlisted"]])
    );
    let next = report["next_experiment"].as_str().expect("a text");
    assert!(next.contains("measure the oil volume itself"), "{next}");
    let page = read("report.html");
    assert!(page.contains("from a wrong oil volume") && page.contains("oil_volume_m3 = "));
}

#[test]
fn bad_arguments_are_one_line_that_says_what_to_do() {
    let folder = tempfile::tempdir().expect("a folder");
    for (arguments, says) in [
        (&["--self-test", "--terms", "seal_fraction"][..], "seal_friction"),
        (
            &["--self-test", "--terms", "none", "--without-names"],
            "cannot be combined with --without-names",
        ),
        (&["--self-test", "--campaigns", "0"], "above 0"),
        (&["--self-test", "--threads", "0"], "above 0"),
        (&["--self-test", "--out", "/proc/oleo/new"], "/proc"),
        (&["--self-test", "campaign", "--out", "x"], "--self-test"),
        (&["--campaigns", "3", "--out", "x"], "--self-test"),
        (&["--out", "x"], "CAMPAIGN"),
    ] {
        let run = oleo(folder.path(), &[&["diagnose"], arguments].concat());
        let message = text(&run.stderr);
        assert_eq!(run.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(
            message.trim_end().lines().count() == 1 && message.contains(says),
            "{arguments:?}: {message}"
        );
    }
    std::fs::write(folder.path().join("trials.jsonl"), "{\"oleo_self_test\":0}\n").expect("a file");
    let run = oleo(
        folder.path(),
        &["diagnose", "--self-test", "--campaigns", "1", "--out", ".", "--force"],
    );
    assert_eq!(run.status.code(), Some(2));
    assert!(
        text(&run.stderr).contains("another --out folder"),
        "{}",
        text(&run.stderr)
    );
}
