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
use oleo_interface::tick::TICK_S;
use oleo_interface::{Corner, Side};

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

/// When a fault begins.
#[derive(Clone, Copy, PartialEq)]
enum From {
    Drive,
    PowerOn,
    /// A row for each.
    Either,
}

/// What is wrong: a row of the table; kind of the fault, corners (`left` is both left ones) and parts, value; and when it begins.
const FAULTS: [(&str, &str, From); 28] = [
    (
        "displacement front left off by 35 mm",
        "sensor-offset front-left displacement 0.035",
        From::Either,
    ),
    (
        "displacement front left off by -35 mm",
        "sensor-offset front-left displacement -0.035",
        From::Either,
    ),
    (
        "both left displacements off by 35 mm",
        "sensor-offset left displacement 0.035",
        From::Either,
    ),
    (
        "both left displacements off by -35 mm",
        "sensor-offset left displacement -0.035",
        From::Drive,
    ),
    (
        "displacement front left drifts by 2 mm/s",
        "sensor-drift front-left displacement 0.002",
        From::Drive,
    ),
    (
        "displacement front left with gain 0.5",
        "sensor-gain front-left displacement 0.5",
        From::Drive,
    ),
    (
        "displacement front left with gain 1.5",
        "sensor-gain front-left displacement 1.5",
        From::Drive,
    ),
    (
        "all displacements with gain 0.5",
        "sensor-gain all displacement 0.5",
        From::Drive,
    ),
    (
        "all displacements off by 35 mm",
        "sensor-offset all displacement 0.035",
        From::Either,
    ),
    (
        "all displacements off by -35 mm",
        "sensor-offset all displacement -0.035",
        From::Either,
    ),
    (
        "p1 front left off by 0.9 MPa",
        "sensor-offset front-left p1 0.9e6",
        From::Either,
    ),
    (
        "p1 front left off by -0.9 MPa",
        "sensor-offset front-left p1 -0.9e6",
        From::Drive,
    ),
    (
        "p1 rear left off by 0.9 MPa",
        "sensor-offset rear-left p1 0.9e6",
        From::Drive,
    ),
    (
        "p1 of both left struts off by -0.9 MPa",
        "sensor-offset left p1 -0.9e6",
        From::Drive,
    ),
    (
        "p1 of both left struts off by 0.9 MPa",
        "sensor-offset left p1 0.9e6",
        From::Either,
    ),
    (
        "p1 front left drifts by 0.1 MPa/s",
        "sensor-drift front-left p1 0.1e6",
        From::Drive,
    ),
    (
        "p2 and p3 front left off by 0.9 MPa",
        "sensor-offset front-left p2,p3 0.9e6",
        From::Drive,
    ),
    (
        "p1, p2 and p3 front left off by 0.9 MPa",
        "sensor-offset front-left p1,p2,p3 0.9e6",
        From::Drive,
    ),
    (
        "all four pressures front left off by 0.9 MPa",
        "sensor-offset front-left p1,p2,p3,p4 0.9e6",
        From::Either,
    ),
    (
        "all pressures off by 0.9 MPa",
        "sensor-offset all p1,p2,p3,p4 0.9e6",
        From::Either,
    ),
    (
        "all pressures off by -0.9 MPa",
        "sensor-offset all p1,p2,p3,p4 -0.9e6",
        From::Either,
    ),
    (
        "all pressures off by 5 MPa",
        "sensor-offset all p1,p2,p3,p4 5e6",
        From::PowerOn,
    ),
    (
        "valve 1 front left stuck open",
        "solenoid-stuck front-left 1 open",
        From::Drive,
    ),
    (
        "valve 1 front left stuck closed",
        "solenoid-stuck front-left 1 closed",
        From::Drive,
    ),
    (
        "valve 2 front left stuck open",
        "solenoid-stuck front-left 2 open",
        From::Drive,
    ),
    (
        "valves 1 and 2 of all struts stuck open",
        "solenoid-stuck all 1,2 open",
        From::Drive,
    ),
    (
        "valve 3 front left stuck open",
        "solenoid-stuck front-left 3 open",
        From::Drive,
    ),
    (
        "valve 3 front left stuck closed",
        "solenoid-stuck front-left 3 closed",
        From::Drive,
    ),
];

/// A fault as parts of a scenario, one for each corner and part.
fn parts_of_scenario(fault: &str, at_s: f64) -> String {
    let mut words = fault.split(' ');
    let mut next = || words.next().unwrap_or_default();
    let (kind, place, parts, value) = (next(), next(), next(), next());
    let mut text = String::new();
    for corner in Corner::ALL {
        let name = corner.name();
        let is_meant = place == "all" || place == name || (place == "left" && corner.side() == Side::Left);
        for part in parts.split(',').filter(|_| is_meant) {
            text += &format!("[[fault]]\nkind = \"{kind}\"\nat_s = {at_s}\n");
            text += &match kind {
                "solenoid-stuck" => format!("valve = \"{name}.{part}\"\nposition = \"{value}\"\n"),
                _ => format!("sensor = \"{name}.{part}\"\nvalue = {value}\n"),
            };
        }
    }
    text
}

/// What one drive showed.
struct Seen {
    roll_deg: f64,
    decision_s: Option<f64>,
    found: bool,
    ended_well: bool,
}

fn drive((manoeuvre, road, seed): (&str, &str, u64), faults: &str) -> Result<Seen, Failure> {
    let text = format!(
        "name = \"bend\"\nroad = \"{road}\"\nspeed_km_h = 60\nscore_from_s = 3\nseed = {seed}\n{manoeuvre}\n{faults}"
    );
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
    let all = |faults: &str| {
        DRIVES
            .into_iter()
            .map(|case| drive(case, faults))
            .collect::<Result<Vec<_>, Failure>>()
    };
    let sound = all("")?;
    println!(
        "| fault | peak roll over that without the fault | peak roll, degrees | decision later by, s | found before the bend | not completed |"
    );
    println!("|---|---|---|---|---|---|");
    let in_a_drive = FAULTS.iter().filter(|(.., from)| *from != From::PowerOn);
    let from_power_on = FAULTS.iter().filter(|(.., from)| *from != From::Drive);
    let rows = in_a_drive
        .map(|(name, fault, _)| ((*name).to_owned(), parts_of_scenario(fault, BEGIN_S)))
        .chain(from_power_on.map(|(name, fault, _)| (format!("from power-on: {name}"), parts_of_scenario(fault, 0.0))));
    for (name, faults) in rows {
        let seen = all(&faults)?;
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
