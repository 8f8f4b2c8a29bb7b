//! A linear spring in parallel.

use oleo_plant_sim::specimen::{MechanismEffects, Stiffness as Term};
use oleo_plant_sim::strut::Equation;

use crate::effect::candidate::Candidate;
use crate::effect::contract::{ActsOn, Effect, Experiment, Mechanism};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::EffectId;

pub struct Stiffness;

impl Effect for Stiffness {
    fn id(&self) -> EffectId {
        EffectId::Stiffness
    }

    fn name(&self) -> &'static str {
        "a parallel stiffness"
    }

    fn meaning(&self) -> &'static str {
        "a linear spring of stiffness k acts in parallel over the displacement x"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[("stiffness_N_m", "k")]
    }

    fn in_mechanism(&self) -> Option<&dyn ActsOn<Mechanism>> {
        Some(self)
    }
}

impl ActsOn<Mechanism> for Stiffness {
    fn equation(&self) -> Equation {
        Term::EQUATION
    }

    fn candidates(&self, model: &MechanismEffects, excitation: &excitation::Mechanism) -> Vec<Candidate> {
        if model.stiffness.is_some() {
            return vec![];
        }
        // No passive spring pushes away from its rest.
        let most = excitation.force_n / excitation.stroke_m;
        let stiffness = Parameter::amount("stiffness_N_m", 0.02 * most, 5.0 * most);
        // A gas spring is a stiffness too: the two are forms of one effect.
        vec![Candidate::new(self.id(), excitation.site.clone(), vec![stiffness]).in_place_of(EffectId::Stiffness)]
    }

    fn put(&self, model: &mut MechanismEffects, _candidate: &Candidate, values: &[f64]) {
        model.stiffness = Some(Term {
            stiffness_n_m: values[0],
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "slow strokes over the whole travel in both directions",
            shows: "inclines the loop of force over displacement, by the same slope everywhere",
        }
    }
}
