//! Undissolved air in the oil lowers its bulk modulus at low pressure.

use oleo_plant_sim::strut::{EntrainedAir as Term, Equation, StrutModel, TermId};

use super::candidate::Candidate;
use super::contract::{ActsOn, Concealed, Effect, Experiment, Strut, StrutEffect};
use super::drawn::{Drawn, TrueNumber};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::{EffectId, Site};

pub struct EntrainedAir;

impl Effect for EntrainedAir {
    fn id(&self) -> EffectId {
        EffectId::EntrainedAir
    }

    fn name(&self) -> &'static str {
        "air in the oil"
    }

    fn meaning(&self) -> &'static str {
        "the bulk modulus falls at low pressure; a is the volume fraction of air at atmospheric pressure, n is its polytropic exponent, and p is the absolute pressure"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[("volume_fraction", "a"), ("polytropic_exponent", "n")]
    }

    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        Some(self)
    }
}

impl ActsOn<Strut> for EntrainedAir {
    fn equation(&self) -> Equation {
        TermId::EntrainedAir.equation()
    }

    fn candidates(&self, model: &StrutModel, _excitation: &excitation::Strut) -> Vec<Candidate> {
        if model.effects.entrained_air.is_some() {
            return vec![];
        }
        let exponent = Parameter::linear("polytropic_exponent", 1.2, 0.1, (1.0, 1.4));
        let parameters = vec![Parameter::amount("volume_fraction", 1e-3, 0.3), exponent];
        vec![Candidate::new(self.id(), Site::MainChamber, parameters).starting_at(vec![vec![5e-3, 1.2]])]
    }

    fn put(&self, model: &mut StrutModel, _candidate: &Candidate, values: &[f64]) {
        model.effects.entrained_air = Some(Term {
            volume_fraction: values[0],
            polytropic_exponent: values[1],
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "a sawtooth from -80 mm to 60 mm at 5 mm/s, valve 3 closed, valves 1 and 2 open",
            shows: "makes the oil softer below 1 MPa only",
        }
    }
}

impl Concealed for EntrainedAir {
    fn amounts(&self, _variant: usize) -> Option<(f64, f64)> {
        Some((1e-6, 0.1))
    }

    fn put_true(&self, model: &mut StrutModel, drawn: &Drawn, amount: f64) -> Vec<TrueNumber> {
        let exponent = drawn.between(0, 1.0, 1.4);
        model.effects.entrained_air = Some(Term {
            volume_fraction: amount,
            polytropic_exponent: exponent,
        });
        vec![
            TrueNumber::new(Site::MainChamber, "volume_fraction", amount),
            TrueNumber::new(Site::MainChamber, "polytropic_exponent", exponent),
        ]
    }
}
