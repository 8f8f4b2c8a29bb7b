//! How well `oleo diagnose` finds an altered strut in the logs of a vehicle: makes campaigns with a known answer, diagnoses each, and
//! prints what was found beside what was concealed.
//!
//! ```text
//! cargo build --release && cargo run --release --example vehicle_logs -- DIR [--seeds N] [--first SEED] [CASE...]
//! ```
//!
//! DIR gets a folder for each campaign, with its answer and the results of the diagnosis.

#[path = "../tests/support/vehicle_campaign.rs"]
mod vehicle_campaign;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use oleo_diagnose::vocabulary::EffectId;
use oleo_interface::Corner;
use oleo_report::{Column, Table};
use vehicle_campaign::{Case, Concealed, drives, write};

/// Length of each of the three drives of a campaign, s.
const DURATION_S: f64 = 24.0;

/// Effect, variant and amount, as the effect's own self-test counts them; `None` of a healthy vehicle.
type Altered = Option<(EffectId, usize, f64)>;

/// Name of a case, what it conceals, and whether all four corners have it.
const CASES: [(&str, Altered, bool); 16] = [
    ("healthy", None, false),
    ("gas_heat_transfer", Some((EffectId::GasHeatTransfer, 0, 3.0)), false),
    ("gas_charge_error_1", Some((EffectId::GasChargeError, 0, 0.08)), false),
    ("gas_charge_error_2", Some((EffectId::GasChargeError, 1, 0.08)), false),
    ("valve3_leakage", Some((EffectId::Valve3Leakage, 0, 2e-8)), false),
    ("damper_leakage_1", Some((EffectId::DamperLeakage, 0, 2e-7)), false),
    ("damper_leakage_2", Some((EffectId::DamperLeakage, 1, 2e-7)), false),
    (
        "accumulator_piston_friction_1",
        Some((EffectId::AccumulatorPistonFriction, 0, 4e4)),
        false,
    ),
    (
        "accumulator_piston_friction_2",
        Some((EffectId::AccumulatorPistonFriction, 1, 4e4)),
        false,
    ),
    ("seal_friction", Some((EffectId::SealFriction, 0, 200.0)), false),
    (
        "oil_compressibility_all",
        Some((EffectId::OilCompressibility, 0, 1.0 / 1.4e9)),
        true,
    ),
    ("gas_heat_transfer_all", Some((EffectId::GasHeatTransfer, 0, 3.0)), true),
    ("real_gas_all", Some((EffectId::RealGas, 0, 1.0)), true),
    ("sensor_gain_p2", Some((EffectId::SensorGain, 3, 0.03)), false),
    ("sensor_lag_p1", Some((EffectId::SensorLag, 2, 0.01)), false),
    ("sensor_lag_p4", Some((EffectId::SensorLag, 5, 0.02)), false),
];

fn main() {
    let mut words = std::env::args().skip(1);
    let (mut folder, mut seeds, mut first, mut wanted) = (None, 1, 1, Vec::new());
    while let Some(word) = words.next() {
        let number = |next: Option<String>| next.and_then(|n| n.parse().ok()).expect("a whole number follows");
        match word.as_str() {
            "--seeds" => seeds = number(words.next()),
            "--first" => first = number(words.next()),
            _ if folder.is_none() => folder = Some(PathBuf::from(word)),
            _ => wanted.push(word),
        }
    }
    let folder = folder.expect("a folder for the campaigns");
    let mut table = Table::new([
        Column::text("Campaign"),
        Column::text("Concealed"),
        Column::text("Found"),
        Column::text("Exact"),
        Column::number("Noise ratio after (worst corner)"),
        Column::number("Time, s"),
    ]);
    let (mut exact, mut campaigns, mut false_alarms) = (0, 0, 0);
    for seed in first..first + seeds {
        for (k, (name, effect, everywhere)) in CASES.iter().enumerate() {
            if !wanted.is_empty() && !wanted.iter().any(|w| w == name) {
                continue;
            }
            let seed = 1000 * seed + k as u64;
            let corners = if *everywhere {
                Corner::ALL.to_vec()
            } else {
                vec![Corner::ALL[(seed % 4) as usize]]
            };
            let concealed = effect.map(|(id, variant, amount)| Concealed {
                id,
                variant,
                amount,
                corners,
            });
            let case = Case {
                seed,
                concealed: concealed.into_iter().collect(),
                drives: drives(seed, DURATION_S),
                first_edition: seed % 2 == 1,
                command_acts_late: false,
            };
            let campaign = folder.join(format!("{name}-{seed}"));
            std::fs::create_dir_all(&campaign).expect("a folder for a campaign");
            write(&case, &campaign);
            let truth = answer(&case);
            let begun = Instant::now();
            let report = diagnose(&campaign);
            let took_s = begun.elapsed().as_secs_f64();
            let found = found(&report);
            campaigns += 1;
            // What acts on the force alone cannot be seen in a vehicle: nothing is the right answer.
            let visible: Vec<String> = truth.iter().filter(|t| !t.contains("main-seal")).cloned().collect();
            let is_exact = found == visible;
            exact += usize::from(is_exact);
            false_alarms += found.iter().filter(|f| !visible.contains(f)).count();
            table.row([
                format!("{name}-{seed}"),
                truth.join(" "),
                found.join(" "),
                if is_exact { "yes" } else { "no" }.to_owned(),
                format!("{:.2}", worst(&report)),
                format!("{took_s:.0}"),
            ]);
            eprintln!("{name}-{seed}: concealed {truth:?}, found {found:?}, {took_s:.0} s");
        }
    }
    println!("{table}\n{exact} of {campaigns} exact, {false_alarms} effects reported that are not there");
}

/// Id and place of what is concealed, as a report should give it.
fn answer(case: &Case) -> Vec<String> {
    let mut all = Vec::new();
    for c in &case.concealed {
        let mut model = oleo_plant_sim::strut::StrutModel::defender110(4000.0);
        let drawn = oleo_diagnose::effect::Drawn {
            variant: c.variant,
            sign: 1.0,
            shape: [0.5; 4],
            response: [0.04, 0.0, 0.0],
        };
        let effect = oleo_diagnose::effect::of(c.id);
        let numbers = effect
            .in_strut()
            .expect("an effect of struts")
            .put_true(&mut model, &drawn, c.amount);
        let part = if c.corners.len() == Corner::ALL.len() {
            "vehicle"
        } else {
            c.corners[0].name()
        };
        all.extend(numbers.iter().map(|number| {
            let site = number.site.to_string().replace("accumulators", "both accumulators");
            format!("{}@{part}/{site}", c.id)
        }));
    }
    all.sort();
    all.dedup();
    all
}

fn diagnose(campaign: &Path) -> serde_json::Value {
    let here = std::env::current_exe().expect("this program has a path");
    let oleo = here
        .parent()
        .and_then(Path::parent)
        .expect("it lies in target/release/examples")
        .join("oleo");
    let out = campaign.join("found");
    let run = Command::new(oleo)
        .arg("diagnose")
        .arg(campaign)
        .arg("--out")
        .arg(&out)
        .output()
        .expect("oleo is built");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let text = std::fs::read_to_string(out.join("report.json")).expect("a report");
    serde_json::from_str(&text).expect("a report in JSON")
}

fn found(report: &serde_json::Value) -> Vec<String> {
    let effects = report["effects"].as_array().expect("a list of effects");
    let text = |v: &serde_json::Value| v.as_str().unwrap_or_default().to_owned();
    let mut all: Vec<String> = effects
        .iter()
        .map(|e| format!("{}@{}", text(&e["id"]), text(&e["place"])))
        .collect();
    all.sort();
    all.dedup();
    all
}

/// The largest noise ratio of the improved model in any channel.
fn worst(report: &serde_json::Value) -> f64 {
    let channels = report["fit"].as_object().expect("figures of the channels");
    channels
        .values()
        .filter_map(|c| c["held_out_after"].as_f64())
        .fold(0.0, f64::max)
}
