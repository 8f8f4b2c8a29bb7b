//! The instrument drifts in proportion to time.

use oleo_plant_sim::strut::TermId;

use super::fault::{Fault, OfCylinder};
use crate::effect::contract::Experiment;
use crate::parameter::Parameter;
use crate::vocabulary::EffectId;

pub static DRIFT: Fault = Fault {
    id: EffectId::SensorDrift,
    term: TermId::SensorDrift,
    name: "a drifting sensor",
    meaning: "the reading moves away from the true value x at the constant rate r",
    symbols: &[("drift_m_s", "r"), ("drift_N_s", "r"), ("drift_Pa_s", "r")],
    parameter: Some(|reading| {
        let drift = reading.drift_per_s;
        Parameter::departure(
            format!("drift_{}_s", reading.column.unit()),
            0.01 * drift,
            (-drift, drift),
        )
    }),
    limited_by_clocks: |_| None,
    of_cylinder: OfCylinder::All,
    amounts: |size| Some((1e-6 * size, 0.02 * size)),
    signed: true,
    with_valves: Experiment {
        record: "rest for 10 minutes, then a stroke of 50 mm at 0.5 m/s and back and rest again, all valves open",
        shows: "moves its column evenly while everything rests",
    },
    without_valves: Experiment {
        record: "rest for 10 minutes, then one stroke and back and rest again",
        shows: "moves its column evenly while everything rests",
    },
};
