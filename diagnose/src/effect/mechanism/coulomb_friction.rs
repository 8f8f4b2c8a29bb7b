//! Coulomb friction: the same force against the motion at every speed.

use oleo_plant_sim::specimen::{CoulombFriction as Term, MechanismEffects};
use oleo_plant_sim::strut::Equation;

use crate::effect::candidate::Candidate;
use crate::effect::contract::{ActsOn, Effect, Experiment, Mechanism};
use crate::effect::mechanism::friction::{coulomb_force, dry};
use crate::excitation;
use crate::vocabulary::EffectId;

pub struct CoulombFriction;

impl Effect for CoulombFriction {
    fn id(&self) -> EffectId {
        EffectId::CoulombFriction
    }

    fn name(&self) -> &'static str {
        "Coulomb friction"
    }

    fn meaning(&self) -> &'static str {
        "a force of the size F_c acts against the speed v, and holds any smaller force at rest"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[("coulomb_force_N", "F_c")]
    }

    fn in_mechanism(&self) -> Option<&dyn ActsOn<Mechanism>> {
        Some(self)
    }
}

impl ActsOn<Mechanism> for CoulombFriction {
    fn equation(&self) -> Equation {
        Term::EQUATION
    }

    fn candidates(&self, model: &MechanismEffects, excitation: &excitation::Mechanism) -> Vec<Candidate> {
        if model.coulomb_friction.is_some() {
            return vec![];
        }
        let force = excitation.force_n;
        let candidate = Candidate::new(self.id(), excitation.site.clone(), vec![coulomb_force(excitation)]);
        vec![dry(
            candidate.starting_at(vec![vec![0.02 * force], vec![0.4 * force]]),
            excitation,
        )]
    }

    fn put(&self, model: &mut MechanismEffects, _candidate: &Candidate, values: &[f64]) {
        model.coulomb_friction = Some(Term {
            coulomb_force_n: values[0],
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "triangles of the full stroke at a tenth and at ten times the speed",
            shows: "steps by the same force at each reversal, at every speed",
        }
    }
}
