//! The gas charge of an accumulator is outside its tolerance.

use oleo_plant_sim::strut::{Equation, GasChargeError as Term, StrutModel, TermId};

use super::candidate::Candidate;
use super::contract::{ActsOn, Concealed, Effect, Experiment, Strut, StrutEffect};
use super::drawn::{Drawn, TrueNumber};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::{Branch, EffectId, Site};

pub struct GasChargeError;

impl Effect for GasChargeError {
    fn id(&self) -> EffectId {
        EffectId::GasChargeError
    }

    fn name(&self) -> &'static str {
        "a wrong gas charge"
    }

    fn meaning(&self) -> &'static str {
        "the accumulator holds more or less gas than the model states, by more than its tolerance; e is the relative error"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[("relative_error_i", "e")]
    }

    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        Some(self)
    }
}

impl ActsOn<Strut> for GasChargeError {
    fn equation(&self) -> Equation {
        TermId::GasChargeError.equation()
    }

    fn candidates(&self, model: &StrutModel, _excitation: &excitation::Strut) -> Vec<Candidate> {
        if model.effects.gas_charge_error.is_some() {
            return vec![];
        }
        Branch::ALL
            .map(|branch| {
                let i = branch.number();
                let parameters = vec![Parameter::departure(format!("relative_error_{i}"), 0.02, (-0.7, 2.0))];
                Candidate::new(self.id(), Site::Accumulator(branch), parameters)
            })
            .to_vec()
    }

    fn put(&self, model: &mut StrutModel, candidate: &Candidate, values: &[f64]) {
        let none = Term {
            relative_error_1: 0.0,
            relative_error_2: 0.0,
        };
        let term = model.effects.gas_charge_error.get_or_insert(none);
        *match candidate.place.branch() {
            Some(Branch::Second) => &mut term.relative_error_2,
            _ => &mut term.relative_error_1,
        } = values[0];
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "a sawtooth of 60 mm at 5 mm/s, valve 1 open, once with valve 3 open and once with it closed",
            shows: "makes the spring softer or stiffer by one factor over the whole stroke, at any speed",
        }
    }
}

impl Concealed for GasChargeError {
    fn variants(&self) -> usize {
        2
    }

    fn amounts(&self, _variant: usize) -> Option<(f64, f64)> {
        Some((1e-4, 0.5))
    }

    fn put_true(&self, model: &mut StrutModel, drawn: &Drawn, amount: f64) -> Vec<TrueNumber> {
        let [first, second] = drawn.in_its_branch(drawn.sign * amount);
        model.effects.gas_charge_error = Some(Term {
            relative_error_1: first,
            relative_error_2: second,
        });
        let branch = drawn.branch();
        let key = format!("relative_error_{}", branch.number());
        vec![TrueNumber::new(Site::Accumulator(branch), key, drawn.sign * amount)]
    }
}
