//! Laws that only a cylinder may have and that the vocabulary has no name for: one number each, of either sign.

use oleo_plant_sim::specimen::{CylinderEffects, CylinderModel};
use oleo_plant_sim::strut::{Equation, TermId};

use super::words::NamelessLaw;
use crate::effect::candidate::Candidate;
use crate::effect::contract::{ActsOn, Cylinder, Experiment};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::{EffectId, Site};

/// A force in proportion to one quantity of the motion.
struct Law {
    words: NamelessLaw,
    /// Key of the law's parameter.
    key: &'static str,
    /// Its number in a model.
    field: fn(&mut CylinderEffects) -> &mut Option<f64>,
    /// Largest value of the quantity that it is in proportion to, SI.
    largest: fn(&excitation::Cylinder) -> f64,
}

const LAWS: [Law; 3] = [
    Law {
        words: NamelessLaw {
            label: "moving mass",
            name: "a moving mass",
            equation: CylinderEffects::MOVING_MASS,
        },
        key: "moving_mass_kg",
        field: |effects| &mut effects.moving_mass_kg,
        largest: |excitation| excitation.acceleration_m_s2,
    },
    Law {
        words: NamelessLaw {
            label: "viscous friction",
            name: "viscous friction",
            equation: CylinderEffects::VISCOUS_FRICTION,
        },
        key: "viscous_friction_N_s_m",
        field: |effects| &mut effects.viscous_friction_n_s_m,
        largest: |excitation| excitation.speed_m_s,
    },
    Law {
        words: NamelessLaw {
            label: "parallel stiffness",
            name: "a parallel stiffness",
            equation: CylinderEffects::PARALLEL_STIFFNESS,
        },
        key: "parallel_stiffness_N_m",
        field: |effects| &mut effects.parallel_stiffness_n_m,
        largest: |excitation| excitation.stroke_m,
    },
];

/// The words of a law.
pub fn words(label: &str) -> Option<NamelessLaw> {
    LAWS.iter().map(|law| law.words).find(|words| words.label == label)
}

/// The laws of this kind of specimen.
pub struct Laws;

impl ActsOn<Cylinder> for Laws {
    fn equation(&self) -> Equation {
        TermId::Unlisted.equation()
    }

    fn candidates(&self, _model: &CylinderModel, excitation: &excitation::Cylinder) -> Vec<Candidate> {
        let candidate = |law: &Law| {
            let most = excitation.force_n / (law.largest)(excitation);
            let number = Parameter::departure(law.key, 0.02 * most, (-most, most));
            Candidate::new(EffectId::Unlisted, Site::MainSeal, vec![number]).labelled(law.words.label)
        };
        LAWS.iter().map(candidate).collect()
    }

    fn put(&self, model: &mut CylinderModel, candidate: &Candidate, values: &[f64]) {
        if let Some(law) = LAWS.iter().find(|law| law.words.label == candidate.label) {
            *(law.field)(&mut model.effects) = Some(values[0]);
        }
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "sines of full travel and of a tenth of it, at a tenth and at ten times the speed, at one pressure",
            shows: "is proportional to the acceleration, speed or displacement in its equation",
        }
    }
}
