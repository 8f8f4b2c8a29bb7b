//! What happened when: faults, modes of the controller, wheels off the ground, stops, pressures below that of the atmosphere.

use oleo_interface::tick::TICK_S;
use oleo_interface::{Corner, PressurePoint};
use oleo_report::{Column, Page, Table, significant};

use super::time::{fault_label, spans_s};
use crate::metrics::Metrics;
use crate::output::Summary;
use crate::record::Sample;
use crate::run::Outcome;
use crate::scenario::Scenario;
use crate::vehicle::Assembly;

/// Occurrences of one kind at one place that are closer than this are one event, s.
const APART_S: f64 = 0.25;
/// Most events in a table that is open from the start.
const OPEN: usize = 24;

/// Something that happened.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Event {
    /// When it began, s.
    at_s: f64,
    /// How long it lasted, s; `None` for a change.
    lasted_s: Option<f64>,
    /// How often it began within that time.
    times: usize,
    what: String,
    place: String,
    detail: String,
}

/// All events in the order of their begin.
pub(super) fn of(scenario: &Scenario, outcome: &Outcome, metrics: &Metrics, summary: &Summary) -> Vec<Event> {
    let plant = &outcome.plant;
    let mut events = of_struts(&plant.recording.samples, &plant.assembly);
    for fault in &scenario.faults {
        let (from_s, until_s) = spans_s(fault);
        if from_s < summary.simulated_s {
            events.push(Event {
                at_s: from_s,
                lasted_s: Some(until_s.min(summary.simulated_s) - from_s),
                times: 1,
                what: "fault injected".into(),
                place: String::new(),
                detail: fault_label(fault).into(),
            });
        }
    }
    for entry in &summary.modes {
        events.push(Event {
            at_s: f64::from(entry.tick) * TICK_S,
            lasted_s: None,
            times: 1,
            what: format!("mode {}", entry.mode),
            place: "controller".into(),
            detail: match entry.fault {
                "none" => String::new(),
                fault => format!("first cause: {fault}"),
            },
        });
    }
    let handling: Vec<bool> = metrics.strategy.iter().map(|said| said.handling).collect();
    for found in stretches(handling.len(), |i| handling[i]) {
        events.push(Event {
            at_s: found.from as f64 * TICK_S,
            lasted_s: Some(found.ticks as f64 * TICK_S),
            times: found.times,
            what: "handling mode".into(),
            place: "controller".into(),
            detail: found.times_in_words(),
        });
    }
    events.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
    events
}

/// What happened to the four struts and wheels.
fn of_struts(samples: &[Sample], assembly: &Assembly) -> Vec<Event> {
    let mut events = Vec::new();
    for corner in Corner::ALL {
        let mut note = |what: &str, is: &dyn Fn(&Sample) -> bool, detail: &dyn Fn(&[Sample]) -> String| {
            for found in stretches(samples.len(), |i| is(&samples[i])) {
                let details = [found.times_in_words(), detail(&samples[found.from..found.to])];
                events.push(Event {
                    at_s: found.from as f64 * TICK_S,
                    lasted_s: Some(found.ticks as f64 * TICK_S),
                    times: found.times,
                    what: what.into(),
                    place: corner.name().replace('-', " "),
                    detail: details
                        .into_iter()
                        .filter(|words| !words.is_empty())
                        .collect::<Vec<_>>()
                        .join("; "),
                });
            }
        };
        note(
            "wheel off the ground",
            &|s| s.motion.wheel[corner].load_n <= 0.0,
            &|_| String::new(),
        );
        let lowest_pa = |s: &Sample| {
            s.strut[corner]
                .pressure_pa
                .iter()
                .copied()
                .fold(f64::INFINITY, f64::min)
        };
        note("pressure below the atmosphere's", &|s| lowest_pa(s) < 0.0, &|during| {
            let lowest = during.iter().map(lowest_pa).fold(f64::INFINITY, f64::min);
            let point = PressurePoint::ALL.into_iter().find(|point| {
                during
                    .iter()
                    .any(|s| s.strut[corner].pressure_pa[point.index()] <= lowest)
            });
            format!(
                "down to {} kPa gauge, {}",
                significant(1e-3 * lowest, 3),
                point.map_or("", PressurePoint::key)
            )
        });
        let Some(stops) = &assembly.struts[corner].effects.bump_stop else {
            continue;
        };
        let x_m = |s: &Sample| s.displacement_m[corner];
        note("bump stop", &|s| x_m(s) > stops.bump_clearance_m, &|during| {
            let most = during.iter().map(x_m).fold(f64::NEG_INFINITY, f64::max);
            format!("{} mm into it", significant(1e3 * (most - stops.bump_clearance_m), 2))
        });
        note("rebound stop", &|s| -x_m(s) > stops.rebound_clearance_m, &|during| {
            let most = during.iter().map(x_m).fold(f64::INFINITY, f64::min);
            format!(
                "{} mm into it",
                significant(1e3 * (-most - stops.rebound_clearance_m), 2)
            )
        });
    }
    events
}

/// A stretch in which something holds, with short gaps.
#[derive(Debug, PartialEq)]
struct Stretch {
    from: usize,
    /// Behind the last sample.
    to: usize,
    /// Number of samples in which it holds, the gaps left out.
    ticks: usize,
    /// Number of times that it began to hold.
    times: usize,
}

impl Stretch {
    /// "5 times within 1.2 s"; nothing where it is one piece.
    fn times_in_words(&self) -> String {
        match self.times {
            1 => String::new(),
            times => format!(
                "{times} times within {} s",
                significant((self.to - self.from) as f64 * TICK_S, 3)
            ),
        }
    }
}

/// The stretches in which something holds. Gaps of no more than [`APART_S`] do not end one.
fn stretches(count: usize, holds: impl Fn(usize) -> bool) -> Vec<Stretch> {
    let apart = (APART_S / TICK_S) as usize;
    let mut found: Vec<Stretch> = Vec::new();
    for i in (0..count).filter(|i| holds(*i)) {
        match found.last_mut() {
            Some(last) if i - last.to <= apart => {
                last.times += usize::from(i > last.to);
                last.ticks += 1;
                last.to = i + 1;
            }
            _ => found.push(Stretch {
                from: i,
                to: i + 1,
                ticks: 1,
                times: 1,
            }),
        }
    }
    found
}

/// The list of events; a long one is counted by kind first.
pub(super) fn section(page: &mut Page, events: &[Event]) {
    page.section("Events");
    let mut table = Table::new([
        Column::number("Time, s"),
        Column::text("Event"),
        Column::text("Where"),
        Column::number("For, s"),
        Column::text("Detail"),
    ]);
    for event in events {
        table.row([
            format!("{:.3}", event.at_s),
            event.what.clone(),
            event.place.clone(),
            event.lasted_s.map_or(String::new(), |s| format!("{s:.3}")),
            event.detail.clone(),
        ]);
    }
    if events.len() <= OPEN {
        page.table(table);
        return;
    }
    let mut kinds: Vec<(&str, &str, usize, f64)> = Vec::new();
    for event in events {
        let lasted_s = event.lasted_s.unwrap_or(0.0);
        match kinds
            .iter_mut()
            .find(|(what, place, ..)| (*what, *place) == (&event.what, &event.place))
        {
            Some((_, _, times, sum_s)) => (*times, *sum_s) = (*times + event.times, *sum_s + lasted_s),
            None => kinds.push((&event.what, &event.place, event.times, lasted_s)),
        }
    }
    let mut counted = Table::new([
        Column::text("Event"),
        Column::text("Where"),
        Column::number("Times"),
        Column::number("Together, s"),
    ]);
    for (what, place, times, sum_s) in kinds {
        counted.row([
            what.to_owned(),
            place.to_owned(),
            times.to_string(),
            // A change of mode is an instant.
            if sum_s > 0.0 {
                format!("{sum_s:.2}")
            } else {
                "-".to_owned()
            },
        ]);
    }
    page.table(counted)
        .details(&format!("All {} events in their order", events.len()), table);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_gaps_are_closed_and_long_ones_are_not() {
        let holds = |i: usize| (2..4).contains(&i) || (10..12).contains(&i) || i == 100;
        let stretch = |from, to, ticks, times| Stretch { from, to, ticks, times };
        assert_eq!(stretches(200, holds), [stretch(2, 12, 4, 2), stretch(100, 101, 1, 1)]);
        assert!(stretches(50, |_| false).is_empty());
        assert_eq!(stretches(3, |_| true), [stretch(0, 3, 3, 1)]);
        assert_eq!(stretch(2, 12, 4, 2).times_in_words(), "2 times within 0.0500 s");
    }
}
