//! What the safe state does to a vehicle that is in a bend, and what a controller does that starts in motion:
//! `cargo run --release -p oleo-hil --example silence_in_bends`.
//!
//! In the first table the bus falls silent for good at some time of a manoeuvre, so that all valves close and stay closed; in the
//! second the controller restarts, before the bend or in it, and knows nothing of what was. Everything runs over the bus
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
/// What happens, and when for the first time and how often, in how long steps, s: from before the bend on, which begins at 8 s.
struct Fault {
    kind: &'static str,
    first_s: f64,
    every_s: f64,
}
const SILENCE: Fault = Fault {
    kind: "kind = \"silence\"\nfor_s = 100\n",
    first_s: 7.5,
    every_s: 0.15,
};
const RESTART: Fault = Fault {
    kind: "kind = \"node-restarted\"\nnode = \"controller\"\nfor_s = 0.2\n",
    first_s: 2.0,
    every_s: 0.3,
};
const FAULTS: u32 = 36;
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

fn drive(
    (_, manoeuvre, speed, road, _): (&str, &str, u32, &str, bool),
    fault: Option<(&Fault, f64)>,
) -> Result<Seen, Failure> {
    let mut text = format!("name = \"bend\"\nroad = \"{road}\"\nspeed_km_h = {speed}\nscore_from_s = 3\n{manoeuvre}\n");
    if let Some((fault, at_s)) = fault {
        text += &format!("[[fault]]\nat_s = {at_s}\n{}", fault.kind);
    }
    let scenario = parse(&text, "bend.toml", Path::new(""))?;
    let outcome = run::both(&scenario, run::vehicle(&scenario)?, 1, &mut |_| true)?;
    let samples = &outcome.plant.recording.samples;
    let roll_deg = |sample: &Sample| sample.motion.body.roll_rad.to_degrees();
    let last = &samples[samples.len().saturating_sub((LAST_S / TICK_S) as usize)..];
    let begun_s = fault.map_or(SILENCE.first_s, |(_, at_s)| at_s);
    let begun = ((begun_s / TICK_S) as usize).min(samples.len());
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
    table(&SILENCE)?;
    println!();
    table(&RESTART)
}

fn table(fault: &Fault) -> Result<(), Failure> {
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
            let seen = drive(case, Some((fault, fault.first_s + fault.every_s * f64::from(k))))?;
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
