//! The clock of the instrument is late or early.

use oleo_plant_sim::strut::TermId;

use super::fault::{Fault, OfCylinder};
use crate::effect::contract::Experiment;
use crate::parameter::Parameter;
use crate::vocabulary::EffectId;

pub static SKEW: Fault = Fault {
    id: EffectId::SensorSkew,
    term: TermId::SensorSkew,
    name: "a sensor with a time offset",
    meaning: "the reading shows the true value x later by the time s",
    symbols: &[("delay_s", "s")],
    parameter: Some(|reading| {
        let short = reading.interval_s;
        Parameter::departure("delay_s", short, (-50.0 * short, 50.0 * short))
    }),
    // A time skew is the great impostor of heat transfer over a whole stroke, but not at its corners: where those are sharp
    // enough to read the delay off, a skew may only be what they show.
    limited_by_clocks: |excitation| {
        let interval = excitation.extent.interval_s;
        let [low, middle, high] = (excitation.clocks.iter())
            .map(|c| c.delay_s)
            .reduce(|a, b| [a[0].min(b[0]), 0.5 * (a[1] + b[1]), a[2].max(b[2])])?;
        let start = if middle.abs() > interval { middle } else { 0.0 };
        let range = (low - 2.0 * interval, high + 2.0 * interval);
        Some(Parameter::linear("delay_s", start, interval, range))
    },
    of_cylinder: OfCylinder::All,
    amounts: |_| Some((1e-6, 0.03)),
    signed: true,
    with_valves: Experiment {
        record: "a ramp of 50 mm at 0.5 m/s with all valves open and all columns on one clock",
        shows: "moves every corner of its column by the same time and keeps it sharp",
    },
    without_valves: Experiment {
        record: "the same stroke at a tenth of the speed and at twice the speed",
        shows: "moves every corner of its column by the same time and keeps it sharp at both speeds",
    },
};
