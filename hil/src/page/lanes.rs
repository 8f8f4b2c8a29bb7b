//! The swim lanes at the top of the page: what was injected, what the bus carried, what the controller said, which valves were open.

use oleo_controller::{FaultCode, Mode};
use oleo_interface::tick::TICK_S;
use oleo_interface::{Corner, Valve};
use oleo_report::{Lanes, Tint};

use super::time::{LINK, Time, fault_label, spans_s};
use crate::metrics::Metrics;
use crate::run::Outcome;
use crate::scenario::Scenario;

/// Lanes over the time of a run.
pub(super) fn lanes(scenario: &Scenario, outcome: &Outcome, metrics: &Metrics, time: &Time) -> Lanes {
    let samples = &outcome.plant.recording.samples;
    let mut lanes = Lanes::new("What happened", time.axis());
    lanes.link(LINK).caption(&format!(
        "Mode and fault are what the controller said in its frames. The bus is marked where no valid command \
         reaches the valves. A valve is energised open where its lane is blue.{}",
        if time.is_zoomed() {
            " The figures over time begin at the first fault; a double click shows the whole run."
        } else {
            ""
        }
    ));
    let mut ends = time.s.clone();
    ends.push(samples.len() as f64 * TICK_S);
    let end_s = ends.last().copied().unwrap_or(0.0);
    if !scenario.faults.is_empty() {
        lanes.lane("injected");
        for fault in &scenario.faults {
            let (from_s, until_s) = spans_s(fault);
            if from_s < end_s {
                lanes.stretch(from_s, until_s.min(end_s), fault_label(fault), Tint::Violet);
            }
        }
    }
    lanes.lane("bus").samples(
        &ends,
        (samples.iter()).map(|sample| (!sample.heard).then_some(("no command arrives", Tint::Red))),
    );
    lanes.lane("mode").samples(
        &ends,
        metrics
            .account
            .iter()
            .map(|said| said.map(|(mode, _)| (mode.name(), tint(mode)))),
    );
    lanes.lane("fault").samples(
        &ends,
        (metrics.account.iter()).map(|said| match said {
            Some((_, fault)) if *fault != FaultCode::None => Some((fault.name(), Tint::Amber)),
            _ => None,
        }),
    );
    lanes.lane("handling").samples(
        &ends,
        metrics
            .strategy
            .iter()
            .map(|said| said.handling.then_some(("handling mode", Tint::Sky))),
    );
    for corner in Corner::ALL {
        for valve in Valve::ALL {
            let open = samples.iter().map(|sample| sample.energised.is_open(corner, valve));
            lanes
                .lane(&format!("{} {}", corner.name().replace('-', " "), valve.number()))
                .samples(&ends, open.map(|open| open.then_some(("open", Tint::Blue))));
        }
    }
    lanes
}

/// The more restricted a mode, the warmer its colour.
fn tint(mode: Mode) -> Tint {
    match mode {
        Mode::StartUp => Tint::Grey,
        Mode::Normal => Tint::Green,
        Mode::Degraded => Tint::Amber,
        Mode::Safe => Tint::Red,
        Mode::Latched => Tint::Pink,
    }
}
