//! The loop over the roads of several seeds, by the mechanisms of `oleo hil` alone.

use oleo_diagnose::vehicle::DRIVES;
use oleo_hil::metrics::Metrics;
use oleo_hil::run;
use oleo_hil::scenario::check::{Figure, Metric};
use oleo_hil::scenario::{self, Scenario};
use rayon::prelude::*;
use serde_json::Value;

/// Holds what a report says that a driver feels against drives of the same scenarios that are made so: means of ride and roll, to a part of them.
pub fn is_felt(report: &Value, which: &str, part: f64, made: impl Fn(&mut Scenario) + Sync) {
    let driven = &report["driven"];
    assert_eq!(driven["drives"], DRIVES);
    for (scenario, key) in [
        ("rough_road", "weighted_rms_driver_m_s2"),
        ("lane_change", "max_roll_deg"),
    ] {
        let mut scenario = scenario::named(driven[scenario].as_str().expect("a name")).expect("a scenario");
        made(&mut scenario);
        let figures = (1..=DRIVES as u64).into_par_iter().map(|seed| {
            let scenario = Scenario {
                seed,
                ..scenario.clone()
            };
            let outcome =
                run::both(&scenario, run::vehicle(&scenario).expect("a vehicle"), 1, &mut |_| true).expect("a run");
            let metrics = Metrics::of(&scenario, &outcome);
            match metrics.figure(Metric::MaxRoll) {
                Figure::Number(roll_deg) if key == "max_roll_deg" => roll_deg,
                _ => metrics.seats[0].weighted_rms_m_s2,
            }
        });
        let mean = figures.collect::<Vec<f64>>().iter().sum::<f64>() / DRIVES as f64;
        let told = driven[which][key].as_f64().expect("a figure");
        println!("{which} {key}: {told:.4}, and the loop itself {mean:.4}");
        assert!(
            (told / mean - 1.0).abs() < part,
            "{which} {key}: {told}, and the loop itself {mean}"
        );
    }
}
