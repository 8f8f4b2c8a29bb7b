//! Leakage of oil past a damper pack.

use oleo_plant_sim::strut::{DamperLeakage as Term, Equation, StrutModel, TermId};

use super::candidate::Candidate;
use super::contract::{ActsOn, Concealed, Effect, Experiment, Strut, StrutEffect};
use super::drawn::{Drawn, TrueNumber};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::{Branch, EffectId, Site};

pub struct DamperLeakage;

impl Effect for DamperLeakage {
    fn id(&self) -> EffectId {
        EffectId::DamperLeakage
    }

    fn name(&self) -> &'static str {
        "leakage past the damper pack"
    }

    fn meaning(&self) -> &'static str {
        "oil leaks past the damper pack with the flow coefficient c"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[("flow_coefficient_i", "c")]
    }

    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        Some(self)
    }
}

impl ActsOn<Strut> for DamperLeakage {
    fn equation(&self) -> Equation {
        TermId::DamperLeakage.equation()
    }

    fn candidates(&self, model: &StrutModel, excitation: &excitation::Strut) -> Vec<Candidate> {
        if model.effects.damper_leakage.is_some() {
            return vec![];
        }
        Branch::ALL
            .map(|branch| {
                let i = branch.number();
                let parameters = vec![Parameter::amount(format!("flow_coefficient_{i}"), 1e-8, 1e-5)];
                Candidate::new(self.id(), Site::Path(branch), parameters).testable_unless(excitation.no_drop(branch))
            })
            .to_vec()
    }

    fn put(&self, model: &mut StrutModel, candidate: &Candidate, values: &[f64]) {
        let none = Term {
            flow_coefficient_1: 0.0,
            flow_coefficient_2: 0.0,
        };
        let term = model.effects.damper_leakage.get_or_insert(none);
        *match candidate.place.branch() {
            Some(Branch::Second) => &mut term.flow_coefficient_2,
            _ => &mut term.flow_coefficient_1,
        } = values[0];
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "sines of 25 mm at 0.05, 0.2 and 0.8 m/s, valves 1 and 2 closed, valve 3 open",
            shows: "reduces the damping most at the lowest speed",
        }
    }
}

impl Concealed for DamperLeakage {
    fn variants(&self) -> usize {
        2
    }

    fn amounts(&self, _variant: usize) -> Option<(f64, f64)> {
        Some((1e-11, 1.5e-6))
    }

    fn put_true(&self, model: &mut StrutModel, drawn: &Drawn, amount: f64) -> Vec<TrueNumber> {
        let [first, second] = drawn.in_its_branch(amount);
        model.effects.damper_leakage = Some(Term {
            flow_coefficient_1: first,
            flow_coefficient_2: second,
        });
        let branch = drawn.branch();
        let key = format!("flow_coefficient_{}", branch.number());
        vec![TrueNumber::new(Site::Path(branch), key, amount)]
    }
}
