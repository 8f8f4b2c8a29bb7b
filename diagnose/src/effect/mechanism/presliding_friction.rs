//! Presliding friction: a hysteresis over displacement before the contact slides, by Dahl or LuGre.

use oleo_plant_sim::specimen::{MechanismEffects, PreslidingFriction as Term};
use oleo_plant_sim::strut::Equation;

use crate::effect::candidate::Candidate;
use crate::effect::contract::{ActsOn, Effect, Experiment, Mechanism};
use crate::effect::mechanism::friction::{breakaway, coulomb_force, dry, stribeck_speed};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::EffectId;

/// Label of the candidate whose level falls with speed.
const LUGRE: &str = "LuGre";

pub struct PreslidingFriction;

impl Effect for PreslidingFriction {
    fn id(&self) -> EffectId {
        EffectId::PreslidingFriction
    }

    fn name(&self) -> &'static str {
        "presliding friction"
    }

    fn meaning(&self) -> &'static str {
        "the contact shears elastically with the stiffness k until it slides at the level g, which is F_c or falls with speed from F_s to F_c"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[
            ("coulomb_force_N", "F_c"),
            ("presliding_stiffness_N_m", "k"),
            ("breakaway_over_coulomb", "F_s/F_c"),
            ("stribeck_speed_m_s", "v_s"),
        ]
    }

    fn in_mechanism(&self) -> Option<&dyn ActsOn<Mechanism>> {
        Some(self)
    }
}

impl ActsOn<Mechanism> for PreslidingFriction {
    fn equation(&self) -> Equation {
        Term::EQUATION
    }

    fn candidates(&self, model: &MechanismEffects, excitation: &excitation::Mechanism) -> Vec<Candidate> {
        if model.presliding_friction.is_some() {
            return vec![];
        }
        // From sheared over most of the stroke to hardly at all.
        let (force, stiffness) = (excitation.force_n, excitation.force_n / excitation.stroke_m);
        let range = (0.5 * stiffness, 1e5 * stiffness);
        let dahl = || {
            vec![
                coulomb_force(excitation),
                Parameter::log("presliding_stiffness_N_m", 20.0 * stiffness, range),
            ]
        };
        let starts: Vec<Vec<f64>> = [(0.1, 5.0), (0.1, 100.0), (0.5, 5.0), (0.5, 20.0), (0.5, 100.0)]
            .map(|(part, times)| vec![part * force, times * stiffness])
            .to_vec();
        let lugre = [dahl(), vec![breakaway(), stribeck_speed(excitation)]].concat();
        let lugre_starts = (starts.iter())
            .map(|dahl| [dahl.as_slice(), &[1.3, 0.1 * excitation.speed_m_s]].concat())
            .collect();
        let site = || excitation.site.clone();
        vec![
            dry(
                Candidate::new(self.id(), site(), dahl()).starting_at(starts),
                excitation,
            ),
            dry(
                Candidate::new(self.id(), site(), lugre)
                    .labelled(LUGRE)
                    .starting_at(lugre_starts),
                excitation,
            ),
        ]
    }

    fn put(&self, model: &mut MechanismEffects, _candidate: &Candidate, values: &[f64]) {
        model.presliding_friction = Some(Term {
            coulomb_force_n: values[0],
            presliding_stiffness_n_m: values[1],
            breakaway_force_n: values.get(2).map(|ratio| ratio * values[0]),
            stribeck_speed_m_s: values.get(3).copied(),
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "triangles of a hundredth, a tenth and all of the stroke at one low speed",
            shows: "rises over the displacement after each reversal, by the same displacement at every speed",
        }
    }
}
