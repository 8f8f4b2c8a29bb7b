//! What happened and whether that is good, in a few sentences made from the same figures as the tables.

use oleo_interface::tick::TICK_S;
use oleo_plant_sim::course::Ending;
use oleo_report::{Verdict, significant};

use super::course::went;
use super::time::{fault_label, spans_s};
use crate::metrics::Metrics;
use crate::output::Summary;
use crate::run::Outcome;
use crate::scenario::Scenario;

/// The verdict with its sentences.
pub(super) fn of(scenario: &Scenario, outcome: &Outcome, metrics: &Metrics, summary: &Summary) -> (Verdict, String) {
    let mut text = drive(scenario, outcome, metrics, summary);
    if scenario.faults.is_empty() {
        text += &format!(" {}", ride(summary));
    } else {
        text += &format!(" {}", answer(scenario, summary));
    }
    let (verdict, judged) = judged(metrics, summary);
    (verdict, format!("{text} {judged}"))
}

/// What the vehicle did.
fn drive(scenario: &Scenario, outcome: &Outcome, metrics: &Metrics, summary: &Summary) -> String {
    let seconds = significant(summary.simulated_s, 3);
    if let Some(failure) = &summary.bus_failure {
        return format!("The bus ended the run after {seconds} s: {failure}.");
    }
    if summary.interrupted {
        return format!("The run was stopped after {seconds} s.");
    }
    let speed = significant(summary.speed_km_h, 3);
    let (Some(settings), Some(course)) = (&scenario.course, &metrics.course) else {
        let station_m = outcome
            .plant
            .recording
            .samples
            .last()
            .map_or(0.0, |s| s.motion.station_m);
        return format!(
            "The vehicle drove {} m over the road {} at {speed} km/h.",
            significant(station_m, 3),
            scenario.road
        );
    };
    let how = went(course.ending, course.cone_margin_m);
    format!("{} at {speed} km/h: the vehicle {how}.", settings.kind.title())
}

/// The ride of a run without faults, and the modes of the controller.
fn ride(summary: &Summary) -> String {
    let restricted = summary
        .modes
        .iter()
        .find(|entry| !["start-up", "normal"].contains(&entry.mode));
    let modes = match restricted {
        Some(entry) => format!(
            "Although no fault was injected, the controller went to the mode {} at {} s, because of {}.",
            entry.mode,
            significant(f64::from(entry.tick) * TICK_S, 3),
            entry.fault
        ),
        None => "The controller found no fault.".to_owned(),
    };
    format!(
        "{modes} The vertical weighted RMS at the driver's seat is {} m/s2, and the largest roll {} degrees.",
        significant(summary.weighted_rms_driver_m_s2, 3),
        significant(summary.max_roll_deg, 3)
    )
}

/// How the controller answered the faults.
fn answer(scenario: &Scenario, summary: &Summary) -> String {
    let Some(first) = scenario.faults.iter().min_by_key(|fault| fault.from_tick) else {
        return String::new();
    };
    let (from_s, until_s) = spans_s(first);
    if from_s >= summary.simulated_s {
        return format!(
            "The first fault would have come at {} s, after the end of the run.",
            significant(from_s, 3)
        );
    }
    let until = if until_s >= summary.simulated_s {
        "until the end".to_owned()
    } else {
        format!("to {} s", significant(until_s, 3))
    };
    let mut text = format!(
        "Injected from {} s {until}: {}.",
        significant(from_s, 3),
        fault_label(first)
    );
    let after = |ticks: f64| format!("{} ms", significant(1e3 * ticks * TICK_S, 3));
    text += &match summary.ticks_to_detect {
        Some(ticks) => format!(" The controller changed its mode after {}", after(ticks)),
        None => " The controller did not change its mode".to_owned(),
    };
    if let Some(ticks) = summary.ticks_to_closed {
        text += &format!(", all valves were closed after {}", after(ticks));
    }
    if let Some(ticks) = summary.ticks_to_recover.filter(|_| summary.ticks_to_detect.is_some()) {
        text += &format!(
            ", and the mode was normal again {} s after the fault ended",
            significant(ticks * TICK_S, 3)
        );
    }
    text + "."
}

/// Whether it is good: what the checks say.
fn judged(metrics: &Metrics, summary: &Summary) -> (Verdict, String) {
    let failed: Vec<String> = (summary.checks.iter())
        .filter(|check| !check.passed)
        .map(|check| format!("{} (is {})", check.name, check.figure))
        .collect();
    let hit = metrics.course.as_ref().is_some_and(|course| {
        course.cone_margin_m.is_some_and(|margin_m| margin_m < 0.0) || !matches!(course.ending, Some(Ending::Completed))
    });
    let all = summary.checks.len();
    match (failed.len(), all) {
        (0, 0) => (
            Verdict::Attention,
            "The scenario has no checks that say whether this is good.".to_owned(),
        ),
        (0, _) if summary.bus_failure.is_some() => (Verdict::Fail, format!("Until then {}.", met(all))),
        (0, _) if summary.interrupted => (Verdict::Attention, format!("Until then {}.", met(all))),
        (0, _) if hit => (
            Verdict::Attention,
            format!("In this run {}, but none of them is about that.", met(all)),
        ),
        (0, _) => (Verdict::Pass, format!("This is as it should be: {}.", met(all))),
        (count, _) => (
            Verdict::Fail,
            format!(
                "This is not as it should be: {count} of {all} checks {} not met: {}.",
                if count == 1 { "is" } else { "are" },
                failed.join("; ")
            ),
        ),
    }
}

fn met(all: usize) -> String {
    if all == 1 {
        "the one check is met".to_owned()
    } else {
        format!("all {all} checks are met")
    }
}
