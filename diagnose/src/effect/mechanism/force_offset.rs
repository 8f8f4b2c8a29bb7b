//! A constant force.

use oleo_plant_sim::specimen::{ForceOffset as Term, MechanismEffects};
use oleo_plant_sim::strut::Equation;

use crate::effect::candidate::Candidate;
use crate::effect::contract::{ActsOn, Effect, Experiment, Mechanism};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::EffectId;

pub struct ForceOffset;

impl Effect for ForceOffset {
    fn id(&self) -> EffectId {
        EffectId::ForceOffset
    }

    fn name(&self) -> &'static str {
        "a constant force"
    }

    fn meaning(&self) -> &'static str {
        "the constant force F_0 acts at all times, such as gravity, a cable, or the zero of an instrument"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[("force_N", "F_0")]
    }

    fn in_mechanism(&self) -> Option<&dyn ActsOn<Mechanism>> {
        Some(self)
    }
}

impl ActsOn<Mechanism> for ForceOffset {
    fn equation(&self) -> Equation {
        Term::EQUATION
    }

    fn candidates(&self, model: &MechanismEffects, excitation: &excitation::Mechanism) -> Vec<Candidate> {
        if model.force_offset.is_some() {
            return vec![];
        }
        let force = excitation.force_n;
        let offset = Parameter::departure("force_N", 0.01 * force, (-force, force));
        vec![Candidate::new(self.id(), excitation.site.clone(), vec![offset])]
    }

    fn put(&self, model: &mut MechanismEffects, _candidate: &Candidate, values: &[f64]) {
        model.force_offset = Some(Term { force_n: values[0] });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "rest at three positions, then slow strokes in both directions between them",
            shows: "is the same force at every position, at rest and in both directions",
        }
    }
}
