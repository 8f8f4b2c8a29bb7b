//! The instrument has the wrong sign.

use oleo_plant_sim::strut::TermId;

use super::fault::{Fault, OfCylinder};
use crate::effect::contract::Experiment;
use crate::vocabulary::EffectId;

pub static SIGN: Fault = Fault {
    id: EffectId::SensorSign,
    term: TermId::SensorSign,
    name: "a sensor with the wrong sign",
    meaning: "the reading has the opposite sign of the true value x",
    symbols: &[],
    parameter: None,
    limited_by_clocks: |_| None,
    of_cylinder: OfCylinder::All,
    amounts: |_| None,
    signed: false,
    with_valves: Experiment {
        record: "one slow stroke of 50 mm at 0.05 m/s into jounce, all valves open",
        shows: "falls where it must rise",
    },
    without_valves: Experiment {
        record: "one slow stroke over the whole travel",
        shows: "falls where it must rise",
    },
};
