//! A smooth yield: a resisting force that saturates with speed.

use oleo_plant_sim::specimen::{MechanismEffects, SmoothYield as Term};
use oleo_plant_sim::strut::Equation;

use crate::effect::candidate::Candidate;
use crate::effect::contract::{ActsOn, Effect, Experiment, Mechanism};
use crate::effect::mechanism::friction::VISCOUS;
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::EffectId;

pub struct SmoothYield;

impl Effect for SmoothYield {
    fn id(&self) -> EffectId {
        EffectId::SmoothYield
    }

    fn name(&self) -> &'static str {
        "a smooth yield"
    }

    fn meaning(&self) -> &'static str {
        "the force rises with the speed v and saturates at F_y above the yield speed v_y"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[("yield_force_N", "F_y"), ("yield_speed_m_s", "v_y")]
    }

    fn in_mechanism(&self) -> Option<&dyn ActsOn<Mechanism>> {
        Some(self)
    }
}

impl ActsOn<Mechanism> for SmoothYield {
    fn equation(&self) -> Equation {
        Term::EQUATION
    }

    fn candidates(&self, model: &MechanismEffects, excitation: &excitation::Mechanism) -> Vec<Candidate> {
        if model.smooth_yield.is_some() {
            return vec![];
        }
        let (force, speed) = (excitation.force_n, excitation.speed_m_s);
        let parameters = vec![
            Parameter::linear("yield_force_N", 0.1 * force, 0.05 * force, (0.0, 3.0 * force)),
            Parameter::log("yield_speed_m_s", 0.1 * speed, (1e-3 * speed, 3.0 * speed)),
        ];
        let starts = [(0.1, 0.02), (0.5, 0.02), (0.5, 0.1), (0.5, 0.5)]
            .map(|(f, v)| vec![f * force, v * speed])
            .to_vec();
        let candidate = Candidate::new(self.id(), excitation.site.clone(), parameters);
        // At a yield speed of zero it is Coulomb friction.
        vec![
            candidate
                .starting_at(starts)
                .taking_from(VISCOUS)
                .becoming(EffectId::CoulombFriction),
        ]
    }

    fn put(&self, model: &mut MechanismEffects, _candidate: &Candidate, values: &[f64]) {
        model.smooth_yield = Some(Term {
            yield_force_n: values[0],
            yield_speed_m_s: values[1],
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "sines of one amplitude at six frequencies, from a hundredth to all of the fastest speed",
            shows: "saturates with speed: steep below the yield speed, nearly constant above it, without hysteresis",
        }
    }
}
