//! A gas spring in parallel.

use oleo_plant_sim::specimen::{MechanismEffects, ParallelGasSpring as Term};
use oleo_plant_sim::strut::Equation;

use crate::effect::candidate::Candidate;
use crate::effect::contract::{ActsOn, Effect, Experiment, Mechanism};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::EffectId;

pub struct GasSpring;

impl Effect for GasSpring {
    fn id(&self) -> EffectId {
        EffectId::GasSpring
    }

    fn name(&self) -> &'static str {
        "a parallel gas spring"
    }

    fn meaning(&self) -> &'static str {
        "gas with the force F_0 at zero displacement and a column of the length L is compressed adiabatically over the displacement x"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[("gas_force_N", "F_0"), ("gas_length_m", "L")]
    }

    fn in_mechanism(&self) -> Option<&dyn ActsOn<Mechanism>> {
        Some(self)
    }
}

impl ActsOn<Mechanism> for GasSpring {
    fn equation(&self) -> Equation {
        Term::EQUATION
    }

    fn candidates(&self, model: &MechanismEffects, excitation: &excitation::Mechanism) -> Vec<Candidate> {
        if model.gas_spring.is_some() {
            return vec![];
        }
        let (force, stroke) = (excitation.force_n, excitation.stroke_m);
        let shortest = 1.1 * excitation.farthest_m.max(0.1 * stroke);
        let parameters = vec![
            Parameter::linear("gas_force_N", 0.05 * force, 0.05 * force, (0.0, 5.0 * force)),
            Parameter::log(
                "gas_length_m",
                (2.0 * stroke).max(1.2 * shortest),
                (shortest, 100.0 * stroke),
            ),
        ];
        vec![Candidate::new(self.id(), excitation.site.clone(), parameters).in_place_of(EffectId::Stiffness)]
    }

    fn put(&self, model: &mut MechanismEffects, _candidate: &Candidate, values: &[f64]) {
        model.gas_spring = Some(Term {
            gas_force_n: values[0],
            gas_length_m: values[1],
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "slow strokes to both ends of the travel, each held for a minute",
            shows: "bends the loop of force over displacement upwards, more steeply the farther it is compressed",
        }
    }
}
