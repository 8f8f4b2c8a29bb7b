//! What faults do in bends that no check finds, or not in time: `cargo run --release -p oleo-hil --example undetected_in_bends`.
//!
//! Each fault begins at 4 s, or is there when the controller starts, and the bend begins at about 8 s. Everything runs over the bus with
//! the handling model, at 60 km/h. A row states the worst of all drives: how much further the vehicle rolls than without the fault, and
//! how much later it is decided to close the valves. A fault counts as found if the controller leaves its normal mode before the bend,
//! or never reaches it.

use std::path::Path;

use oleo_controller::Mode;
use oleo_hil::metrics::Metrics;
use oleo_hil::run;
use oleo_hil::scenario::check::{Figure, Metric};
use oleo_hil::scenario::file::parse;
use oleo_interface::Corner;
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

/// When the faults begin that are not there from power-on, s.
const BEGIN_S: f64 = 4.0;

/// What is wrong: a row of the table, and parts of a scenario. The place `all` is every corner.
const FAULTS: [(&str, &[&str]); 26] = [
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
    ("all displacements with gain 0.5", &["sensor-gain all.displacement 0.5"]),
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
        &["solenoid-stuck all.1 open", "solenoid-stuck all.2 open"],
    ),
    ("valve 3 front left stuck open", &["solenoid-stuck front-left.3 open"]),
    (
        "valve 3 front left stuck closed",
        &["solenoid-stuck front-left.3 closed"],
    ),
    (
        "all displacements off by 35 mm",
        &["sensor-offset all.displacement 0.035"],
    ),
    (
        "all displacements off by -35 mm",
        &["sensor-offset all.displacement -0.035"],
    ),
    ("all pressures off by 0.9 MPa", &ALL_PRESSURES_HIGH),
    ("all pressures off by -0.9 MPa", &ALL_PRESSURES_LOW),
];

/// Faults that are there when the controller starts, so that it learns its references with them.
const FROM_POWER_ON: [(&str, &[&str]); 11] = [
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
        "all displacements off by 35 mm",
        &["sensor-offset all.displacement 0.035"],
    ),
    (
        "all displacements off by -35 mm",
        &["sensor-offset all.displacement -0.035"],
    ),
    ("p1 front left off by 0.9 MPa", &["sensor-offset front-left.p1 0.9e6"]),
    (
        "p1 of both left struts off by 0.9 MPa",
        &["sensor-offset front-left.p1 0.9e6", "sensor-offset rear-left.p1 0.9e6"],
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
    ("all pressures off by 0.9 MPa", &ALL_PRESSURES_HIGH),
    ("all pressures off by -0.9 MPa", &ALL_PRESSURES_LOW),
    ("all pressures off by 5 MPa", &ALL_PRESSURES_FAR),
];
const ALL_PRESSURES_HIGH: [&str; 4] = [
    "sensor-offset all.p1 0.9e6",
    "sensor-offset all.p2 0.9e6",
    "sensor-offset all.p3 0.9e6",
    "sensor-offset all.p4 0.9e6",
];
const ALL_PRESSURES_LOW: [&str; 4] = [
    "sensor-offset all.p1 -0.9e6",
    "sensor-offset all.p2 -0.9e6",
    "sensor-offset all.p3 -0.9e6",
    "sensor-offset all.p4 -0.9e6",
];
const ALL_PRESSURES_FAR: [&str; 4] = [
    "sensor-offset all.p1 5e6",
    "sensor-offset all.p2 5e6",
    "sensor-offset all.p3 5e6",
    "sensor-offset all.p4 5e6",
];

/// What one drive showed.
struct Seen {
    roll_deg: f64,
    decision_s: Option<f64>,
    found: bool,
    ended_well: bool,
}

fn drive((manoeuvre, road, seed): (&str, &str, u64), at_s: f64, faults: &[&str]) -> Result<Seen, Failure> {
    let mut text =
        format!("name = \"bend\"\nroad = \"{road}\"\nspeed_km_h = 60\nscore_from_s = 3\nseed = {seed}\n{manoeuvre}\n");
    for fault in faults {
        let mut words = fault.split(' ');
        let mut next = || words.next().unwrap_or_default();
        let (kind, place, value) = (next(), next(), next());
        let (corner, part) = place.split_once('.').unwrap_or_default();
        for corner in Corner::ALL
            .map(Corner::name)
            .iter()
            .filter(|name| [**name, "all"].contains(&corner))
        {
            text += &format!("[[fault]]\nkind = \"{kind}\"\nat_s = {at_s}\n");
            text += &match kind {
                "solenoid-stuck" => format!("valve = \"{corner}.{part}\"\nposition = \"{value}\"\n"),
                _ => format!("sensor = \"{corner}.{part}\"\nvalue = {value}\n"),
            };
        }
    }
    let scenario = parse(&text, "bend.toml", Path::new(""))?;
    let outcome = run::both(&scenario, run::vehicle(&scenario)?, 1, &mut |_| true)?;
    let metrics = Metrics::of(&scenario, &outcome);
    let number = |metric| match metrics.figure(metric) {
        Figure::Number(number) => Some(number),
        _ => None,
    };
    let before = metrics.account.iter().take((BEFORE_THE_BEND_S / TICK_S) as usize);
    let mut modes = before.flatten().map(|(mode, _)| *mode);
    let became_normal = modes.any(|mode| mode == Mode::Normal);
    Ok(Seen {
        roll_deg: number(Metric::MaxRoll).unwrap_or(f64::NAN),
        decision_s: number(Metric::Decision),
        found: !became_normal || modes.any(|mode| mode != Mode::Normal),
        ended_well: metrics.figure(Metric::Ending) == Figure::Word("completed"),
    })
}

fn main() -> Result<(), Failure> {
    let all = |at_s, faults: &[&str]| {
        DRIVES
            .into_iter()
            .map(|case| drive(case, at_s, faults))
            .collect::<Result<Vec<_>, Failure>>()
    };
    let sound = all(BEGIN_S, &[])?;
    println!(
        "| fault | peak roll over that without the fault | peak roll, degrees | decision later by, s | found before the bend | not completed |"
    );
    println!("|---|---|---|---|---|---|");
    let later = FAULTS.map(|(name, faults)| (name.to_owned(), BEGIN_S, faults));
    let at_once = FROM_POWER_ON.map(|(name, faults)| (format!("from power-on: {name}"), 0.0, faults));
    for (name, at_s, faults) in later.into_iter().chain(at_once) {
        let seen = all(at_s, faults)?;
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
        // Also where the fault itself has closed the valves.
        let later_s = match worst(&later) {
            f64::INFINITY => "none".to_owned(),
            later_s => format!("{later_s:.2}"),
        };
        println!(
            "| {name} | {:.2} | {:.1} | {} | {} of {} | {} |",
            worst(&|seen, sound| seen.roll_deg / sound.roll_deg),
            worst(&|seen, _| seen.roll_deg),
            later_s,
            seen.iter().filter(|seen| seen.found).count(),
            seen.len(),
            seen.iter().filter(|seen| !seen.ended_well).count(),
        );
    }
    Ok(())
}
