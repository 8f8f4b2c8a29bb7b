//! The section on the controller: what it estimated, and how often each valve was switched.

use oleo_interface::tick::TICK_S;
use oleo_report::{Axis, Bars, Page, Style};

use super::time::Time;
use crate::metrics::Metrics;
use crate::record::status_messages;
use crate::run::Outcome;

pub(super) fn section(page: &mut Page, outcome: &Outcome, metrics: &Metrics, time: &Time) {
    let mut curves = time.curves("Strategy");
    let status = status_messages(&outcome.plant.trace);
    let status_s: Vec<f64> = status.iter().map(|(tick, _)| f64::from(*tick) * TICK_S).collect();
    let of = |value: &dyn Fn(&oleo_controller::can::StatusMessage) -> f64| -> Vec<f64> {
        status.iter().map(|(_, message)| value(message)).collect()
    };
    curves.panel(Axis::new("Running RMS", "m/s2"));
    curves.line("lateral, estimated", &status_s, &of(&|m| m.lateral_rms_m_s2.into()));
    curves.line("vertical", &status_s, &of(&|m| m.vertical_rms_m_s2.into()));
    curves.panel(
        Axis::new("Strategy", "")
            .ticks([(0.0, "ride"), (1.0, "handling")])
            .range(-0.2, 1.2),
    );
    curves.series(
        Style::Step,
        "setting",
        &status_s,
        &of(&|m| f64::from(u8::from(m.handling))),
    );
    curves.series(
        Style::Step,
        "roll-over guard",
        &status_s,
        &of(&|m| f64::from(u8::from(m.rollover_guard))),
    );
    page.section("Controller")
        .text("The values are taken from the frames that the controller sent, before any injected fault changed them.")
        .figure(curves);

    let (mut names, mut edges) = (Vec::new(), Vec::new());
    for (corner, strut) in metrics.valve_switches.iter() {
        for (valve, count) in strut.iter() {
            names.push(format!("{} {}", corner.name(), valve.number()));
            edges.push(*count as f64);
        }
    }
    let mut bars = Bars::new(
        "Valve switches",
        names.iter().map(String::as_str),
        Axis::new("Edges", ""),
    );
    bars.series("edges", &edges);
    page.figure(bars);
}
