//! The instrument follows with a first-order lag.

use oleo_plant_sim::strut::TermId;

use super::fault::{Fault, OfCylinder};
use crate::effect::contract::Experiment;
use crate::parameter::Parameter;
use crate::vocabulary::EffectId;

/// Fraction of the corners of a motion that must be late but sharp for a lag to be ruled out.
const MOSTLY: f64 = 0.8;

pub static LAG: Fault = Fault {
    id: EffectId::SensorLag,
    term: TermId::SensorLag,
    name: "a lagging sensor",
    meaning: "the reading follows the true value x with the time constant tau",
    symbols: &[("time_constant_s", "tau")],
    parameter: Some(|reading| {
        let short = reading.interval_s;
        Parameter::amount("time_constant_s", 0.5 * short, 1e3 * short)
    }),
    // What is late but sharp at the corners does not lag.
    limited_by_clocks: |excitation| {
        let (clocks, interval) = (&excitation.clocks, excitation.extent.interval_s);
        let sharp = !clocks.is_empty() && clocks.iter().all(|c| c.is_late(interval) && c.sharp > MOSTLY);
        sharp.then(|| Parameter::amount("time_constant_s", 0.5 * interval, interval))
    },
    of_cylinder: OfCylinder::LoadCell,
    amounts: |_| Some((1e-6, 0.03)),
    signed: false,
    with_valves: Experiment {
        record: "a ramp of 50 mm at 0.5 m/s with all valves open and all columns on one clock",
        shows: "rounds the corners of its column and leaves it behind in proportion to the slope",
    },
    without_valves: Experiment {
        record: "the same stroke at a tenth of the speed and at twice the speed",
        shows: "rounds the corners of its column, by the same time at both speeds",
    },
};
