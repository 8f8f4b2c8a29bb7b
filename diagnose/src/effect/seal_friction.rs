//! Coulomb and Stribeck friction of the rod seal.

use oleo_plant_sim::specimen::{CylinderEffects, CylinderModel, CylinderSeal};
use oleo_plant_sim::strut::{Equation, PRESLIDING_STIFFNESS_N_M, SealFriction as Term, StrutModel, TermId};

use super::candidate::Candidate;
use super::contract::{ActsOn, Concealed, Cylinder, Effect, Experiment, Strut, StrutEffect};
use super::drawn::{Drawn, TrueNumber};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::{EffectId, Site};

pub struct SealFriction;

impl Effect for SealFriction {
    fn id(&self) -> EffectId {
        EffectId::SealFriction
    }

    fn name(&self) -> &'static str {
        "seal friction"
    }

    fn meaning(&self) -> &'static str {
        "the seal deforms elastically with the presliding stiffness k until it slides with the friction force g"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[
            ("coulomb_force_N", "F_c"),
            ("breakaway_over_coulomb", "F_s/F_c"),
            ("stribeck_speed_m_s", "v_s"),
        ]
    }

    fn told_from(&self, rival: EffectId) -> Option<&'static str> {
        match rival {
            EffectId::SideLoadFriction => Some(
                "the same triangle of 10 mm at 5 mm/s about -60, 0 and 60 mm, all valves open: side-load friction grows with \
                 the force, seal friction does not",
            ),
            EffectId::AccumulatorPistonFriction => Some(
                "a triangle of 10 mm at 5 mm/s, all valves open, force, p1 and p2 recorded: the hysteresis of the seal \
                 is in the force only, that of the piston is also in p1 and p2",
            ),
            _ => None,
        }
    }

    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        Some(self)
    }

    fn in_cylinder(&self) -> Option<&dyn ActsOn<Cylinder>> {
        Some(self)
    }
}

impl ActsOn<Strut> for SealFriction {
    fn equation(&self) -> Equation {
        TermId::SealFriction.equation()
    }

    fn candidates(&self, model: &StrutModel, _excitation: &excitation::Strut) -> Vec<Candidate> {
        if model.effects.seal_friction.is_some() {
            return vec![];
        }
        let parameters = vec![
            Parameter::amount("coulomb_force_N", 20.0, 1e4),
            Parameter::linear("breakaway_over_coulomb", 1.3, 0.2, (1.0, 4.0)),
            Parameter::log("stribeck_speed_m_s", 0.02, (1e-3, 0.5)),
        ];
        vec![Candidate::new(self.id(), Site::MainSeal, parameters)]
    }

    fn put(&self, model: &mut StrutModel, _candidate: &Candidate, values: &[f64]) {
        model.effects.seal_friction = Some(Term {
            coulomb_force_n: values[0],
            breakaway_force_n: values[0] * values[1],
            stribeck_speed_m_s: values[2],
            presliding_stiffness_n_m: PRESLIDING_STIFFNESS_N_M,
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "the same triangle of 10 mm at 5 mm/s about -60, 0 and 60 mm, all valves open, force and p1 recorded",
            shows: "gives a hysteresis in the force only, which has the same width at each position",
        }
    }
}

impl Concealed for SealFriction {
    fn amounts(&self, _variant: usize) -> Option<(f64, f64)> {
        Some((0.3, 3e3))
    }

    fn put_true(&self, model: &mut StrutModel, drawn: &Drawn, amount: f64) -> Vec<TrueNumber> {
        let (ratio, speed) = (drawn.between(0, 1.0, 1.5), drawn.between(1, 0.01, 0.05));
        model.effects.seal_friction = Some(Term {
            coulomb_force_n: amount,
            breakaway_force_n: amount * ratio,
            stribeck_speed_m_s: speed,
            presliding_stiffness_n_m: PRESLIDING_STIFFNESS_N_M,
        });
        vec![
            TrueNumber::new(Site::MainSeal, "coulomb_force_N", amount),
            TrueNumber::new(Site::MainSeal, "breakaway_over_coulomb", ratio),
            TrueNumber::new(Site::MainSeal, "stribeck_speed_m_s", speed),
        ]
    }
}

impl ActsOn<Cylinder> for SealFriction {
    fn equation(&self) -> Equation {
        CylinderEffects::SEAL_FRICTION
    }

    fn candidates(&self, model: &CylinderModel, excitation: &excitation::Cylinder) -> Vec<Candidate> {
        if model.effects.seal_friction.is_some() {
            return vec![];
        }
        let force = excitation.force_n;
        let coulomb = Parameter::linear("coulomb_force_N", 0.02 * force, 0.01 * force, (0.0, force));
        vec![Candidate::new(self.id(), Site::MainSeal, vec![coulomb])]
    }

    fn put(&self, model: &mut CylinderModel, _candidate: &Candidate, values: &[f64]) {
        seal(model).coulomb_force_n = values[0];
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "strokes of full travel at a tenth and at ten times the speed, at the lowest pressure",
            shows: "gives a force against the motion that is the same at both speeds",
        }
    }
}

/// The seal of a cylinder, made without Coulomb friction where there is none yet. Its presliding stiffness is calibration:
/// the specimen sets it.
pub(super) fn seal(model: &mut CylinderModel) -> &mut CylinderSeal {
    model.effects.seal_friction.get_or_insert(CylinderSeal {
        coulomb_force_n: 0.0,
        presliding_stiffness_n_m: PRESLIDING_STIFFNESS_N_M,
    })
}
