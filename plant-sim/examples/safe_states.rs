//! What the safe state does in the middle of a drive: `cargo run --release -p oleo-plant-sim --example safe_states`.
//!
//! The vehicle drives with all valves open, the softest setting there is, until a fault comes at some time of a manoeuvre. Then the
//! valves go to one of four settings, among them that of the controller's safe state, and stay there. A row states the worst over all
//! times of the fault: peak roll after the fault over the peak roll of the same drive with all valves closed from the start, the lean
//! that is left on the straight behind a lane change, and the shift of ride height that closed valves 3 have trapped.

use std::sync::Arc;

use oleo_interface::tick::TICK_S;
use oleo_interface::{Corners, Gauge, StrutValves, Valve};
use oleo_plant_sim::course::{Course, Drive, DriverStyle, Ending, LaneChange, Manoeuvre, Run};
use oleo_plant_sim::handling::{HandlingParameters, HandlingVehicle};
use oleo_plant_sim::road::{Flat, Road, from_name_or_path};
use oleo_plant_sim::strut::{Strut, StrutModel};
use oleo_plant_sim::vehicle::StrutElement;
use oleo_plant_sim::vehicle::VehicleParameters;

type Failure = Box<dyn std::error::Error>;

/// Shift at which a valve 3 closes without harm, m, as in handling mode.
const HARMLESS_SHIFT_M: f64 = 0.008;
/// Number of times at which a fault is tried in each drive.
const FAULT_TIMES: u32 = 40;
/// On the last stretch of a drive the lean that is left is measured, s.
const LAST_S: f64 = 1.0;

/// Where the valves go with the fault.
#[derive(Clone, Copy)]
enum Reaction {
    AllClosed,
    /// Dampers closed, and each spring once it stands at its height, or after this many seconds.
    SpringsWait(f64),
    SpringsOpen,
    AllOpen,
}

const REACTIONS: [(Reaction, &str); 5] = [
    (Reaction::AllClosed, "all closed at once (the safe state)"),
    (
        Reaction::SpringsWait(0.15),
        "dampers closed, each spring at its height or after 0.15 s",
    ),
    (
        Reaction::SpringsWait(2.0),
        "dampers closed, each spring at its height or after 2 s",
    ),
    (Reaction::SpringsOpen, "dampers closed, springs stay open"),
    (Reaction::AllOpen, "all stay open"),
];

/// A vehicle and what it drives.
struct Case {
    name: &'static str,
    course: Course,
    /// When the bend begins and for how long faults are tried, s.
    bend_s: (f64, f64),
    /// Whether it ends on a straight.
    ends_straight: bool,
}

struct Seen {
    roll_ratio: f64,
    lean_deg: f64,
    shift_m: f64,
    /// Mean over all times of the fault of the largest shift of a corner, m.
    mean_shift_m: f64,
    rolled_over: bool,
}

/// Models of the four struts of the vehicle.
fn models(vehicle: &VehicleParameters) -> Corners<StrutModel> {
    vehicle.static_strut_load_n().map(StrutModel::defender110)
}

/// How far the oil in accumulator 2 of a strut shifts its ride height while valve 3 is closed, m, lower positive.
fn shift_m(model: &StrutModel, p4_pa: f64) -> f64 {
    let charge = model.static_pressure().absolute().pa();
    let p4 = Gauge(p4_pa).absolute().pa().max(2e4);
    let [_, accumulator] = &model.accumulator;
    accumulator.static_gas_volume_m3 * (1.0 - charge / p4) / model.piston_area_m2()
}

/// One drive with a fault at a time, or none, and the largest trapped shift at its end.
fn drive(case: &Case, vehicle: &VehicleParameters, reaction: Reaction, fault_s: f64) -> Result<(Run, f64), Failure> {
    let models = models(vehicle);
    let open = StrutValves::splat(true);
    let start = if fault_s > 0.0 { open } else { StrutValves::splat(false) };
    let struts = Corners::try_from_fn(|corner| Strut::at_rest(&models[corner], start).map(StrutElement::new))?;
    let mut valves = Corners::splat(start);
    let mut trapped_m = 0.0;
    let decide = |model: &HandlingVehicle| {
        let time_s = model.time_s();
        trapped_m = 0.0;
        for (corner, output) in model.strut_output().iter() {
            let [_, _, _, p4_pa] = output.pressure_pa;
            let shift_m = shift_m(&models[corner], p4_pa).abs();
            if time_s + 0.5 * TICK_S > fault_s {
                let spring_open = match reaction {
                    Reaction::AllClosed => false,
                    Reaction::SpringsWait(patience_s) => {
                        let waits = valves[corner][Valve::Spring] && time_s < fault_s + patience_s;
                        waits && shift_m > HARMLESS_SHIFT_M
                    }
                    Reaction::SpringsOpen | Reaction::AllOpen => true,
                };
                let damper_open = matches!(reaction, Reaction::AllOpen);
                valves[corner] = StrutValves::new(damper_open, damper_open, spring_open);
            }
            if !valves[corner][Valve::Spring] {
                trapped_m = f64::max(trapped_m, shift_m);
            }
        }
        (valves, valves)
    };
    let begun = Drive::begin(&case.course, vehicle, &HandlingParameters::defender110(), struts)?;
    let run = begun.to_end(decide, |_| {})?;
    Ok((run, trapped_m))
}

fn peak_roll_rad(run: &Run, from_s: f64) -> f64 {
    let later = run.history.iter().filter(|sample| sample.time_s >= from_s);
    later.map(|sample| sample.roll_rad.abs()).fold(0.0, f64::max)
}

/// The worst of all times of the fault.
fn worst(case: &Case, vehicle: &VehicleParameters, reaction: Reaction) -> Result<Seen, Failure> {
    let (stiff, _) = drive(case, vehicle, Reaction::AllClosed, 0.0)?;
    let (begins_s, lasts_s) = case.bend_s;
    let mut worst = Seen {
        roll_ratio: 0.0,
        lean_deg: 0.0,
        shift_m: 0.0,
        mean_shift_m: 0.0,
        rolled_over: false,
    };
    for k in 0..FAULT_TIMES {
        let fault_s = begins_s - 0.5 + (lasts_s + 0.5) * f64::from(k) / f64::from(FAULT_TIMES);
        let (run, trapped_m) = drive(case, vehicle, reaction, fault_s)?;
        // What the soft springs had done before the fault is not the safe state's doing: its valves need 0.1 s to close.
        let ratio = peak_roll_rad(&run, fault_s + 0.1) / peak_roll_rad(&stiff, 0.0);
        let end_s = run.history.last().map_or(0.0, |sample| sample.time_s);
        let last = run.history.iter().filter(|sample| sample.time_s > end_s - LAST_S);
        let (count, sum) = last.fold((0.0, 0.0), |(n, sum), sample| (n + 1.0, sum + sample.roll_rad));
        worst.roll_ratio = worst.roll_ratio.max(ratio);
        worst.lean_deg = worst.lean_deg.max((sum / count).abs().to_degrees());
        worst.shift_m = worst.shift_m.max(trapped_m);
        worst.mean_shift_m += trapped_m / f64::from(FAULT_TIMES);
        worst.rolled_over |= !matches!(run.ending, Ending::Completed);
    }
    Ok(worst)
}

fn main() -> Result<(), Failure> {
    let vehicle = VehicleParameters::defender110();
    let road = |name: &str| -> Result<Arc<dyn Road>, Failure> {
        Ok(if name == "flat" {
            Arc::new(Flat)
        } else {
            from_name_or_path(name, 600.0, 1)?
        })
    };
    let step = |speed_km_h: f64| Manoeuvre::StepSteer {
        speed_m_s: speed_km_h / 3.6,
        angle_rad: 3.0_f64.to_radians(),
        at_s: 2.0,
        duration_s: 8.0,
    };
    let lane_change = |speed_km_h: f64| Manoeuvre::LaneChange {
        kind: LaneChange::ObstacleAvoidance,
        speed_m_s: speed_km_h / 3.6,
        entry_m: 30.0,
        duration_s: Some(14.0),
    };
    let straight = || Manoeuvre::Straight {
        speed_m_s: 60.0 / 3.6,
        duration_s: 11.0,
    };
    let case = |name, manoeuvre, road, bend_s, ends_straight| Case {
        name,
        course: Course {
            manoeuvre,
            driver: DriverStyle::Eased,
            road,
        },
        bend_s,
        ends_straight,
    };
    let cases = [
        case(
            "step steer, 60 km/h, flat",
            step(60.0),
            road("flat")?,
            (2.0, 4.0),
            false,
        ),
        case(
            "step steer, 80 km/h, flat",
            step(80.0),
            road("flat")?,
            (2.0, 4.0),
            false,
        ),
        case(
            "step steer, 60 km/h, class D",
            step(60.0),
            road("iso-d")?,
            (2.0, 4.0),
            false,
        ),
        case(
            "lane change 3888-2, 60 km/h, flat",
            lane_change(60.0),
            road("flat")?,
            (1.8, 4.0),
            true,
        ),
        case(
            "lane change 3888-2, 60 km/h, class D",
            lane_change(60.0),
            road("iso-d")?,
            (1.8, 4.0),
            true,
        ),
        case(
            "straight, 60 km/h, class D",
            straight(),
            road("iso-d")?,
            (3.0, 4.0),
            true,
        ),
        case(
            "straight, 60 km/h, class E",
            straight(),
            road("iso-e")?,
            (3.0, 4.0),
            true,
        ),
        case(
            "straight, 60 km/h, Belgian block",
            straight(),
            road("belgian")?,
            (3.0, 4.0),
            true,
        ),
    ];
    println!(
        "| drive | valves after the fault | worst peak roll over all closed | lean left on the straight, degrees | largest shift of a corner, mm: worst, mean of all times | completed |"
    );
    println!("|---|---|---|---|---|---|");
    for case in &cases {
        for (reaction, what) in REACTIONS {
            let seen = worst(case, &vehicle, reaction)?;
            let lean = if case.ends_straight {
                format!("{:.2}", seen.lean_deg)
            } else {
                "-".to_owned()
            };
            println!(
                "| {} | {what} | {:.2} | {lean} | {:.0}, {:.0} | {} |",
                case.name,
                seen.roll_ratio,
                1e3 * seen.shift_m,
                1e3 * seen.mean_shift_m,
                if seen.rolled_over { "no" } else { "yes" }
            );
        }
    }
    Ok(())
}
