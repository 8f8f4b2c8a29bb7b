//! Does an effect become visible where the report says so? `cargo run --release -p oleo-diagnose --example least_sizes`.
//!
//! The same campaign of the self-test, with the same motions and the same noise, is made with one concealed effect of eight growing
//! sizes. The report of the largest that is not found states from which size the effect would have been found in 19 of 20
//! campaigns. A row counts, for sizes below and above that, in how many campaigns the effect was found.

use std::sync::atomic::AtomicBool;

use oleo_diagnose::estimation::LeastSquares;
use oleo_diagnose::selftest::{Case, save};
use oleo_diagnose::vocabulary::EffectId;
use oleo_diagnose::{Campaign, Diagnosis};
use serde_json::Value;

type Failure = Box<dyn std::error::Error>;

/// Wanted sizes, RMS in units of noise. Whether the recordings show an effect is decided somewhere among them.
const SIZES: [f64; 8] = [0.02, 0.05, 0.08, 0.11, 0.15, 0.2, 0.3, 0.5];
const CAMPAIGNS: usize = 3;
const EFFECTS: [EffectId; 6] = [
    EffectId::SealFriction,
    EffectId::DamperLeakage,
    EffectId::Valve3Leakage,
    EffectId::MountCompliance,
    EffectId::GasChargeError,
    EffectId::SensorGain,
];
/// Bounds of the columns, as parts of the least size.
const PARTS: [f64; 5] = [0.25, 0.5, 0.8, 1.25, f64::INFINITY];

/// One campaign with one size of the effect.
struct Tried {
    place: String,
    key: String,
    value: f64,
    found: bool,
    report: Vec<Value>,
}

impl Tried {
    /// The size from which its report says that the effect would have been found at its place.
    fn least(&self, id: EffectId) -> Option<f64> {
        let of_effect = |entry: &&Value| entry["id"] == id.as_str() && entry["place"] == self.place.as_str();
        (self.report.iter()).find(of_effect)?["shown_from"][&self.key].as_f64()
    }
}

fn tried(id: EffectId, number: usize, size: f64) -> Result<Tried, Failure> {
    let case = Case {
        name: format!("least_sizes:{id}:{number}"),
        hidden: vec![(id, size)],
        variants: vec![],
        left_out: None,
        flaw: None,
    };
    let folder = tempfile::tempdir()?;
    save(&case, folder.path())?;
    let campaign = std::fs::read_dir(folder.path())?.next().ok_or("a campaign")??.path();
    let answer: Value = serde_json::from_str(&std::fs::read_to_string(campaign.join("answer.json"))?)?;
    std::fs::remove_file(campaign.join("answer.json"))?;
    std::fs::remove_dir_all(campaign.join("unseen"))?;
    let truth = &answer["truth"][0];
    let text = |key: &str| truth[key].as_str().unwrap_or_default().to_owned();
    let opened = Campaign::open(&campaign)?;
    let stop = AtomicBool::new(false);
    let diagnosis = Diagnosis::of(&LeastSquares::new(&*opened.specimen, &stop), &|_, _| {})?;
    Ok(Tried {
        place: text("place"),
        key: text("key"),
        value: truth["value"].as_f64().ok_or("a number")?.abs(),
        found: (diagnosis.effects.iter()).any(|effect| effect.id == id && effect.selected.is_some()),
        report: oleo_diagnose::json::rejected(&*opened.specimen, &diagnosis),
    })
}

fn main() -> Result<(), Failure> {
    println!(
        "| effect | least size, mean | below 1/4 of it | to 1/2 | to 4/5 | to 5/4 | above |\n|---|---|---|---|---|---|---|"
    );
    for id in EFFECTS {
        let mut counts = [(0, 0); PARTS.len()];
        let mut leasts: Vec<f64> = Vec::new();
        for number in 0..CAMPAIGNS {
            let all = SIZES.map(|size| tried(id, number, size));
            let all = all.into_iter().collect::<Result<Vec<Tried>, Failure>>()?;
            let Some(least) = all.iter().rev().filter(|one| !one.found).find_map(|one| one.least(id)) else {
                continue;
            };
            leasts.push(least);
            for one in &all {
                // Of a stiffness the least size is the largest value.
                let is_inverse = one.key.contains("stiffness");
                let part = if is_inverse {
                    least / one.value
                } else {
                    one.value / least
                };
                let column = PARTS.iter().position(|bound| part < *bound).unwrap_or(PARTS.len() - 1);
                counts[column].0 += usize::from(one.found);
                counts[column].1 += 1;
            }
        }
        let mean = leasts.iter().sum::<f64>() / leasts.len() as f64;
        let columns = counts.map(|(found, of)| {
            if of == 0 {
                "-".into()
            } else {
                format!("{found} of {of}")
            }
        });
        println!("| {id} | {mean:.2e} | {} |", columns.join(" | "));
    }
    Ok(())
}
