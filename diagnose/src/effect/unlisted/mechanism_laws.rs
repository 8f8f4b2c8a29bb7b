//! Laws that only a damper or a drive may have and that the vocabulary has no name for: one number each, of either sign.

use oleo_plant_sim::specimen::{MechanismEffects, UnnamedForces};
use oleo_plant_sim::strut::{Equation, TermId};

use super::words::NamelessLaw;
use crate::effect::candidate::Candidate;
use crate::effect::contract::{ActsOn, Experiment, Mechanism};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::{EffectId, Site};

/// A force in proportion to a function of the motion.
struct Law {
    words: NamelessLaw,
    /// Key of the law's parameter.
    key: &'static str,
    /// Its number in a model.
    field: fn(&mut UnnamedForces) -> &mut Option<f64>,
    /// Whether a drive may have it, besides a damper.
    in_drives: bool,
    /// Largest value of the function that it is in proportion to, SI.
    largest: fn(&excitation::Mechanism) -> f64,
}

const LAWS: [Law; 4] = [
    Law {
        words: NamelessLaw {
            label: "viscous damping",
            name: "further viscous damping",
            equation: UnnamedForces::VISCOUS,
        },
        key: "viscous_N_s_m",
        in_drives: true,
        field: |forces| &mut forces.viscous_n_s_m,
        largest: |excitation| excitation.speed_m_s,
    },
    Law {
        words: NamelessLaw {
            label: "turbulent damping",
            name: "turbulent damping",
            equation: UnnamedForces::TURBULENT,
        },
        key: "turbulent_N_s2_m2",
        in_drives: true,
        field: |forces| &mut forces.turbulent_n_s2_m2,
        largest: |excitation| excitation.speed_m_s * excitation.speed_m_s,
    },
    Law {
        words: NamelessLaw {
            // A damper has other orifices in rebound than in jounce. The bearings of a drive are the same both ways, and what differs
            // there is a constant force, which has a name.
            label: "one-sided damping",
            name: "damping that differs between the directions",
            equation: UnnamedForces::ONE_SIDED,
        },
        key: "one_sided_N_s_m",
        in_drives: false,
        field: |forces| &mut forces.one_sided_n_s_m,
        largest: |excitation| excitation.speed_m_s,
    },
    Law {
        words: NamelessLaw {
            label: "cubic stiffness",
            name: "a cubic stiffness",
            equation: UnnamedForces::CUBIC,
        },
        key: "cubic_N_m3",
        in_drives: true,
        field: |forces| &mut forces.cubic_n_m3,
        largest: |excitation| excitation.stroke_m * excitation.stroke_m * excitation.stroke_m,
    },
];

/// The words of a law.
pub fn words(label: &str) -> Option<NamelessLaw> {
    LAWS.iter().map(|law| law.words).find(|words| words.label == label)
}

/// The laws of these kinds of specimen.
pub struct Laws;

impl ActsOn<Mechanism> for Laws {
    fn equation(&self) -> Equation {
        TermId::Unlisted.equation()
    }

    fn candidates(&self, _model: &MechanismEffects, excitation: &excitation::Mechanism) -> Vec<Candidate> {
        let candidate = |law: &Law| {
            let most = 5.0 * excitation.force_n / (law.largest)(excitation);
            let number = Parameter::departure(law.key, 0.004 * most, (-most, most));
            Candidate::new(EffectId::Unlisted, excitation.site.clone(), vec![number]).labelled(law.words.label)
        };
        let is_drive = excitation.site == Site::Drive;
        LAWS.iter()
            .filter(|law| law.in_drives || !is_drive)
            .map(candidate)
            .collect()
    }

    fn put(&self, model: &mut MechanismEffects, candidate: &Candidate, values: &[f64]) {
        if let Some(law) = LAWS.iter().find(|law| law.words.label == candidate.label) {
            let number = (law.field)(model.unlisted.get_or_insert_default());
            *number = Some(number.unwrap_or(0.0) + values[0]);
        }
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "sines of full travel and of a tenth of it, at a tenth and at ten times the speed",
            shows: "follows the power of the speed or of the displacement in its equation",
        }
    }
}
