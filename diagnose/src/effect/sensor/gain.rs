//! The gain of the instrument is wrong.

use oleo_plant_sim::strut::TermId;

use super::fault::{Fault, OfCylinder};
use crate::effect::contract::Experiment;
use crate::parameter::Parameter;
use crate::vocabulary::EffectId;

pub static GAIN: Fault = Fault {
    id: EffectId::SensorGain,
    term: TermId::SensorGain,
    name: "a sensor with a wrong gain",
    meaning: "the reading differs from the true value x by the relative error e",
    symbols: &[("relative_error", "e")],
    parameter: Some(|_| Parameter::departure("relative_error", 0.01, (-0.6, 0.6))),
    limited_by_clocks: |_| None,
    of_cylinder: OfCylinder::All,
    amounts: |_| Some((1e-5, 0.5)),
    signed: true,
    with_valves: Experiment {
        record: "three levels 20 mm apart, each reached at 0.5 m/s and held for 5 s, all valves open, with a calibrated reference \
                 beside the instrument",
        shows: "is off by the same fraction at every level",
    },
    without_valves: Experiment {
        record: "three levels a third of the travel apart, each held until it rests, with a calibrated reference beside the \
                 instrument",
        shows: "is off by the same fraction at every level",
    },
};
