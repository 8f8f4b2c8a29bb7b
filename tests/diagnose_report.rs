//! `oleo diagnose` end to end on specimens made here: the schema of `report.json`, the page, the model that was written.

mod support;

use std::fmt::Write;
use std::path::Path;

use serde_json::Value;
use support::run;

/// Uniform noise of a standard deviation, the same in every run (Park & Miller, Commun. ACM 31(10), 1988).
struct Noise(u64);

impl Noise {
    fn next(&mut self, deviation: f64) -> f64 {
        self.0 = self.0 * 48_271 % 2_147_483_647;
        (self.0 as f64 / 2_147_483_647.0 - 0.5) * deviation * 12.0_f64.sqrt()
    }
}

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn path(path: &Path) -> &str {
    path.to_str().expect("a path in UTF-8")
}

const GAS_SPRING: &str = "[specimen]\nname = \"made here\"\nkind = \"gas spring\"\n\
    [chamber]\narea_m2 = 0.0115\nvolume_at_zero_m3 = 0.0756\n\
    [gas]\nspecies = \"nitrogen\"\nprocess = \"adiabatic\"\ntemperature_K = 293.15\n\
    [effects]\nHEAT\n[tolerance]\nvolume_at_zero = 0.02\ninitial_pressure = 0.01\n[noise]\ndisplacement_m = 2e-05\np_Pa = 400.0\n";

/// A folder with the belief and one recording of a gas spring whose gas exchanges heat, or does not.
fn gas_spring(folder: &Path, heat: &str) {
    let truth = folder.join("truth.txt");
    std::fs::write(&truth, GAS_SPRING.replace("HEAT", heat)).expect("written");
    // Trapezoids with holds: 0.5 m within 2 s, held for 8 s, and back.
    let shape = |t: f64| {
        let phase = t % 20.0;
        (0.25 * phase.min(12.0 - phase)).clamp(0.0, 0.5)
    };
    let mut rows = String::from("time_s,displacement_m,p_Pa\n");
    for k in 0..4000 {
        let t = 0.02 * f64::from(k);
        writeln!(rows, "{t:.2},{:.6},1000000", shape(t)).expect("text");
    }
    let (inputs, exact) = (folder.join("inputs.txt"), folder.join("exact.txt"));
    std::fs::write(&inputs, rows).expect("written");
    let made = run(&["predict", "--model", path(&truth), path(&inputs), "--out", path(&exact)]);
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let mut noise = Noise(20_021_101);
    let mut rows = String::new();
    for (k, line) in text(&exact).lines().enumerate() {
        match line.rsplit_once(',').filter(|_| k > 0) {
            Some((rest, p)) => {
                let p: f64 = p.parse().expect("a number");
                writeln!(rows, "{rest},{:.1}", p + noise.next(400.0)).expect("text");
            }
            None => writeln!(rows, "{line}").expect("text"),
        }
    }
    std::fs::create_dir(folder.join("campaign")).expect("a folder");
    std::fs::write(folder.join("campaign/model.toml"), GAS_SPRING.replace("HEAT", "")).expect("written");
    std::fs::write(folder.join("campaign/moves.csv"), rows).expect("written");
}

fn diagnosed(folder: &Path) -> Value {
    let (campaign, out) = (folder.join("campaign"), folder.join("found"));
    let made = run(&["diagnose", path(&campaign), "--out", path(&out)]);
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let report: Value = serde_json::from_str(&text(&out.join("report.json"))).expect("JSON");
    follows_the_schema(&report);
    support::is_as_documented(&out, "diagnose");
    report
}

/// Every key of the schema in the recordings' README, with its type and range.
fn follows_the_schema(report: &Value) {
    let string = |v: &Value| v.as_str().is_some_and(|s| !s.is_empty());
    let share = |v: &Value| v.as_f64().is_some_and(|s| (0.0..=1.0).contains(&s));
    let ratio = |v: &Value| v.as_f64().is_some_and(|r| r >= 0.0);
    let list = |v: &Value| v.as_array().expect("a list").clone();
    assert_eq!(report["schema"], 1);
    assert!(["consistent", "missing_physics", "unexplained"].contains(&report["verdict"].as_str().expect("a verdict")));
    for l in list(&report["locations"]) {
        assert!(string(&l["place"]) && share(&l["share_of_excess"]), "{l}");
        assert!(
            string(&l["where"]["recording"]) && string(&l["where"]["condition"]),
            "{l}"
        );
        let t: Vec<f64> = list(&l["where"]["t_s"]).iter().filter_map(Value::as_f64).collect();
        assert!(t.len() == 2 && t[0] <= t[1], "{l}");
    }
    for e in list(&report["effects"]) {
        assert!(
            string(&e["id"]) && string(&e["place"]) && share(&e["confidence"]),
            "{e}"
        );
        assert!(e["law"].is_null() || e["law"].is_object(), "{e}");
        for (key, p) in e["parameters"].as_object().expect("parameters") {
            assert!(
                !key.is_empty() && p["value"].is_f64() && list(&p["ci95"]).len() == 2,
                "{e}"
            );
        }
        let held_out = &e["held_out_noise_ratio"];
        assert!(ratio(&held_out["without"]) && ratio(&held_out["with"]), "{e}");
    }
    for r in list(&report["rejected"]) {
        assert!(string(&r["id"]) && string(&r["place"]) && string(&r["why"]), "{r}");
        for (key, size) in r["shown_from"].as_object().expect("sizes") {
            assert!(!key.is_empty() && (size.is_null() || size.as_f64() > Some(0.0)), "{r}");
        }
        assert!(
            r["why"]
                .as_str()
                .is_some_and(|w| w.contains(|c: char| c.is_ascii_digit()) || w.contains("not")),
            "figures: {r}"
        );
    }
    for pair in list(&report["ambiguous"]) {
        assert!(list(&pair).len() == 2 && list(&pair).iter().all(string), "{pair}");
    }
    assert!(report["next_experiment"].is_null() || string(&report["next_experiment"]));
    let fit = report["fit"].as_object().expect("channels");
    assert!(!fit.is_empty());
    for (channel, f) in fit {
        for key in [
            "noise_ratio_before",
            "noise_ratio_after",
            "held_out_before",
            "held_out_after",
        ] {
            assert!(ratio(&f[key]), "{channel} {key}");
        }
    }
    assert!(ratio(&report["runtime_s"]));
    for n in list(&report["not_tested"]) {
        assert!(string(&n["id"]) && string(&n["place"]) && string(&n["why"]), "{n}");
    }
}

#[test]
fn heat_that_was_left_out_is_named_located_sized_and_told() {
    let folder = tempfile::tempdir().expect("a folder");
    gas_spring(folder.path(), "[effects.gas_heat_transfer]\ntime_constant_s = 6.0");
    let report = diagnosed(folder.path());

    assert_eq!(report["verdict"], "missing_physics");
    let effects = report["effects"].as_array().expect("effects");
    assert_eq!(effects.len(), 1, "{effects:?}");
    assert_eq!(effects[0]["id"], "gas_heat_transfer");
    let tau = effects[0]["parameters"]["time_constant_s"]["value"]
        .as_f64()
        .expect("a value");
    assert!((tau / 6.0 - 1.0).abs() < 0.05, "time constant {tau} s, 6 s is true");

    // Where: the chamber, while nothing moves after a step.
    let location = &report["locations"][0];
    assert_eq!(location["place"], "chamber");
    let condition = location["where"]["condition"].as_str().expect("text");
    assert!(condition.starts_with("after a step, decays with"), "{condition}");
    let after = &report["fit"]["p_Pa"];
    assert!(
        after["held_out_after"].as_f64() < Some(1.1) && after["held_out_before"].as_f64() > Some(5.0),
        "{after}"
    );

    let page = text(&folder.path().join("found/report.html"));
    for told in [
        "The model leaves out gas heat transfer in the gas chamber. With this effect, ",
        "<h2>Where</h2>",
        "<h2>What</h2>",
        "<h2>The improved model</h2>",
        "<h2>How much better</h2>",
        "<h2>What to record next</h2>",
        "box found",
        "found here",
        "Els &amp; Grobbelaar",
        "rival rejected",
        "Ljung-Box",
        "[effects.gas_heat_transfer]",
        "effects.gas_heat_transfer.time_constant_s",
    ] {
        assert!(page.contains(told), "the page does not say: {told}");
    }
    assert!(
        !page.contains("<script src") && !page.contains("<link "),
        "opens offline"
    );
    assert!(page.len() < 2_600_000, "{} bytes", page.len());

    // The model that was written predicts what it was made from.
    let sim = folder.path().join("sim.csv");
    let found = folder.path().join("found/model.toml");
    let recording = folder.path().join("campaign/moves.csv");
    let made = run(&[
        "predict",
        "--model",
        path(&found),
        path(&recording),
        "--out",
        path(&sim),
    ]);
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
}

#[test]
fn a_complete_model_is_called_complete() {
    let folder = tempfile::tempdir().expect("a folder");
    gas_spring(folder.path(), "");
    let report = diagnosed(folder.path());
    assert_eq!(report["verdict"], "consistent");
    assert_eq!(report["effects"].as_array().map(Vec::len), Some(0));
    assert_eq!(report["locations"].as_array().map(Vec::len), Some(0));
    assert!(report["next_experiment"].is_null());
    let page = text(&folder.path().join("found/report.html"));
    assert!(page.contains("Nothing is missing") && page.contains("verdict good") && !page.contains("box found"));
}

/// The other form of the same effect, which the page explains with the same equation.
#[test]
fn free_convection_is_told_from_a_constant_time_constant() {
    let folder = tempfile::tempdir().expect("a folder");
    let heat = "[effects.gas_heat_transfer]\ntime_constant_s = 6.0\nconvection = \"free\"";
    gas_spring(folder.path(), heat);
    let report = diagnosed(folder.path());
    let effects = report["effects"].as_array().expect("effects");
    assert_eq!(effects.len(), 1, "{effects:?}");
    assert_eq!(effects[0]["id"], "gas_heat_transfer");
    // One form is no ambiguity of the other, and says nothing against the effect.
    assert_eq!(report["ambiguous"].as_array().map(Vec::len), Some(0));
    assert!(effects[0]["confidence"].as_f64() > Some(0.9), "{effects:?}");
    let tau = &effects[0]["parameters"]["time_constant_at_10_K_s"]["value"];
    let tau = tau.as_f64().expect("free convection");
    assert!((tau / 6.0 - 1.0).abs() < 0.01, "{tau}");
    // Half of this recording tells less of the gas at its beginning, so that held-out halves are not down to the noise.
    assert!(report["fit"]["p_Pa"]["noise_ratio_after"].as_f64() < Some(1.02));
    let found = text(&folder.path().join("found/model.toml"));
    assert!(found.contains("convection = \"free\""), "{found}");
    let page = text(&folder.path().join("found/report.html"));
    assert!(page.contains("cools by free convection"));
}

/// A pressure is an input of a cylinder's model, so that its sign changes the force that is computed.
#[test]
fn a_pressure_that_is_connected_the_wrong_way_round_is_named_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = folder.path().join("campaign");
    std::fs::create_dir(&campaign).expect("a folder");
    let model = "[specimen]\nname = \"made here\"\nkind = \"cylinder\"\n\
        [[chamber]]\ncolumn = \"lower_Pa\"\narea_m2 = 0.001\n[[chamber]]\ncolumn = \"upper_Pa\"\narea_m2 = -0.0008\n\
        [tolerance]\narea = 0.01\nforce_offset_N = 5.0\n[noise]\ndisplacement_m = 1e-5\nforce_N = 5.0\nlower_Pa = 0.0\nupper_Pa = 0.0\n";
    std::fs::write(campaign.join("model.toml"), model).expect("written");
    let mut noise = Noise(20_021_101);
    let mut rows = String::from("time_s,displacement_m,force_N,lower_Pa,upper_Pa\n");
    for k in 0..3000 {
        let t = 0.01 * f64::from(k);
        let (lower, upper) = (2e6 + 1e6 * libm::sin(1.3 * t), 1.5e6 + 5e5 * libm::cos(2.1 * t));
        let force = 0.001 * lower - 0.0008 * upper + noise.next(5.0);
        let displacement = 0.1 * libm::sin(0.9 * t);
        writeln!(rows, "{t:.2},{displacement:.6},{force:.2},{:.1},{upper:.1}", -lower).expect("text");
    }
    std::fs::write(campaign.join("moves.csv"), rows).expect("written");
    let report = diagnosed(folder.path());
    let effects = report["effects"].as_array().expect("effects");
    let named: Vec<(&Value, &Value)> = effects.iter().map(|e| (&e["id"], &e["place"])).collect();
    assert_eq!(
        named,
        [(&"sensor_sign".into(), &"sensor:lower_Pa".into())],
        "{effects:?}"
    );
    let found = text(&folder.path().join("found/model.toml"));
    assert!(found.contains("lower_Pa = -1.0"), "{found}");
}
