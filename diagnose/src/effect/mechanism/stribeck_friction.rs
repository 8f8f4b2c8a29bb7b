//! Stribeck friction: dry friction that falls with speed.

use oleo_plant_sim::specimen::{MechanismEffects, StribeckFriction as Term};
use oleo_plant_sim::strut::Equation;

use crate::effect::candidate::Candidate;
use crate::effect::contract::{ActsOn, Effect, Experiment, Mechanism};
use crate::effect::mechanism::friction::{breakaway, coulomb_force, dry, stribeck_speed};
use crate::excitation;
use crate::vocabulary::EffectId;

pub struct StribeckFriction;

impl Effect for StribeckFriction {
    fn id(&self) -> EffectId {
        EffectId::StribeckFriction
    }

    fn name(&self) -> &'static str {
        "Stribeck friction"
    }

    fn meaning(&self) -> &'static str {
        "a friction force falls from F_s at rest to F_c as the speed v rises, over the Stribeck speed v_s"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[
            ("coulomb_force_N", "F_c"),
            ("breakaway_over_coulomb", "F_s/F_c"),
            ("stribeck_speed_m_s", "v_s"),
        ]
    }

    fn in_mechanism(&self) -> Option<&dyn ActsOn<Mechanism>> {
        Some(self)
    }
}

impl ActsOn<Mechanism> for StribeckFriction {
    fn equation(&self) -> Equation {
        Term::EQUATION
    }

    fn candidates(&self, model: &MechanismEffects, excitation: &excitation::Mechanism) -> Vec<Candidate> {
        if model.stribeck_friction.is_some() {
            return vec![];
        }
        let parameters = vec![coulomb_force(excitation), breakaway(), stribeck_speed(excitation)];
        let (force, speed) = (excitation.force_n, excitation.speed_m_s);
        let starts = [0.02, 0.1, 0.4]
            .map(|part| vec![part * force, 1.5, 0.02 * speed])
            .to_vec();
        let candidate = Candidate::new(self.id(), excitation.site.clone(), parameters);
        vec![dry(candidate.starting_at(starts), excitation)]
    }

    fn put(&self, model: &mut MechanismEffects, _candidate: &Candidate, values: &[f64]) {
        model.stribeck_friction = Some(Term {
            coulomb_force_n: values[0],
            breakaway_force_n: values[0] * values[1],
            stribeck_speed_m_s: values[2],
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "triangles of the full stroke at six speeds, from a thousandth to all of the fastest",
            shows: "takes a force that falls as the speed rises from rest",
        }
    }
}
