//! How springs should close in a bend: peak roll over that of all valves closed, with rules that know when the manoeuvre began and to which side.
//!
//! ```text
//! cargo run --release -p oleo-hil --example closing_rules -- 1 12 0.25
//! ```
//!
//! The numbers are the first seed, that of seeds, and the delay of the decision, s. All valves are open until then. Each figure is the geometric
//! mean of a step of steer and two lane changes at 60 km/h, each the mean over the seeds. No controller can know what these rules know; they
//! tell what closing in another way would earn.

use oleo_hil::comparison::{Bench, DriveCase, SCORED_FROM_S, Setting, beginning_s, drive};
use oleo_interface::tick::TICK_S;
use oleo_interface::{Absolute, Corner, Corners, Gauge, Side, StrutValves};
use oleo_plant_sim::course::{Course, Drive, DriverStyle, Ending, LaneChange};
use oleo_plant_sim::road;
use oleo_plant_sim::strut::{Strut, StrutOutput};
use oleo_plant_sim::vehicle::StrutElement;
use rayon::prelude::*;

const ROADS: [&str; 5] = ["iso-b", "iso-c", "iso-d", "iso-e", "belgian"];
/// The manoeuvres begin with a turn to the left.
const OUTER: Side = Side::Right;
/// Time over which pressures are extrapolated, s: the middle of the valves' response times.
const AHEAD_S: f64 = 0.06;
/// Lag of the lateral acceleration that tells the side, s, and the least that does, m/s2.
const SIDE: (f64, f64) = (0.4, 0.7);

/// When the springs close. Dampers are high from the decision on.
#[derive(Clone, Copy)]
enum Rule {
    /// With the decision.
    AtOnce,
    /// With the decision, but the dampers are high from the beginning of the manoeuvre.
    DampersBefore,
    /// When the mean of the struts traps less than 10 mm of lean outwards, after 0.3 s at the latest.
    WithLittleLean,
    /// Each when its strut traps less than 20 mm of lean outwards, after 0.5 s at the latest.
    EachWithLittleLean,
    /// Each while nothing flows that lets a lean out.
    CheckValve,
}

const RULES: [(&str, Rule); 5] = [
    ("at once", Rule::AtOnce),
    ("the same, dampers at 0 s", Rule::DampersBefore),
    ("all with little lean", Rule::WithLittleLean),
    ("each with little lean", Rule::EachWithLittleLean),
    ("check valve", Rule::CheckValve),
];

/// What the springs know of a strut: the shift that closing would trap, m, and the force step that opening would make over the static load.
#[derive(Clone, Copy)]
struct Look {
    shift_m: f64,
    step_share: f64,
}

/// The looks at all struts, from the pressures of this tick and of the one before.
fn look(bench: &Bench, now: &Corners<StrutOutput>, before: &Corners<StrutOutput>) -> Corners<Look> {
    Corners::from_fn(|corner| {
        let strut = &bench.struts[corner];
        let absolute_pa = |pa: f64| Gauge(pa).absolute().pa();
        let ahead = |place: usize| {
            let [pa, was_pa] = [now, before].map(|output| output[corner].pressure_pa[place]);
            absolute_pa(pa + (pa - was_pa) * AHEAD_S / TICK_S)
        };
        let (p1, p4, Absolute(charge)) = (ahead(0), ahead(3), Gauge(strut.cylinder.static_pressure_pa).absolute());
        let [v1, v2] = strut.accumulator.each_ref().map(|a| a.static_gas_volume_m3);
        Look {
            shift_m: v2 * (1.0 - charge / p4) / strut.piston_area_m2(),
            step_share: (p4 - p1) * v2 * p1 / (v1 * p4 + v2 * p1) / strut.cylinder.static_pressure_pa,
        }
    })
}

/// Peak roll of a drive whose springs close by a rule, degrees, counted as that of the stiff vehicle is.
fn peak_roll_deg(bench: &Bench, case: &DriveCase, rule: Rule, delay_s: f64) -> f64 {
    let track = case.manoeuvre.track(case.driver, bench.vehicle.layout.width_m);
    let course = Course {
        manoeuvre: case.manoeuvre,
        driver: case.driver,
        road: road::from_name_or_path(&case.road, case.manoeuvre.length_m(&track), case.seed).expect("a built-in road"),
    };
    let strut =
        |corner: Corner| Strut::at_rest(&bench.struts[corner], StrutValves::splat(true)).expect("built-in struts");
    let elements = Corners::from_fn(|corner| StrutElement::new(strut(corner)));
    let mut drive = Drive::begin(&course, &bench.vehicle, &bench.handling, elements).expect("a built-in vehicle");
    let begins_s = case.begins_s.expect("a manoeuvre");
    let (mut springs, mut peak_rad, mut lateral_m_s2, mut outer) = (Corners::splat(true), 0.0_f64, 0.0, OUTER);
    let mut before = drive.model().strut_output();
    while drive.ending().is_none() {
        let time_s = f64::from(drive.ticks()) * TICK_S;
        let since_s = time_s - begins_s;
        let motion = drive.model().motion();
        if time_s >= SCORED_FROM_S {
            peak_rad = peak_rad.max(motion.roll_rad.abs());
        }
        lateral_m_s2 += TICK_S / SIDE.0 * (motion.lateral_acceleration_m_s2 - lateral_m_s2);
        if since_s > delay_s && f64::abs(lateral_m_s2) > SIDE.1 {
            outer = if lateral_m_s2 > 0.0 { Side::Right } else { Side::Left };
        }
        let now = drive.model().strut_output();
        let looks = look(bench, &now, &before);
        before = now;
        let outwards = |corner: Corner| if corner.side() == outer { 1.0 } else { -1.0 };
        let lean_m = |corner: Corner| outwards(corner) * looks[corner].shift_m;
        let mean_m = Corner::ALL.map(lean_m).iter().sum::<f64>() / 4.0;
        if since_s >= delay_s {
            for (corner, open) in springs.iter_mut() {
                *open = match rule {
                    Rule::AtOnce | Rule::DampersBefore => false,
                    Rule::WithLittleLean => *open && mean_m > 0.01 && since_s < delay_s + 0.3,
                    Rule::EachWithLittleLean => *open && lean_m(corner) > 0.02 && since_s < delay_s + 0.5,
                    Rule::CheckValve => {
                        let least_m = if *open { 0.008 } else { 0.016 };
                        lean_m(corner) > least_m && outwards(corner) * looks[corner].step_share > 0.1
                    }
                };
            }
        }
        let early = if matches!(rule, Rule::DampersBefore) {
            0.0
        } else {
            delay_s
        };
        let low = since_s < early;
        let signals = springs.map(|open| StrutValves::new(low, low, open));
        drive.tick(signals, |_| {}).expect("finite motion");
    }
    match drive.ending() {
        Some(Ending::RolledOver(_)) => 90.0,
        _ => peak_rad.to_degrees(),
    }
}

fn manoeuvres(road: &str, seed: u64) -> [DriveCase; 3] {
    let (km_h, eased) = (60.0 / 3.6, DriverStyle::Eased);
    [
        DriveCase::step_steer(road, km_h, 0.06, seed),
        DriveCase::lane_change(road, LaneChange::Severe, km_h, eased, seed),
        DriveCase::lane_change(road, LaneChange::ObstacleAvoidance, km_h, eased, seed),
    ]
}

fn main() {
    let argument = |place: usize| std::env::args().nth(place);
    let seed = |place: usize, otherwise: u64| argument(place).and_then(|n| n.parse().ok()).unwrap_or(otherwise);
    let (first, seeds) = (seed(1, 1), seed(2, 4));
    let delay_s: f64 = argument(3).and_then(|n| n.parse().ok()).unwrap_or(0.25);
    let bench = Bench::defender110();
    println!(
        "seeds {first} to {}, springs decided {delay_s} s after the manoeuvre began",
        first + seeds - 1
    );
    println!("{:26}{}", "rule", ROADS.map(|road| format!("{road:>9}")).concat());
    let columns = ROADS.map(|road| {
        let mut logs = [0.0; RULES.len()];
        for (which, case) in manoeuvres(road, first).iter().enumerate() {
            let begins_s = beginning_s(&bench, case).expect("a built-in vehicle");
            let peaks: Vec<(f64, [f64; RULES.len()])> = (first..first + seeds)
                .into_par_iter()
                .map(|seed| {
                    let mut case = manoeuvres(road, seed)[which].clone();
                    case.begins_s = begins_s;
                    let stiff = drive(&bench, &case, &Setting::STIFF).expect("a built-in vehicle");
                    let ruled = RULES.map(|(_, rule)| peak_roll_deg(&bench, &case, rule, delay_s));
                    (stiff.peak_roll_deg, ruled)
                })
                .collect();
            let stiff: f64 = peaks.iter().map(|(stiff, _)| stiff).sum();
            for (rule, log) in logs.iter_mut().enumerate() {
                *log += libm::log(peaks.iter().map(|(_, ruled)| ruled[rule]).sum::<f64>() / stiff) / 3.0;
            }
        }
        logs.map(libm::exp)
    });
    for (rule, (name, _)) in RULES.iter().enumerate() {
        println!(
            "{name:26}{}",
            columns.map(|column| format!("{:9.2}", column[rule])).concat()
        );
    }
}
