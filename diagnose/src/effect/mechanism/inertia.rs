//! A moving mass that the model does not have.

use oleo_plant_sim::specimen::{Inertia as Term, MechanismEffects};
use oleo_plant_sim::strut::Equation;

use crate::effect::candidate::Candidate;
use crate::effect::contract::{ActsOn, Effect, Experiment, Mechanism};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::EffectId;

/// Largest part of a believed mass that may not be there.
const LARGEST_ERROR: f64 = 0.7;

pub struct Inertia;

impl Effect for Inertia {
    fn id(&self) -> EffectId {
        EffectId::Inertia
    }

    fn name(&self) -> &'static str {
        "a moving mass"
    }

    fn meaning(&self) -> &'static str {
        "a part of the mass m is accelerated that the model does not have"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[("moving_mass_kg", "m")]
    }

    fn in_mechanism(&self) -> Option<&dyn ActsOn<Mechanism>> {
        Some(self)
    }
}

impl ActsOn<Mechanism> for Inertia {
    fn equation(&self) -> Equation {
        Term::EQUATION
    }

    fn candidates(&self, model: &MechanismEffects, excitation: &excitation::Mechanism) -> Vec<Candidate> {
        if model.inertia.is_some() {
            return vec![];
        }
        let most = excitation.force_n / excitation.acceleration_m_s2;
        // What is left of a mass that the model has must be a mass.
        let least = if excitation.mass_kg > 0.0 {
            -LARGEST_ERROR * excitation.mass_kg
        } else {
            -2.0 * most
        };
        let mass = Parameter::linear("moving_mass_kg", 0.0, 0.02 * most, (least, 2.0 * most));
        vec![Candidate::new(self.id(), excitation.site.clone(), vec![mass])]
    }

    fn put(&self, model: &mut MechanismEffects, _candidate: &Candidate, values: &[f64]) {
        model.inertia = Some(Term {
            moving_mass_kg: values[0],
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "sines of one amplitude at the frequency, half and twice of it",
            shows: "takes a force in proportion to the acceleration, which grows with the square of the frequency",
        }
    }
}
