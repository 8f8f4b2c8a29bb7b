//! The tables of a run's figures and checks, for the terminal and the page.

use oleo_report::{Cell, Column, Table, significant};

use crate::metrics::Metrics;
use crate::output::Summary;
use crate::scenario::Scenario;
use crate::scenario::check::{Comparison, Figure};

/// Table of the run's figures, for the terminal and the page.
pub fn outcome_table(summary: &Summary) -> Table {
    let mut table = Table::new([Column::text("Quantity"), Column::number("Value"), Column::text("Unit")]);
    let mut row = |quantity: &str, value: String, unit: &str| {
        table.row([quantity.to_owned(), value, unit.to_owned()]);
    };
    row("simulated", significant(summary.simulated_s, 4), "s");
    row("wall clock", significant(summary.wall_s, 3), "s");
    row("real time factor", significant(summary.real_time_factor, 3), "");
    row("command hash", summary.command_hash.clone(), "");
    row(
        "vertical weighted RMS, driver (BS 6841)",
        significant(summary.weighted_rms_driver_m_s2, 3),
        "m/s2",
    );
    row(
        "vertical weighted RMS, left rear passenger",
        significant(summary.weighted_rms_rear_left_m_s2, 3),
        "m/s2",
    );
    row(
        "vertical vibration dose, driver",
        significant(summary.vdv_driver_m_s1_75, 3),
        "m/s^1.75",
    );
    row("largest roll", significant(summary.max_roll_deg, 3), "degrees");
    if let Some(course) = &summary.course {
        let ending = match course.ending {
            Some(word) if course.cone_margin_m.is_some_and(|margin_m| margin_m < 0.0) => {
                format!("{word}, but a cone was hit")
            }
            Some(word) => word.to_owned(),
            None => "stopped".to_owned(),
        };
        let known = |value: Option<f64>| value.map_or("never".to_owned(), |value| significant(value, 3));
        row("manoeuvre", ending, "");
        row(
            "largest lateral acceleration",
            significant(course.max_lateral_m_s2, 3),
            "m/s2",
        );
        if let Some(deviation_m) = course.max_path_deviation_m {
            row("largest path deviation", significant(deviation_m, 3), "m");
        }
        if let Some(margin_m) = course.cone_margin_m {
            row("least room to the cones (negative: hit)", significant(margin_m, 3), "m");
        }
        row("handling decided after 0.5 m/s2", known(course.decision_s), "s");
        for (quantity, value) in [
            ("weighted RMS, driver, before", course.weighted_rms_driver_before_m_s2),
            ("weighted RMS, driver, after", course.weighted_rms_driver_after_m_s2),
        ] {
            if value.is_some() {
                row(quantity, known(value), "m/s2");
            }
        }
    }
    row(
        "handling mode reported anew",
        summary.handling_entries.to_string(),
        "times",
    );
    row(
        "valve switches",
        summary.valve_switches.iter().sum::<u64>().to_string(),
        "",
    );
    row("frames sent", summary.frames_sent.to_string(), "");
    row("frames lost", summary.frames_lost.to_string(), "");
    row("end-to-end errors", summary.e2e_errors.to_string(), "");
    row(
        "bus load at 500 kbit/s",
        significant(100.0 * summary.bus_load_500k, 3),
        "%",
    );
    let answers = [
        ("fault detected after", summary.ticks_to_detect),
        ("mode safe after", summary.ticks_to_safe),
        ("valves closed after", summary.ticks_to_closed),
        ("mode normal again after the fault ended", summary.ticks_to_recover),
    ];
    for (quantity, ticks) in answers {
        if let Some(ticks) = ticks {
            row(quantity, ticks.to_string(), "ticks");
        }
    }
    if let Some(tick) = summary.controller_lost_at_tick {
        row("controller counted as lost in tick", tick.to_string(), "");
    }
    if summary.controller_rejoined > 0 {
        row(
            "controller started again",
            summary.controller_rejoined.to_string(),
            "times",
        );
    }
    if summary.foreign_sync_frames > 0 {
        let count = summary.foreign_sync_frames.to_string();
        row("sync frames of another run, ignored", count, "");
    }
    if let Some(failure) = &summary.bus_failure {
        row("the run was ended by the bus", failure.clone(), "");
    }
    for node in &summary.lateness {
        let late = &node.lateness;
        row(
            &format!("{} lateness, median / 99 % / largest", node.node),
            format!("{} / {} / {}", late.p50_us, late.p99_us, late.max_us),
            "us",
        );
        row(&format!("{} overruns", node.node), late.overruns.to_string(), "ticks");
    }
    table
}

/// Table of the checks, for the terminal and the page.
pub fn check_table(summary: &Summary) -> Table {
    let mut table = Table::new([Column::text("Check"), Column::number("Figure"), Column::text("Met")]);
    for check in &summary.checks {
        table.row::<Cell>([
            check.name.as_str().into(),
            check.figure.as_str().into(),
            Cell::check(check.passed),
        ]);
    }
    table
}

/// The checks for the page: each figure as a bar against its limit.
pub(super) fn gauge_table(scenario: &Scenario, metrics: &Metrics, summary: &Summary) -> Table {
    let mut table = Table::new([
        Column::text("Check"),
        Column::number("Figure"),
        Column::text("Figure against the limit"),
        Column::text("Met"),
    ]);
    for (index, outcome) in summary.checks.iter().enumerate() {
        // The checks of a run in real time come behind those of its scenario, and have no limit of their own kind.
        let gauge = scenario.checks.get(index).and_then(|check| {
            let Figure::Number(number) = metrics.figure(check.metric) else {
                return None;
            };
            match check.comparison {
                Comparison::AtMost(limit) | Comparison::AtLeast(limit) | Comparison::Equals(limit) => {
                    Some(Cell::gauge(number, limit, outcome.passed))
                }
                Comparison::Is(_) => None,
            }
        });
        table.row([
            outcome.name.as_str().into(),
            outcome.figure.as_str().into(),
            gauge.unwrap_or_default(),
            Cell::check(outcome.passed),
        ]);
    }
    table
}
