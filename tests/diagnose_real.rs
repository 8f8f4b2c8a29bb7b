//! Real hardware: what `oleo diagnose` says of measured gas springs, pneumatic cylinders, a ram, a damper and a drive, and how well what it
//! found predicts the part of a recording, or the pressure, that was kept from it. The recordings are other people's and
//! not part of the project (docs/diagnose.md names the sources); without them each test says that it skips.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

const FOLDER: &str = "../shared/recordings/real";

/// Runs a diagnosis and reads its report; `None` (and a loud line) where the recordings are absent.
fn report(campaign: &str, options: &[&str]) -> Option<Value> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(FOLDER).join(campaign);
    if !folder.is_dir() {
        println!("SKIPPED: no recordings at {FOLDER}/{campaign}");
        return None;
    }
    let out = tempfile::tempdir().expect("a folder");
    let out = out.path().join("found");
    let run = Command::new(env!("CARGO_BIN_EXE_oleo"))
        .arg("diagnose")
        .arg(folder)
        .args(options)
        .arg("--out")
        .arg(&out)
        .output()
        .expect("the program starts");
    assert!(
        run.status.success(),
        "{campaign}: {}",
        String::from_utf8_lossy(&run.stderr)
    );
    print!("{}", String::from_utf8_lossy(&run.stdout));
    Some(read(&out.join("report.json")))
}

fn read(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).expect("a file")).expect("JSON")
}

/// `id@place` of every effect, sorted.
fn effects(report: &Value) -> Vec<String> {
    let mut names: Vec<String> = (report["effects"].as_array().expect("a list").iter())
        .map(|e| {
            format!(
                "{}@{}",
                e["id"].as_str().unwrap_or("?"),
                e["place"].as_str().unwrap_or("?")
            )
        })
        .collect();
    names.sort();
    names
}

/// A parameter of an effect: value and interval.
fn parameter(report: &Value, id: &str, key: &str) -> (f64, [f64; 2]) {
    let effects = report["effects"].as_array().expect("a list");
    let effect = effects
        .iter()
        .find(|e| e["id"] == id)
        .unwrap_or_else(|| panic!("no {id}"));
    let p = &effect["parameters"][key];
    let number = |v: &Value| v.as_f64().unwrap_or(f64::NAN);
    (number(&p["value"]), [number(&p["ci95"][0]), number(&p["ci95"][1])])
}

/// Noise ratio of a model on what was kept back.
fn kept_back(report: &Value, model: &str, channel: &str) -> f64 {
    let models = report["kept_back"]["models"].as_array().expect("a list");
    let found = models
        .iter()
        .find(|m| m["model"] == model)
        .unwrap_or_else(|| panic!("no model '{model}'"));
    found["noise_ratio_kept_back"][channel].as_f64().expect("a number")
}

fn note(report: &Value, text: &str) -> bool {
    (report["notes"].as_array().expect("a list").iter()).any(|n| n.as_str().is_some_and(|n| n.contains(text)))
}

#[test]
#[cfg_attr(
    debug_assertions,
    ignore = "half a minute without optimisation; the recordings step of ./test runs it"
)]
fn every_campaign_beside_the_checkout_opens() {
    let recordings = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/recordings");
    if !recordings.is_dir() {
        println!("SKIPPED: no recordings at ../shared/recordings");
        return;
    }
    let mut opened = 0;
    for group in ["labelled", "blind", "real"] {
        for entry in std::fs::read_dir(recordings.join(group)).expect("a folder") {
            let folder = entry.expect("an entry").path();
            if !folder.is_dir() {
                continue;
            }
            match oleo_diagnose::Campaign::open(&folder) {
                Ok(_) => opened += 1,
                Err(error) => panic!("{error}"),
            }
        }
    }
    println!("{opened} campaigns");
    assert!(opened >= 33, "{opened}");
}

#[test]
#[cfg_attr(
    debug_assertions,
    ignore = "minutes without optimisation; the recordings step of ./test runs it"
)]
fn gas_springs_of_2022_lack_heat_transfer_and_nothing_else() {
    for chamber in ["lower", "upper"] {
        let campaign = format!("gas-spring-2022-{chamber}");
        let Some(all) = report(&campaign, &[]) else { return };
        assert_eq!(effects(&all), ["gas_heat_transfer@chamber"], "{campaign}");

        let Some(half) = report(&campaign, &["--fit-until", "0.5"]) else {
            return;
        };
        assert_eq!(effects(&half), ["gas_heat_transfer@chamber"], "{campaign}, first half");
        let improved = kept_back(&half, "improved", "p_Pa");
        // Against the adiabatic model as given, and against the same with volume, pressure and temperature refitted.
        assert!(5.0 * improved < kept_back(&half, "as given", "p_Pa"), "{campaign}");
        assert!(
            5.0 * improved < kept_back(&half, "recalibrated within tolerance", "p_Pa"),
            "{campaign}"
        );
        // Free convection predicts better than heat that goes in proportion to the difference of temperatures.
        let in_proportion = kept_back(&half, "gas_heat_transfer@chamber alone", "p_Pa");
        assert!(
            improved < 0.85 * in_proportion,
            "{campaign}: {improved} and {in_proportion}"
        );
        // Every rival predicts worse than heat transfer, by as much as the adiabatic model.
        for rival in half["kept_back"]["models"].as_array().expect("a list").iter().skip(3) {
            if rival["model"] == "gas_heat_transfer@chamber alone" {
                continue;
            }
            let theirs = rival["noise_ratio_kept_back"]["p_Pa"].as_f64().expect("a number");
            assert!(5.0 * improved < theirs, "{campaign}: {rival}");
        }
        // The first half's moves and all of them ask for one time constant, as far as their intervals tell.
        let (_, first) = parameter(&half, "gas_heat_transfer", "time_constant_at_10_K_s");
        let (_, whole) = parameter(&all, "gas_heat_transfer", "time_constant_at_10_K_s");
        assert!(
            first[0] < whole[1] && whole[0] < first[1],
            "{campaign}: {first:?} and {whole:?}"
        );
    }
}

#[test]
#[cfg_attr(
    debug_assertions,
    ignore = "minutes without optimisation; the recordings step of ./test runs it"
)]
fn gas_springs_of_2021_lack_heat_transfer_and_their_clocks_differ() {
    let mut delays = Vec::new();
    for chamber in ["lower", "upper"] {
        let campaign = format!("gas-spring-2021-{chamber}");
        let Some(all) = report(&campaign, &[]) else { return };
        assert_eq!(
            effects(&all),
            ["gas_heat_transfer@chamber", "sensor_skew@sensor:p_Pa"],
            "{campaign}"
        );
        // The corners of the motion say so without any model of the gas.
        assert!(
            note(&all, "the clocks of the two columns differ"),
            "{campaign}: {}",
            all["notes"]
        );
        delays.push(parameter(&all, "sensor_skew", "delay_s").0);

        let Some(half) = report(&campaign, &["--fit-until", "0.5"]) else {
            return;
        };
        let improved = kept_back(&half, "improved", "p_Pa");
        assert!(
            4.0 * improved < kept_back(&half, "recalibrated within tolerance", "p_Pa"),
            "{campaign}"
        );
        // Heat transfer earns its name beside the skew: without it the late clock predicts worse than nothing.
        let heat = "gas_heat_transfer@chamber (free convection)";
        let without = kept_back(&half, &format!("improved, without {heat}"), "p_Pa");
        assert!(4.0 * improved < without, "{campaign}");
    }
    // One logger, two chambers: one delay, to within three samples.
    assert!((delays[0] - delays[1]).abs() < 0.07, "{delays:?}");
}

/// One column of the ram's recording with the wrong sign is named first, and the rest is what it is without this.
#[test]
#[cfg_attr(
    debug_assertions,
    ignore = "minutes without optimisation; the recordings step of ./test runs it"
)]
fn an_instrument_that_is_connected_the_wrong_way_round_is_asked_first() {
    let recorded = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(FOLDER).join("ram-2022");
    let Some(healthy) = report("ram-2022", &[]) else { return };
    for reversed in ["force_N", "ram_lower_Pa"] {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::copy(recorded.join("model.toml"), folder.path().join("model.toml")).expect("a copy");
        let text = std::fs::read_to_string(recorded.join("moves.csv")).expect("a recording");
        let (head, rows) = text.split_once('\n').expect("a head");
        let column = head
            .trim()
            .split(',')
            .position(|name| name == reversed)
            .expect("a column");
        let rows = rows.lines().map(|row| {
            let mut cells: Vec<String> = row.split(',').map(str::to_owned).collect();
            let value: f64 = cells[column].trim().parse().expect("a number");
            cells[column] = (-value).to_string();
            cells.join(",") + "\n"
        });
        let text = format!("{head}\n{}", rows.collect::<String>());
        std::fs::write(folder.path().join("moves.csv"), text).expect("a recording");
        let found = report(folder.path().to_str().expect("a path"), &[]).expect("a report");
        let sign = format!("sensor_sign@sensor:{reversed}");
        assert!(effects(&found).contains(&sign), "{reversed}: {:?}", effects(&found));
        let after = |report: &Value| report["fit"]["force_N"]["held_out_after"].as_f64().expect("a ratio");
        assert!(after(&found) < 1.25 * after(&healthy), "{reversed}: {}", after(&found));
    }
}

#[test]
#[cfg_attr(
    debug_assertions,
    ignore = "minutes without optimisation; the recordings step of ./test runs it"
)]
fn friction_of_pneumatic_seals_grows_with_pressure() {
    for seal in ["o-ring", "kdn"] {
        let campaign = format!("pneumatic-{seal}");
        let Some(all) = report(&campaign, &[]) else { return };
        let found = effects(&all);
        assert!(
            found.contains(&"side_load_friction@main-seal".to_owned()),
            "{campaign}: {found:?}"
        );
        assert!(
            found.iter().all(|e| e.ends_with("_friction@main-seal")),
            "{campaign}: {found:?}"
        );

        let Some(held) = report(&campaign, &["--hold-out", "5bar"]) else {
            return;
        };
        let improved = kept_back(&held, "improved", "force_N");
        assert!(4.0 * improved < kept_back(&held, "as given", "force_N"), "{campaign}");
        if seal == "o-ring" {
            // Between 1 and 3 bar this seal's friction grows by two fifths: that predicts 5 bar, plain Coulomb does not.
            assert!(
                effects(&held).contains(&"side_load_friction@main-seal".to_owned()),
                "{campaign}"
            );
            assert!(
                improved < 0.8 * kept_back(&held, "seal_friction@main-seal alone", "force_N"),
                "{campaign}"
            );
        } else {
            // This one's grows by 0.04 N there, a seventh of the noise: it is not named from 1 and 3 bar.
            assert_eq!(effects(&held), ["seal_friction@main-seal"], "{campaign}");
        }
    }
}

#[test]
#[cfg_attr(
    debug_assertions,
    ignore = "minutes without optimisation; the recordings step of ./test runs it"
)]
fn the_ram_has_friction_and_a_late_load_cell() {
    let Some(all) = report("ram-2022", &[]) else { return };
    assert_eq!(
        effects(&all),
        ["sensor_lag@sensor:force_N", "side_load_friction@main-seal"]
    );
    let (lag, _) = parameter(&all, "sensor_lag", "time_constant_s");
    // The same from the changes of force and pressures alone, without model (a sample is 20 ms).
    assert!((lag - 0.021).abs() < 0.005, "{lag}");
    assert!(
        note(&all, "changes of force_N follow those of the pressures after 2"),
        "{}",
        all["notes"]
    );
    // Half the difference between in and out doubles with the pressing force: friction that grows, not an offset.
    assert!(note(&all, "half the difference is"), "{}", all["notes"]);
}

/// Root mean square error of a damper's force on what was kept back, N. The noise that its model states is 5 N.
fn force_error_n(report: &Value, model: &str) -> f64 {
    5.0 * kept_back(report, model, "force_N")
}

#[test]
#[cfg_attr(
    debug_assertions,
    ignore = "minutes without optimisation; the recordings step of ./test runs it"
)]
fn the_magneto_rheological_damper_has_a_hysteresis_and_a_smooth_yield_at_every_current() {
    let both = ["presliding_friction@damper", "smooth_yield@damper"];
    for current in ["0A", "050A", "100A"] {
        let campaign = format!("damper-mr-{current}");
        let Some(all) = report(&campaign, &[]) else { return };
        let found = effects(&all);
        assert!(
            both.iter().all(|name| found.contains(&(*name).to_owned())),
            "{campaign}: {found:?}"
        );
        assert!(
            !found.iter().any(|name| name.starts_with("sensor_")),
            "{campaign}: {found:?}"
        );
    }
    // Fitted on two sines, the third is predicted; a late load cell, which fits two sines well, is not believed.
    for sine in ["25mm0p5Hz", "10mm1Hz", "5mm3Hz"] {
        let Some(held) = report("damper-mr-100A", &["--hold-out", sine]) else {
            return;
        };
        assert_eq!(effects(&held), both, "without {sine}");
        let improved = force_error_n(&held, "improved");
        assert!(improved < 130.0, "{sine}: {improved} N");
        assert!(
            improved < 0.4 * force_error_n(&held, "recalibrated within tolerance"),
            "{sine}"
        );
    }
}

#[test]
#[cfg_attr(
    debug_assertions,
    ignore = "minutes without optimisation; the recordings step of ./test runs it"
)]
fn the_drive_needs_friction_and_a_constant_force() {
    let Some(half) = report("drive-emps", &["--fit-until", "0.5"]) else {
        return;
    };
    let found = effects(&half);
    assert!(found.iter().any(|name| name.ends_with("_friction@drive")), "{found:?}");
    assert!(found.iter().all(|name| name.ends_with("@drive")), "{found:?}");
    assert!(found.iter().any(|name| name == "force_offset@drive"), "{found:?}");
    // The noise that the model states is 10 um. By hand, Coulomb friction and a constant force reach 2.5 mm.
    let error_mm = 0.01 * kept_back(&half, "improved", "position_m");
    assert!(error_mm <= 2.5, "{error_mm} mm");
    // Neither of the two does without the other.
    for name in &found {
        let without = half["kept_back"]["models"]
            .as_array()
            .expect("a list")
            .iter()
            .find(|m| {
                m["model"]
                    .as_str()
                    .is_some_and(|m| m.starts_with(&format!("improved, without {name}")))
            });
        let without = without.expect("the model without it")["noise_ratio_kept_back"]["position_m"].as_f64();
        assert!(0.01 * without.expect("a number") > 3.0 * error_mm, "{name}");
    }
}
