//! What faults do in bends that no check finds, or not in time: `cargo run --release -p oleo-hil --example undetected_in_bends`.
//!
//! Each fault begins at 4 s and the bend at about 8 s. Everything runs over the bus with the handling model, at 60 km/h. A row states
//! the worst of all drives: how much further the vehicle rolls than without the fault, and how much later it is decided to close the
//! valves. A fault counts as found if the controller reports it before the bend.

use std::path::Path;

use oleo_controller::Mode;
use oleo_hil::metrics::Metrics;
use oleo_hil::run;
use oleo_hil::scenario::check::{Figure, Metric};
use oleo_hil::scenario::file::parse;
use oleo_interface::tick::TICK_S;

type Failure = Box<dyn std::error::Error>;

/// Manoeuvre, road and seed. On a flat road nothing is random.
const DRIVES: [(&str, &str, u64); 13] = [
    (LANE_CHANGE, "flat", 1),
    (STEP_LEFT, "flat", 1),
    (STEP_RIGHT, "flat", 1),
    (LANE_CHANGE, "iso-c", 1),
    (LANE_CHANGE, "iso-c", 2),
    (LANE_CHANGE, "iso-c", 3),
    (STEP_LEFT, "iso-c", 1),
    (STEP_LEFT, "iso-c", 2),
    (STEP_LEFT, "iso-c", 3),
    (STEP_RIGHT, "iso-c", 1),
    (STEP_RIGHT, "iso-c", 2),
    (STEP_RIGHT, "iso-c", 3),
    (STEP_LEFT, "iso-b", 1),
];
const LANE_CHANGE: &str = "manoeuvre = \"lane-change-2\"\nentry_m = 140\nduration_s = 14";
const STEP_LEFT: &str = "manoeuvre = \"step-steer\"\nsteer_deg = 3\nbegin_s = 8\nduration_s = 40";
const STEP_RIGHT: &str = "manoeuvre = \"step-steer\"\nsteer_deg = -3\nbegin_s = 8\nduration_s = 40";
/// When each bend has not begun yet.
const BEFORE_THE_BEND_S: f64 = 8.0;

/// What is wrong, as a row of the table and as a part of a scenario.
const FAULTS: [(&str, &[&str]); 22] = [
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
    ("p1 front left off by -0.9 MPa", &["sensor-offset front-left.p1 -0.9e6"]),
    ("p1 rear left off by 0.9 MPa", &["sensor-offset rear-left.p1 0.9e6"]),
    (
        "p1 of both left struts off by -0.9 MPa",
        &[
            "sensor-offset front-left.p1 -0.9e6",
            "sensor-offset rear-left.p1 -0.9e6",
        ],
    ),
    (
        "p1 of both left struts off by 0.9 MPa",
        &["sensor-offset front-left.p1 0.9e6", "sensor-offset rear-left.p1 0.9e6"],
    ),
    (
        "p1 front left drifts by 0.1 MPa/s",
        &["sensor-drift front-left.p1 0.1e6"],
    ),
    (
        "p2 and p3 front left off by 0.9 MPa",
        &["sensor-offset front-left.p2 0.9e6", "sensor-offset front-left.p3 0.9e6"],
    ),
    (
        "p1, p2 and p3 front left off by 0.9 MPa",
        &[
            "sensor-offset front-left.p1 0.9e6",
            "sensor-offset front-left.p2 0.9e6",
            "sensor-offset front-left.p3 0.9e6",
        ],
    ),
    (
        "all four pressures front left off by 0.9 MPa",
        &[
            "sensor-offset front-left.p1 0.9e6",
            "sensor-offset front-left.p2 0.9e6",
            "sensor-offset front-left.p3 0.9e6",
            "sensor-offset front-left.p4 0.9e6",
        ],
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
    decision_s: Option<f64>,
    found: bool,
    ended_well: bool,
}

fn drive((manoeuvre, road, seed): (&str, &str, u64), faults: &[&str]) -> Result<Seen, Failure> {
    let mut text =
        format!("name = \"bend\"\nroad = \"{road}\"\nspeed_km_h = 60\nscore_from_s = 3\nseed = {seed}\n{manoeuvre}\n");
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
        decision_s: number(Metric::Decision),
        found: (metrics.account.iter())
            .take((BEFORE_THE_BEND_S / TICK_S) as usize)
            .flatten()
            .any(|(mode, _)| faulty(*mode)),
        ended_well: metrics.figure(Metric::Ending) == Figure::Word("completed"),
    })
}

fn main() -> Result<(), Failure> {
    let all = |faults: &[&str]| {
        DRIVES
            .into_iter()
            .map(|case| drive(case, faults))
            .collect::<Result<Vec<_>, Failure>>()
    };
    let sound = all(&[])?;
    println!(
        "| fault | peak roll over that without the fault | peak roll, degrees | decision later by, s | found before the bend | not completed |"
    );
    println!("|---|---|---|---|---|---|");
    for (name, faults) in FAULTS {
        let seen = all(faults)?;
        let worst = |of: &dyn Fn(&Seen, &Seen) -> f64| {
            (seen.iter().zip(&sound))
                .map(|(seen, sound)| of(seen, sound))
                .fold(f64::NEG_INFINITY, f64::max)
        };
        let later = |seen: &Seen, sound: &Seen| match (seen.decision_s, sound.decision_s) {
            (Some(seen), Some(sound)) => seen - sound,
            (None, Some(_)) => f64::INFINITY,
            _ => 0.0,
        };
        println!(
            "| {name} | {:.2} | {:.1} | {:.2} | {} of {} | {} |",
            worst(&|seen, sound| seen.roll_deg / sound.roll_deg),
            worst(&|seen, _| seen.roll_deg),
            worst(&later),
            seen.iter().filter(|seen| seen.found).count(),
            seen.len(),
            seen.iter().filter(|seen| !seen.ended_well).count(),
        );
    }
    Ok(())
}
