//! Laws that only a gas spring may have and that the vocabulary has no name for.

use oleo_plant_sim::specimen::{GasSpringEffects, GasSpringModel};
use oleo_plant_sim::strut::{Equation, TermId};

use super::words::NamelessLaw;
use crate::effect::candidate::Candidate;
use crate::effect::contract::{ActsOn, Experiment, GasSpring};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::{EffectId, Site};

const POLYTROPIC_EXPONENT: NamelessLaw = NamelessLaw {
    label: "polytropic exponent",
    name: "a polytropic gas process",
    equation: GasSpringEffects::POLYTROPIC_EXPONENT,
};
const GAS_LOST: NamelessLaw = NamelessLaw {
    label: "gas lost",
    name: "loss of gas",
    equation: GasSpringEffects::GAS_LOST,
};

/// The words of a law.
pub fn words(label: &str) -> Option<NamelessLaw> {
    [POLYTROPIC_EXPONENT, GAS_LOST]
        .into_iter()
        .find(|words| words.label == label)
}

/// The laws of this kind of specimen.
pub struct Laws;

impl ActsOn<GasSpring> for Laws {
    fn equation(&self) -> Equation {
        TermId::Unlisted.equation()
    }

    fn candidates(&self, model: &GasSpringModel, excitation: &excitation::GasSpring) -> Vec<Candidate> {
        let candidate = |law: NamelessLaw, number: Parameter| {
            Candidate::new(EffectId::Unlisted, Site::Chamber, vec![number]).labelled(law.label)
        };
        let mut all = Vec::new();
        // A fixed exponent stands in the place of heat transfer: both say what the gas does with its heat.
        if model.effects.gas_heat_transfer.is_none() {
            let exponent = Parameter::linear("polytropic_exponent", 1.2, 0.05, (1.0, 1.67));
            all.push(candidate(POLYTROPIC_EXPONENT, exponent).in_place_of(EffectId::GasHeatTransfer));
        }
        if model.effects.gas_leak_rate_1_s.is_none() {
            let rate = 0.1 / excitation.extent.duration_s.max(1.0);
            let lost = Parameter::departure("rate_1_s", 0.1 * rate, (-10.0 * rate, 10.0 * rate));
            all.push(candidate(GAS_LOST, lost));
        }
        all
    }

    fn put(&self, model: &mut GasSpringModel, candidate: &Candidate, values: &[f64]) {
        let effects = &mut model.effects;
        if candidate.label == GAS_LOST.label {
            effects.gas_leak_rate_1_s = Some(values[0]);
        } else {
            effects.polytropic_exponent = Some(values[0]);
        }
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "the same stroke in 1 second, in 1 minute and in 10 minutes, each held for 10 minutes",
            shows: "has the same exponent at every speed, or loses gas as long as it is under pressure",
        }
    }
}
