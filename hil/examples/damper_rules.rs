//! What rules for the dampers earn on rough roads, the springs being alike: ride of `road-and-dampers` with each damper policy, and of `predictive` with
//! and without its preview and its front dampers, over the better of the two best fixed settings.
//!
//! ```text
//! cargo run --release -p oleo-hil --example damper_rules -- 1001 4
//! ```
//!
//! The numbers are the first seed and that of seeds. Drives are straight ahead for 20 s on classes C, D and E and on Belgian block at 40, 60 and
//! 80 km/h, and ride is the weighted RMS at the seats from the third second, the mean over the seeds. The last columns are the geometric means of a
//! road, and the changes of one bypass valve a kilometre.

use oleo_controller::{DamperPolicy, Strategy, strategy};
use oleo_hil::comparison::{Bench, DriveCase, Figures, Setting, drive};
use oleo_interface::StrutValves;
use rayon::prelude::*;

const ROADS: [&str; 4] = ["iso-c", "iso-d", "iso-e", "belgian"];
const SPEEDS_KM_H: [f64; 3] = [40.0, 60.0, 80.0];
/// The settings that are best on one of these roads: all valves open, and valve 1 closed.
const FIXED: [(bool, bool, bool); 2] = [(true, true, true), (false, true, true)];

const POLICIES: [DamperPolicy; 5] = [
    DamperPolicy::Low,
    DamperPolicy::Karnopp,
    DamperPolicy::HoelscherHuang,
    DamperPolicy::ShAdd,
    DamperPolicy::NellSteyn,
];

/// A controller with a changed tuning.
fn controlled(bench: &Bench, strategy: Strategy, change: impl FnOnce(&mut strategy::Tuning)) -> Setting {
    let mut builder = bench.controller();
    builder.strategy = strategy;
    change(&mut builder.tuning.strategy);
    Setting::Controlled(strategy.name(), Box::new(builder.build().expect("a built-in vehicle")))
}

fn settings(bench: &Bench) -> Vec<(String, Setting)> {
    let fixed = FIXED.map(|(one, two, three)| Setting::Fixed(StrutValves::new(one, two, three)));
    let mut settings: Vec<(String, Setting)> = fixed.into_iter().map(|setting| (setting.name(), setting)).collect();
    let default = controlled(bench, Strategy::RoadAndCornering, |_| {});
    settings.push((Strategy::RoadAndCornering.name().into(), default));
    for policy in POLICIES {
        let setting = controlled(bench, Strategy::RoadAndDampers, |t| {
            t.road_and_dampers.dampers.policy = policy
        });
        settings.push((policy.name().into(), setting));
    }
    for (name, preview, front) in [
        ("predictive", true, false),
        ("the same, front too", true, true),
        ("no preview", false, false),
        ("no preview, front too", false, true),
    ] {
        let setting = controlled(bench, Strategy::Predictive, |t| {
            (t.predictive.preview, t.predictive.front) = (preview, front);
        });
        settings.push((name.into(), setting));
    }
    settings
}

/// Mean ride, m/s2, and changes of one bypass valve a kilometre.
fn means(figures: &[Figures]) -> (f64, f64) {
    let mean = |of: fn(&Figures) -> f64| figures.iter().map(of).sum::<f64>() / figures.len() as f64;
    let changes = |f: &Figures| f64::from(f.valve_changes[0] + f.valve_changes[1]) / (8.0 * f.distance_km);
    (mean(|f| f.weighted_rms_m_s2), mean(changes))
}

fn main() {
    let number = |place: usize, otherwise: u64| {
        std::env::args()
            .nth(place)
            .and_then(|n| n.parse().ok())
            .unwrap_or(otherwise)
    };
    let (first, seeds) = (number(1, 1), number(2, 2));
    let bench = Bench::defender110();
    let settings = settings(&bench);
    let groups: Vec<(&str, f64)> = ROADS
        .iter()
        .flat_map(|road| SPEEDS_KM_H.map(|km_h| (*road, km_h)))
        .collect();
    let jobs: Vec<(&str, f64, &Setting)> = (groups.iter())
        .flat_map(|(road, km_h)| settings.iter().map(move |(_, setting)| (*road, *km_h, setting)))
        .collect();
    let found: Vec<(f64, f64)> = (jobs.par_iter())
        .map(|(road, km_h, setting)| {
            let drives = (first..first + seeds).map(|seed| DriveCase::straight(road, km_h / 3.6, 20.0, seed));
            let figures: Vec<Figures> = drives
                .map(|case| drive(&bench, &case, setting).expect("a built-in road"))
                .collect();
            means(&figures)
        })
        .collect();

    print!("{:<24}", "ride over best fixed");
    groups
        .iter()
        .for_each(|(road, km_h)| print!("{:>11}", format!("{road} {km_h}")));
    ROADS.iter().for_each(|road| print!("{road:>9}"));
    println!("  changes/km");
    for (place, (name, _)) in settings.iter().enumerate() {
        print!("{name:<24}");
        let (mut logarithms, mut changes) = (Vec::new(), 0.0);
        for group in found.chunks(settings.len()) {
            let best = group[0].0.min(group[1].0);
            print!("{:>11.3}", group[place].0 / best);
            logarithms.push(libm::log(group[place].0 / best));
            changes += group[place].1 / groups.len() as f64;
        }
        for road in logarithms.chunks(SPEEDS_KM_H.len()) {
            print!("{:>9.3}", libm::exp(road.iter().sum::<f64>() / road.len() as f64));
        }
        println!("{changes:>12.0}");
    }
}
