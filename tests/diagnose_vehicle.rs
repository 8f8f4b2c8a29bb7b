//! `oleo diagnose` on what the bus of a vehicle carried: from logs to the corner, the effect and the improved model files.
//!
//! Short drives in the development profile. How often what is found, over many seeds, is measured by `examples/vehicle_logs.rs`.

#[path = "support/felt.rs"]
mod felt;
mod support;
#[path = "support/vehicle_campaign.rs"]
mod vehicle_campaign;

use std::path::Path;

use felt::is_felt;
use oleo_diagnose::vocabulary::EffectId;
use oleo_hil::scenario::Scenario;
use oleo_interface::{Corner, Corners};
use oleo_plant_sim::strut::StrutModel;
use serde_json::Value;
use support::{complaint, run};
use vehicle_campaign::{Case, Concealed, TrueAtCorner, drives, write};

/// Length of each drive, s.
const DURATION_S: f64 = 9.0;

fn path(path: &Path) -> &str {
    path.to_str().expect("a path in UTF-8")
}

/// A case whose logs begin at rest and whose commands act at once.
fn case(seed: u64, concealed: Vec<Concealed>) -> Case {
    Case {
        seed,
        concealed,
        drives: drives(seed, DURATION_S),
        first_edition: false,
        command_acts_late: false,
        keeps_oil: false,
        begins_s: 0.0,
        without_noise: false,
    }
}

fn diagnosed(case: &Case) -> (tempfile::TempDir, Value, Vec<TrueAtCorner>) {
    let folder = tempfile::tempdir().expect("a folder");
    let truth = write(case, folder.path());
    let out = folder.path().join("found");
    let ran = run(&["diagnose", path(folder.path()), "--out", path(&out)]);
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let text = std::fs::read_to_string(out.join("report.json")).expect("a report");
    (folder, serde_json::from_str(&text).expect("JSON"), truth)
}

fn effects(report: &Value) -> Vec<String> {
    let all = report["effects"].as_array().expect("a list");
    let text = |v: &Value| v.as_str().unwrap_or_default().to_owned();
    all.iter()
        .map(|e| format!("{}@{}", text(&e["id"]), text(&e["place"])))
        .collect()
}

#[test]
fn one_altered_strut_is_named_with_its_corner() {
    let concealed = Concealed::new(EffectId::GasChargeError, 1, 0.1, vec![Corner::RearLeft]);
    let case = Case {
        first_edition: true,
        ..case(3, vec![concealed])
    };
    let (folder, report, truth) = diagnosed(&case);
    let [TrueAtCorner { corner, id, number }] = &truth[..] else {
        panic!("one number is concealed")
    };
    let place = format!("{id}@{}/{}", corner.name(), number.site);
    assert_eq!(place, "gas_charge_error@rear-left/accumulator-2");
    assert_eq!(effects(&report), [place], "{:#}", report["fit"]);
    assert_eq!(report["verdict"], "missing_physics");
    let error = &report["effects"][0]["parameters"][&number.key]["value"];
    let error = error.as_f64().expect("a number");
    assert!((error - number.value).abs() < 0.02, "{error}");
    // Five channels of a rig less the force, at four corners.
    assert_eq!(report["fit"].as_object().expect("channels").len(), 16);
    let used = report["notes"]
        .as_array()
        .expect("notes")
        .iter()
        .filter(|n| n.as_str().is_some_and(|n| n.contains("lost,")));
    assert_eq!(used.count(), 3, "{}", report["notes"]);
    // The improved model reads back, with the sensor's noise as it was stated and the charge in the right file.
    let read = |name: &str| {
        let file = folder.path().join("found").join(name);
        StrutModel::from_toml(&std::fs::read_to_string(file).expect("a file"), name).expect("a strut")
    };
    assert!(
        read("rear-left.toml").effects.gas_charge_error.is_some()
            && read("rear-right.toml").effects.gas_charge_error.is_none()
    );
    assert!((read("front-left.toml").noise["p1_Pa"] - 4e3).abs() < 1e-9);
    let page = std::fs::read_to_string(folder.path().join("found/report.html")).expect("a page");
    assert!(page.contains("of the rear-left strut") && page.contains("lane-change"));
    // What the driver feels is what the loop itself gives: on the believed struts, which are of one design, and on those that were found.
    let file = |name: &str| path(&folder.path().join(name)).to_owned();
    let believed = |scenario: &mut Scenario| scenario.strut = file("front-left.toml");
    is_felt(&report, "believed", 1e-3, believed);
    is_felt(&report, "found", 1e-3, |scenario| {
        believed(scenario);
        scenario.strut_at = Corners::from_fn(|corner| Some(file(&format!("found/{}.toml", corner.name()))));
    });
    assert_ne!(report["driven"]["believed"], report["driven"]["found"]);
    assert!(page.contains("What the driver feels of it"));
    // Diagnosed again with what was found, nothing is missing.
    let again = folder.path().join("again");
    let logs = ["belgian.log", "lane-change.log", "random-road.log"].map(|name| folder.path().join(name));
    let model = folder.path().join("found/model.toml");
    let mut arguments = vec!["diagnose"];
    arguments.extend(logs.iter().map(|log| path(log)));
    arguments.extend(["--vehicle", path(&model), "--out", path(&again)]);
    let ran = run(&arguments);
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    assert!(
        String::from_utf8_lossy(&ran.stdout).contains("consistent"),
        "{}",
        String::from_utf8_lossy(&ran.stdout)
    );
}

/// Diagnoses a vehicle of which nothing is missing, and holds a note against this.
fn nothing_but_a_note(case: &Case, note: &str) -> tempfile::TempDir {
    let (folder, report, _) = diagnosed(case);
    assert_eq!(report["verdict"], "consistent", "{:#}", report["effects"]);
    assert_eq!(
        [&report["locations"], &report["next_experiment"], &report["driven"]],
        [&Value::Array(vec![]), &Value::Null, &Value::Null]
    );
    assert!(report["notes"].to_string().contains(note), "{}", report["notes"]);
    folder
}

#[test]
fn commands_that_act_a_tick_late_are_not_taken_for_missing_physics() {
    let case = Case {
        command_acts_late: true,
        ..case(5, vec![])
    };
    nothing_but_a_note(&case, "The commands act one tick (5 ms) after");
}

#[test]
fn oil_that_a_vehicle_keeps_is_not_taken_for_a_sensor_that_drifts() {
    let case = Case {
        keeps_oil: true,
        ..case(5, vec![])
    };
    let folder = nothing_but_a_note(&case, "The struts keep their oil");
    counts_oil_at_its_static_density(&folder);
}

#[test]
fn whether_oil_is_kept_shows_in_drives_that_begin_in_motion() {
    // The gas is warm then, and cools; with the believed models as they are, that looks like oil that is lost.
    let begins_s = 10.0;
    for keeps_oil in [false, true] {
        let case = Case {
            keeps_oil,
            begins_s,
            drives: drives(10, begins_s + DURATION_S),
            ..case(10, vec![])
        };
        let (_, report, _) = diagnosed(&case);
        assert_eq!(effects(&report), [""; 0], "{:#}", report["fit"]);
        let notes = report["notes"].to_string();
        assert_eq!(notes.contains("The struts keep their oil"), keeps_oil, "{notes}");
    }
}

#[test]
fn gas_that_warms_at_all_corners_is_not_taken_for_oil_that_is_kept() {
    let concealed = Concealed::new(EffectId::GasHeatTransfer, 0, 6.0, Corner::ALL.to_vec());
    let (_, report, _) = diagnosed(&case(2, vec![concealed]));
    let warms = ["accumulator-1", "accumulator-2"].map(|place| format!("gas_heat_transfer@vehicle/{place}"));
    assert_eq!(effects(&report), warms, "{:#}", report["fit"]);
    let notes = report["notes"].to_string();
    assert!(!notes.contains("The struts keep their oil"), "{notes}");
}

/// The improved file of a corner says that oil is kept.
fn counts_oil_at_its_static_density(folder: &tempfile::TempDir) {
    let file = std::fs::read_to_string(folder.path().join("found/rear-left.toml")).expect("a file");
    assert!(file.contains("counted_at = \"static\""), "{file}");
}

#[test]
fn what_is_found_of_the_oil_keeps_it_too() {
    let concealed = Concealed::new(EffectId::OilCompressibility, 0, 1.0 / 1.4e9, Corner::ALL.to_vec());
    let case = Case {
        keeps_oil: true,
        ..case(6, vec![concealed])
    };
    let (folder, report, _) = diagnosed(&case);
    assert_eq!(
        effects(&report),
        ["oil_compressibility@vehicle/main-chamber"],
        "{:#}",
        report["fit"]
    );
    counts_oil_at_its_static_density(&folder);
}

#[test]
fn logs_that_begin_in_motion_are_diagnosed_and_their_files_say_so_again() {
    // What all corners lack outweighs by far what a tick makes of the valves' edges.
    let concealed = Concealed::new(EffectId::OilCompressibility, 0, 1.0 / 1.4e9, Corner::ALL.to_vec());
    let case = Case {
        begins_s: 2.5,
        ..case(6, vec![concealed])
    };
    let (folder, report, _) = diagnosed(&case);
    assert_eq!(
        effects(&report),
        ["oil_compressibility@vehicle/main-chamber"],
        "{:#}",
        report["fit"]
    );
    assert!(
        !report["notes"].to_string().contains("The commands act one tick"),
        "{}",
        report["notes"]
    );
    let modulus = &report["effects"][0]["parameters"]["bulk_modulus_Pa"]["value"];
    assert!(
        (modulus.as_f64().expect("a number") / 1.4e9 - 1.0).abs() < 0.02,
        "{modulus}"
    );
    let fitted = report["calibration"].to_string();
    assert!(
        fitted.contains("gas_temperature_1_K at the beginning of belgian"),
        "{fitted}"
    );
    let file = std::fs::read_to_string(folder.path().join("found/front-left.toml")).expect("a file");
    assert!(file.starts_with("starts_at_rest = false"), "{file}");
}

#[test]
fn a_floating_piston_that_rubs_holds_pressure_back_where_a_log_begins_in_motion() {
    let concealed = Concealed::new(EffectId::AccumulatorPistonFriction, 1, 4e5, vec![Corner::RearLeft]);
    let case = Case {
        begins_s: 2.5,
        ..case(9, vec![concealed])
    };
    let (_folder, report, truth) = diagnosed(&case);
    assert_eq!(
        effects(&report),
        ["accumulator_piston_friction@rear-left/accumulator-2"],
        "{:#}",
        report["fit"]
    );
    for TrueAtCorner { number, .. } in truth {
        let interval = &report["effects"][0]["parameters"][&number.key]["ci95"];
        let [low, high] = [&interval[0], &interval[1]].map(|v| v.as_f64().expect("a number"));
        assert!(low < number.value && number.value < high, "{number:?} in {interval}");
    }
    let left = &report["effects"][0]["held_out_noise_ratio"]["with"];
    assert!(left.as_f64().expect("a ratio") < 1.02, "{left}");
}

#[test]
fn what_three_corners_show_of_the_oil_is_the_vehicles() {
    // At 44 GPa all corners show it alone.
    is_the_vehicles(45e9);
}

#[test]
fn what_one_corner_shows_of_the_oil_is_the_vehicles_if_the_others_speak_for_it() {
    is_the_vehicles(46e9);
}

/// Diagnoses a vehicle whose oil has this bulk modulus, which not all of its corners show.
fn is_the_vehicles(modulus_pa: f64) {
    let concealed = Concealed::new(EffectId::OilCompressibility, 0, 1.0 / modulus_pa, Corner::ALL.to_vec());
    let case = case(8, vec![concealed]);
    let (folder, report, _) = diagnosed(&case);
    assert_eq!(effects(&report), ["oil_compressibility@vehicle/main-chamber"]);
    let effect = &report["effects"][0];
    let interval = &effect["parameters"]["bulk_modulus_Pa"]["ci95"];
    let [low, high] = [&interval[0], &interval[1]].map(|v| v.as_f64().expect("a number"));
    assert!(low < modulus_pa && modulus_pa < high && high < 1.4 * low, "{interval}");
    assert_eq!(effect["at_corners"].as_object().expect("corners").len(), 4);
    for corner in Corner::ALL {
        let file = folder.path().join("found").join(format!("{}.toml", corner.name()));
        let text = std::fs::read_to_string(file).expect("a file");
        assert!(text.contains("bulk_modulus_Pa"), "{}: {text}", corner.name());
    }
}

#[test]
fn what_cannot_be_used_is_refused_in_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let strut = StrutModel::defender110(4000.0).to_toml();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
    let vehicle = |strut: &str| {
        let corners =
            ["front_left", "front_right", "rear_left", "rear_right"].map(|corner| format!("{corner} = \"{strut}\"\n"));
        format!(
            "[specimen]\nname = \"car\"\nkind = \"vehicle\"\n[strut]\n{}",
            corners.concat()
        )
    };
    let out = folder.path().join("found");
    let refused = |arguments: &[&str]| {
        let mut all = vec!["diagnose"];
        all.extend(arguments);
        all.extend(["--out", path(&out)]);
        let text = complaint(&run(&all));
        assert!(!out.exists(), "{text}");
        text
    };
    write("model.toml", &vehicle("strut.toml"));
    assert!(refused(&[path(folder.path())]).contains("holds no drive"));
    write("a.log", "(1.000000) can0 123#00\n(1.100000) can0 124#00\n");
    assert!(refused(&[path(folder.path())]).contains("strut.toml"));
    write("strut.toml", &format!("starts_at_rest = 3\n{strut}"));
    assert!(refused(&[path(folder.path())]).contains("starts_at_rest is 3"));
    write("strut.toml", &strut);
    let text = refused(&[path(folder.path())]);
    assert!(
        text.contains("a.log") && text.contains("2 frames with other identifiers"),
        "{text}"
    );
    let twice = refused(&[
        path(&folder.path().join("a.log")),
        path(&folder.path().join("./a.log")),
        "--vehicle",
        path(&folder.path().join("model.toml")),
    ]);
    assert!(twice.contains("is given twice"), "{twice}");
    write("model.toml", &vehicle("../strut.toml"));
    assert!(refused(&[path(folder.path())]).contains("front_left"));
    let log = folder.path().join("a.log");
    let strut = folder.path().join("strut.toml");
    assert!(refused(&[path(&log), "--vehicle", path(&strut)]).contains("vehicle"));
    assert!(refused(&[path(&log), path(&log)]).contains("--vehicle MODEL.toml"));
}

/// The report of a log of `oleo hil`, beside the strut files that it writes. Readings of `oleo hil` are only rounded.
fn of_own_log(arguments: &[&str]) -> Value {
    let folder = tempfile::tempdir().expect("a folder");
    let of = |name: &str| path(&folder.path().join(name)).to_owned();
    let (weak, at) = (of("weak.toml"), of("run"));
    let shown = run(&["show", "strut"]);
    let built_in = String::from_utf8(shown.stdout).expect("text");
    assert!(built_in.contains("time_constant_2_s = 6"), "{built_in}");
    std::fs::write(
        &weak,
        built_in.replace("time_constant_2_s = 6", "time_constant_2_s = 2"),
    )
    .expect("a file");
    let arguments: Vec<String> = arguments.iter().map(|word| word.replace("WEAK", &weak)).collect();
    let words = ["hil", "--record", "all", "--out", &at]
        .into_iter()
        .chain(arguments.iter().map(String::as_str));
    let ran = run(&words.collect::<Vec<_>>());
    assert!(ran.status.code() < Some(2), "{}", String::from_utf8_lossy(&ran.stderr));
    let mut model = String::from("[specimen]\nname = \"car\"\nkind = \"vehicle\"\n[strut]\n");
    for corner in Corner::ALL.map(Corner::name) {
        // What the plant was simulated with is believed, but for the weak strut: that of the other side is.
        let believed = if corner == "front-left" { "front-right" } else { corner };
        std::fs::copy(of(&format!("run/{believed}/model.toml")), of(&format!("{corner}.toml"))).expect("a copy");
        model += &format!("{} = \"{corner}.toml\"\n", corner.replace('-', "_"));
    }
    std::fs::write(of("model.toml"), model).expect("a file");
    let (log, vehicle, found) = (of("run/candump.log"), of("model.toml"), of("found"));
    let ran = run(&["diagnose", &log, "--vehicle", &vehicle, "--out", &found]);
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let text = std::fs::read_to_string(of("found/report.json")).expect("a report");
    serde_json::from_str(&text).expect("JSON")
}

/// The files state a noise of 4 kPa, and a log whose readings are only rounded to 5 kPa has 1.44 kPa: what is smaller than stated is seen.
#[test]
fn noise_that_is_smaller_than_stated_hides_nothing() {
    let weak = "front-left=WEAK";
    let report = of_own_log(&[
        "--road",
        "iso-d",
        "--speed-km-h",
        "19.9",
        "--duration-s",
        "30",
        "--strut-at",
        weak,
    ]);
    assert_eq!(effects(&report), ["unlisted@front-left/accumulator-2"]);
    let time_constant = &report["effects"][0]["parameters"]["time_constant_2_s"];
    println!("concealed 2 s: {time_constant}");
    let ends = [0, 1].map(|end| time_constant["ci95"][end].as_f64().expect("a time constant"));
    assert!(
        ends[0] < 2.0 && ends[1] > 2.0 && ends[1] - ends[0] < 0.1,
        "{time_constant}"
    );
    let notes = report["notes"]
        .as_array()
        .expect("notes")
        .iter()
        .filter_map(Value::as_str);
    assert_eq!(
        notes
            .filter(|note| note.contains("less noise than the strut files state"))
            .count(),
        1
    );
    let findings = report["instruments"].as_array().expect("a list").iter();
    let noise: Vec<f64> = (findings.filter(|finding| finding["flaw"] == "other_noise"))
        .map(|finding| {
            let of = |key: &str| finding["numbers"][key]["value"].as_f64().expect("a number");
            of("measured") / of("stated")
        })
        .collect();
    // The stated noise and the rounding together are 4.25 kPa.
    assert!(
        noise.len() >= 12 && noise.iter().all(|part| *part > 0.33 && *part < 0.5),
        "{noise:?}"
    );
}

/// Readings that stand still have one rounding error, not one a sample.
#[test]
fn readings_that_stand_still_are_no_fault() {
    for still in [
        &[
            "--road",
            "iso-d",
            "--speed-km-h",
            "40",
            "--duration-s",
            "20",
            "--strategy",
            "always-stiff",
            "--seed",
            "14",
        ][..],
        &[
            "--road",
            "flat",
            "--speed-km-h",
            "60",
            "--duration-s",
            "15",
            "--manoeuvre",
            "step-steer",
            "--seed",
            "16",
        ],
    ] {
        let report = of_own_log(still);
        assert_eq!(report["verdict"], "consistent", "{still:?}: {:?}", effects(&report));
    }
}
