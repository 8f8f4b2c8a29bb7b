//! What faults do in a bend that no check finds: `cargo run --release -p oleo-hil --example undetected_in_bends`.
//!
//! Each fault begins 4 s before the manoeuvre, and everything runs over the bus with the handling model. A row states the worst of all
//! drives: how much more the vehicle rolls than without the fault, how long a wheel is off the ground, how much later it is decided to close the valves, and in
//! how many of the drives the controller found the fault before the end.

use std::path::Path;

use oleo_controller::Mode;
use oleo_hil::metrics::Metrics;
use oleo_hil::run;
use oleo_hil::scenario::check::{Figure, Metric};
use oleo_hil::scenario::file::parse;
use oleo_interface::tick::TICK_S;

type Failure = Box<dyn std::error::Error>;

/// Manoeuvre, road, and time at which it begins, s.
const DRIVES: [(&str, &str); 3] = [
    ("manoeuvre = \"lane-change-2\"\nentry_m = 140", "flat"),
    ("manoeuvre = \"step-steer\"\nsteer_deg = 3\nbegin_s = 8", "flat"),
    ("manoeuvre = \"lane-change-2\"\nentry_m = 140", "iso-c"),
];
const SEEDS: [u64; 3] = [1, 2, 3];

/// What is wrong, as a row of the table and as a part of a scenario.
const FAULTS: [(&str, &[&str]); 15] = [
    (
        "displacement front left off by 35 mm",
        &["sensor-offset front-left.displacement 0.035"],
    ),
    (
        "displacement front left off by -35 mm",
        &["sensor-offset front-left.displacement -0.035"],
    ),
    (
        "both left displacements off by 35 mm",
        &[
            "sensor-offset front-left.displacement 0.035",
            "sensor-offset rear-left.displacement 0.035",
        ],
    ),
    (
        "both left displacements off by -35 mm",
        &[
            "sensor-offset front-left.displacement -0.035",
            "sensor-offset rear-left.displacement -0.035",
        ],
    ),
    (
        "displacement front left drifts by 2 mm/s",
        &["sensor-drift front-left.displacement 0.002"],
    ),
    (
        "displacement front left with gain 0.5",
        &["sensor-gain front-left.displacement 0.5"],
    ),
    (
        "displacement front left with gain 1.5",
        &["sensor-gain front-left.displacement 1.5"],
    ),
    (
        "all displacements with gain 0.5",
        &[
            "sensor-gain front-left.displacement 0.5",
            "sensor-gain front-right.displacement 0.5",
            "sensor-gain rear-left.displacement 0.5",
            "sensor-gain rear-right.displacement 0.5",
        ],
    ),
    ("p1 front left off by 0.9 MPa", &["sensor-offset front-left.p1 0.9e6"]),
    (
        "p1 of both left struts off by 0.9 MPa",
        &["sensor-offset front-left.p1 0.9e6", "sensor-offset rear-left.p1 0.9e6"],
    ),
    ("valve 1 front left stuck open", &["solenoid-stuck front-left.1 open"]),
    ("valve 2 front left stuck open", &["solenoid-stuck front-left.2 open"]),
    (
        "valves 1 and 2 of all struts stuck open",
        &[
            "solenoid-stuck front-left.1 open",
            "solenoid-stuck front-left.2 open",
            "solenoid-stuck front-right.1 open",
            "solenoid-stuck front-right.2 open",
            "solenoid-stuck rear-left.1 open",
            "solenoid-stuck rear-left.2 open",
            "solenoid-stuck rear-right.1 open",
            "solenoid-stuck rear-right.2 open",
        ],
    ),
    ("valve 3 front left stuck open", &["solenoid-stuck front-left.3 open"]),
    (
        "valve 3 front left stuck closed",
        &["solenoid-stuck front-left.3 closed"],
    ),
];

/// What one drive showed.
struct Seen {
    roll_deg: f64,
    lift_s: f64,
    decision_s: Option<f64>,
    found: bool,
    ended_well: bool,
}

fn drive((manoeuvre, road): (&str, &str), seed: u64, faults: &[&str]) -> Result<Seen, Failure> {
    let mut text = format!(
        "name = \"bend\"\nroad = \"{road}\"\nspeed_km_h = 60\nduration_s = 14\nscore_from_s = 3\nseed = {seed}\n{manoeuvre}\n"
    );
    for fault in faults {
        let mut words = fault.split(' ');
        let mut next = || words.next().unwrap_or_default();
        let (kind, place, value) = (next(), next(), next());
        text += &match kind {
            "solenoid-stuck" => {
                format!("[[fault]]\nkind = \"{kind}\"\nat_s = 4\nvalve = \"{place}\"\nposition = \"{value}\"\n")
            }
            _ => format!("[[fault]]\nkind = \"{kind}\"\nat_s = 4\nsensor = \"{place}\"\nvalue = {value}\n"),
        };
    }
    let scenario = parse(&text, "bend.toml", Path::new(""))?;
    let outcome = run::both(&scenario, run::vehicle(&scenario)?, 1, &mut |_| true)?;
    let metrics = Metrics::of(&scenario, &outcome);
    let number = |metric| match metrics.figure(metric) {
        Figure::Number(number) => Some(number),
        _ => None,
    };
    let faulty = |mode: Mode| !matches!(mode, Mode::StartUp | Mode::Normal);
    Ok(Seen {
        roll_deg: number(Metric::MaxRoll).unwrap_or(f64::NAN),
        lift_s: number(Metric::WheelLift).unwrap_or(0.0) * f64::from(metrics.ticks) * TICK_S,
        decision_s: number(Metric::Decision),
        found: metrics.account.iter().flatten().any(|(mode, _)| faulty(*mode)),
        ended_well: metrics.figure(Metric::Ending) == Figure::Word("completed"),
    })
}

fn main() -> Result<(), Failure> {
    let cases: Vec<_> = (DRIVES.into_iter())
        .flat_map(|drive| SEEDS.map(|seed| (drive, seed)))
        .collect();
    let sound = (cases.iter())
        .map(|(case, seed)| drive(*case, *seed, &[]))
        .collect::<Result<Vec<_>, Failure>>()?;
    println!(
        "| fault | peak roll / without | peak roll, degrees | wheel off the ground longer by, s | decided later by, s | found | not completed |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (name, faults) in FAULTS {
        let seen = (cases.iter())
            .map(|(case, seed)| drive(*case, *seed, faults))
            .collect::<Result<Vec<_>, Failure>>()?;
        let worst = |of: &dyn Fn(&Seen, &Seen) -> f64| {
            seen.iter()
                .zip(&sound)
                .map(|(seen, sound)| of(seen, sound))
                .fold(f64::NEG_INFINITY, f64::max)
        };
        let later = |seen: &Seen, sound: &Seen| match (seen.decision_s, sound.decision_s) {
            (Some(seen), Some(sound)) => seen - sound,
            (None, Some(_)) => f64::INFINITY,
            _ => 0.0,
        };
        println!(
            "| {name} | {:.2} | {:.1} | {:.2} | {:.2} | {} of {} | {} |",
            worst(&|seen, sound| seen.roll_deg / sound.roll_deg),
            worst(&|seen, _| seen.roll_deg),
            worst(&|seen, sound| seen.lift_s - sound.lift_s),
            worst(&later),
            seen.iter().filter(|seen| seen.found).count(),
            seen.len(),
            seen.iter().filter(|seen| !seen.ended_well).count(),
        );
    }
    Ok(())
}
