//! What the safe state does to a vehicle that is in a bend: `cargo run --release -p oleo-hil --example silence_in_bends`.
//!
//! The bus falls silent for good at some time of a manoeuvre, so that all valves close and stay closed. Everything runs over the bus
//! with the handling model and the controller. A row states the worst over all times of the fault: peak roll, also over that of the
//! same drive without a fault, the lean that is left on the straight behind the manoeuvre, and how far a corner stands there from
//! its height. `safe_states` of `plant-sim` compares the safe state with its alternatives.

use std::path::Path;

use oleo_hil::record::Sample;
use oleo_hil::run;
use oleo_hil::scenario::file::parse;
use oleo_interface::tick::TICK_S;

type Failure = Box<dyn std::error::Error>;

/// Name, manoeuvre, speed in km/h, road, and whether it ends on a straight.
const DRIVES: [(&str, &str, u32, &str, bool); 6] = [
    ("lane change 3888-2", LANE_CHANGE, 60, "flat", true),
    ("lane change 3888-2", LANE_CHANGE, 60, "iso-c", true),
    ("lane change 3888-2", LANE_CHANGE, 60, "iso-d", true),
    ("lane change 3888-2", LANE_CHANGE, 60, "belgian", true),
    ("step steer", STEP, 60, "iso-d", false),
    ("step steer", STEP, 80, "flat", false),
];
const LANE_CHANGE: &str = "manoeuvre = \"lane-change-2\"\nentry_m = 140\nduration_s = 20";
const STEP: &str = "manoeuvre = \"step-steer\"\nsteer_deg = 3\nbegin_s = 8\nduration_s = 16";
/// From before the bend on, in steps, s.
const FIRST_FAULT_S: f64 = 7.5;
const FAULTS: u32 = 36;
const EVERY_S: f64 = 0.15;
/// The last stretch of a drive, on which lean and heights are measured, s.
const LAST_S: f64 = 1.0;

/// What one drive showed.
struct Seen {
    roll_deg: f64,
    lean_deg: f64,
    height_m: f64,
}

fn mean(samples: &[Sample], quantity: impl Fn(&Sample) -> f64) -> f64 {
    samples.iter().map(quantity).sum::<f64>() / samples.len() as f64
}

fn drive((_, manoeuvre, speed, road, _): (&str, &str, u32, &str, bool), fault_s: Option<f64>) -> Result<Seen, Failure> {
    let mut text = format!("name = \"bend\"\nroad = \"{road}\"\nspeed_km_h = {speed}\nscore_from_s = 3\n{manoeuvre}\n");
    if let Some(fault_s) = fault_s {
        text += &format!("[[fault]]\nkind = \"silence\"\nat_s = {fault_s}\nfor_s = 100\n");
    }
    let scenario = parse(&text, "bend.toml", Path::new(""))?;
    let outcome = run::both(&scenario, run::vehicle(&scenario)?, 1, &mut |_| true)?;
    let samples = &outcome.plant.recording.samples;
    let roll_deg = |sample: &Sample| sample.motion.body.roll_rad.to_degrees();
    let last = &samples[samples.len().saturating_sub((LAST_S / TICK_S) as usize)..];
    let begun = ((fault_s.unwrap_or(FIRST_FAULT_S) / TICK_S) as usize).min(samples.len());
    Ok(Seen {
        roll_deg: samples[begun..]
            .iter()
            .map(|sample| roll_deg(sample).abs())
            .fold(0.0, f64::max),
        lean_deg: mean(last, roll_deg).abs(),
        height_m: oleo_interface::Corner::ALL
            .map(|corner| mean(last, |sample| sample.displacement_m[corner]).abs())
            .into_iter()
            .fold(0.0, f64::max),
    })
}

fn main() -> Result<(), Failure> {
    println!(
        "| drive | peak roll without the fault, degrees | with it, worst | ratio | lean left on the straight, degrees | corner off its height, mm |"
    );
    println!("|---|---|---|---|---|---|");
    for case in DRIVES {
        let sound = drive(case, None)?;
        let mut worst = Seen {
            roll_deg: 0.0,
            lean_deg: 0.0,
            height_m: 0.0,
        };
        for k in 0..FAULTS {
            let seen = drive(case, Some(FIRST_FAULT_S + EVERY_S * f64::from(k)))?;
            worst.roll_deg = worst.roll_deg.max(seen.roll_deg);
            worst.lean_deg = worst.lean_deg.max(seen.lean_deg);
            worst.height_m = worst.height_m.max(seen.height_m);
        }
        let (name, _, speed, road, ends_straight) = case;
        let straight = |figure: String| if ends_straight { figure } else { "-".to_owned() };
        println!(
            "| {name}, {speed} km/h, {road} | {:.2} | {:.2} | {:.2} | {} | {} |",
            sound.roll_deg,
            worst.roll_deg,
            worst.roll_deg / sound.roll_deg,
            straight(format!("{:.2}", worst.lean_deg)),
            straight(format!("{:.0}", 1e3 * worst.height_m)),
        );
    }
    Ok(())
}
