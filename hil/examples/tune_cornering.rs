//! Finds the thresholds by which `road-and-cornering` tells a bend from the road, and reports them on drives that were not used.
//!
//! ```text
//! cargo run --release -p oleo-hil --example tune_cornering -- 3
//! ```
//!
//! The number is that of seeds. Drives with all valves open are recorded as the controller's estimates, for seeds from 1 to tune on and
//! from 1001 to report on: straight ahead for 20 s on five roads at three speeds, and two lane changes and a step of steer on each road. The
//! optimiser (Nelder and Mead's simplex, crate `argmin`) varies five thresholds from the built-in ones. The cost is the mean delay after a
//! manoeuvre has begun (at most 3 s), in s, and 0.1 times the square of the false decisions a kilometre, averaged over road and speed.

use std::collections::BTreeMap;

use argmin::core::{CostFunction, Executor, State as _};
use argmin::solver::neldermead::NelderMead;
use oleo_controller::plausibility::Trusted;
use oleo_controller::{Estimate, strategy};
use oleo_hil::comparison::{Bench, DriveCase, beginning_s, estimates};
use oleo_interface::tick::TICK_S;
use oleo_plant_sim::course::{DriverStyle, LaneChange};
use rayon::prelude::*;

/// Longest delay that counts, s: a manoeuvre that was missed.
const MISSED_S: f64 = 3.0;
/// Cost of one false decision a kilometre, s; two cost four times as much.
const FALSE_DECISION_S: f64 = 0.1;
const NAMES: [&str; 5] = [
    "floor_m_s2",
    "witness_multiple",
    "plain_witness_multiple",
    "own_multiple",
    "slow_own_multiple",
];

/// A recorded drive.
struct Recorded {
    group: String,
    begins_s: Option<f64>,
    speed_m_s: f64,
    estimates: Vec<Estimate>,
}

fn record(bench: &Bench, seeds: impl Iterator<Item = u64> + Clone) -> Vec<Recorded> {
    let mut cases = Vec::new();
    for road in ["iso-b", "iso-c", "iso-d", "iso-e", "belgian"] {
        for seed in seeds.clone() {
            cases.extend([40.0, 60.0, 80.0].map(|km_h| DriveCase::straight(road, km_h / 3.6, 20.0, seed)));
            for kind in [LaneChange::Severe, LaneChange::ObstacleAvoidance] {
                cases.push(DriveCase::lane_change(road, kind, 60.0 / 3.6, DriverStyle::Eased, seed));
            }
            cases.push(DriveCase::step_steer(road, 60.0 / 3.6, 0.06, seed));
        }
    }
    let recorded = cases.par_iter().map(|case| {
        let speed_m_s = case.manoeuvre.initial_speed_m_s();
        Recorded {
            group: format!(
                "{} on {}, {:.0} km/h",
                case.manoeuvre_name(),
                case.road,
                3.6 * speed_m_s
            ),
            begins_s: beginning_s(bench, case).expect("a built-in drive"),
            speed_m_s,
            estimates: estimates(bench, case).expect("a built-in drive"),
        }
    });
    recorded.collect()
}

/// Mean delay in s, or false decisions a kilometre, of each group.
fn judge(bench: &Bench, drives: &[Recorded], x: &[f64]) -> Option<BTreeMap<String, f64>> {
    let mut builder = bench.controller();
    let cornering = &mut builder.tuning.strategy.road_and_cornering.cornering;
    cornering.floor_m_s2 = x[0] as f32;
    cornering.witness_multiple = x[1] as f32;
    cornering.plain_witness_multiple = x[2] as f32;
    cornering.own_multiple = x[3] as f32;
    cornering.slow_own_multiple = x[4] as f32;
    let parameters = builder.build().ok()?.strategy;
    let figures = drives.par_iter().map(|drive| {
        let (mut state, mut before, mut entries) = (strategy::State::default(), false, 0_u32);
        let (mut time_s, mut delay_s) = (0.0, MISSED_S);
        for estimate in &drive.estimates {
            let now = state.step(&parameters, estimate, &Trusted::default()).handling;
            match drive.begins_s {
                Some(begins_s) if now && time_s >= begins_s => delay_s = f64::min(delay_s, time_s - begins_s),
                _ => entries += u32::from(now && !before),
            }
            before = now;
            time_s += TICK_S;
        }
        let figure = match drive.begins_s {
            Some(_) => delay_s,
            None => f64::from(entries) / (time_s * drive.speed_m_s / 1000.0),
        };
        (drive.group.clone(), figure)
    });
    let mut groups: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for (group, figure) in figures.collect::<Vec<_>>() {
        groups.entry(group).or_default().push(figure);
    }
    let mean = |values: Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
    Some(
        groups
            .into_iter()
            .map(|(group, values)| (group, mean(values)))
            .collect(),
    )
}

fn cost(groups: &BTreeMap<String, f64>) -> f64 {
    let sum: f64 = groups
        .iter()
        .map(|(group, figure)| {
            if group.starts_with("straight") {
                FALSE_DECISION_S * figure * figure
            } else {
                *figure
            }
        })
        .sum();
    sum / groups.len() as f64
}

struct Search<'a>(&'a Bench, &'a [Recorded]);

impl CostFunction for Search<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, x: &Vec<f64>) -> Result<f64, argmin::core::Error> {
        Ok(judge(self.0, self.1, x).map_or(f64::MAX, |groups| cost(&groups)))
    }
}

fn main() {
    let seeds = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(3_u64);
    let bench = Bench::defender110();
    let built_in = bench.controller().tuning.strategy.road_and_cornering.cornering;
    let start = [
        built_in.floor_m_s2,
        built_in.witness_multiple,
        built_in.plain_witness_multiple,
        built_in.own_multiple,
        built_in.slow_own_multiple,
    ]
    .map(f64::from)
    .to_vec();
    let tuned_on = record(&bench, 1..=seeds);
    let simplex = (0..=start.len())
        .map(|k| {
            start
                .iter()
                .enumerate()
                .map(|(i, x)| if i + 1 == k { 1.3 * x } else { *x })
                .collect()
        })
        .collect();
    let solver = NelderMead::new(simplex)
        .with_sd_tolerance(1e-4)
        .expect("a positive tolerance");
    let end = Executor::new(Search(&bench, &tuned_on), solver)
        .configure(|state| state.max_iters(60))
        .run()
        .expect("a cost that cannot fail");
    let found = end.state().get_best_param().cloned().unwrap_or_else(|| start.clone());
    let reported_on = record(&bench, 1001..=1000 + seeds);
    for (name, (before, after)) in NAMES.iter().zip(start.iter().zip(&found)) {
        println!("{name:<28} built in {before:.2}, found {after:.2}");
    }
    for (what, drives) in [("seeds tuned on", &tuned_on), ("seeds from 1001", &reported_on)] {
        let [before, after] = [&start, &found].map(|x| judge(&bench, drives, x).unwrap_or_default());
        println!(
            "\n{what}: cost built in {:.3} s, found {:.3} s",
            cost(&before),
            cost(&after)
        );
        for ((group, before), after) in before.iter().zip(after.values()) {
            let unit = if group.starts_with("straight") {
                "false decisions a km"
            } else {
                "s"
            };
            println!("  {group:<34} {before:.2} {after:.2} {unit}");
        }
    }
}
