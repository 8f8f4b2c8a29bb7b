//! Nitrogen departs from the ideal gas law.

use oleo_plant_sim::strut::{Equation, GasEquation, RealGas as Term, StrutModel, TermId};

use super::candidate::Candidate;
use super::contract::{ActsOn, Concealed, Effect, Experiment, Strut, StrutEffect};
use super::drawn::{Drawn, TrueNumber};
use crate::excitation;
use crate::vocabulary::{EffectId, Site};

pub struct RealGas;

impl Effect for RealGas {
    fn id(&self) -> EffectId {
        EffectId::RealGas
    }

    fn name(&self) -> &'static str {
        "real-gas behaviour of the nitrogen"
    }

    fn meaning(&self) -> &'static str {
        "the pressure deviates from the ideal gas law as the density rises"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[]
    }

    fn told_from(&self, rival: EffectId) -> Option<&'static str> {
        match rival {
            EffectId::GasChargeError => Some(
                "a sawtooth over the whole travel at 5 mm/s up to 12 MPa, valve 3 closed, valve 1 open: the real gas departs with \
                 pressure, the charge does not",
            ),
            _ => None,
        }
    }

    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        Some(self)
    }
}

impl ActsOn<Strut> for RealGas {
    fn equation(&self) -> Equation {
        TermId::RealGas.equation()
    }

    fn candidates(&self, model: &StrutModel, _excitation: &excitation::Strut) -> Vec<Candidate> {
        if model.effects.real_gas.is_some() {
            return vec![];
        }
        vec![Candidate::new(self.id(), Site::Accumulators, vec![])]
    }

    fn put(&self, model: &mut StrutModel, _candidate: &Candidate, _values: &[f64]) {
        model.effects.real_gas = Some(Term {
            equation: GasEquation::Reference,
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "a sawtooth over the whole travel at 5 mm/s up to 12 MPa, valve 3 closed, valve 1 open",
            shows: "deviates more at higher pressure, at any speed",
        }
    }
}

impl Concealed for RealGas {
    fn amounts(&self, _variant: usize) -> Option<(f64, f64)> {
        None
    }

    fn put_true(&self, model: &mut StrutModel, _drawn: &Drawn, _amount: f64) -> Vec<TrueNumber> {
        model.effects.real_gas = Some(Term {
            equation: GasEquation::Reference,
        });
        vec![TrueNumber::present(Site::Accumulators)]
    }
}
