//! Friction of a floating piston: its seal resists a pressure difference.

use oleo_plant_sim::strut::{AccumulatorPistonFriction as Term, Equation, StrutModel, TermId};

use super::candidate::Candidate;
use super::contract::{ActsOn, Concealed, Effect, Experiment, Strut, StrutEffect};
use super::drawn::{Drawn, TrueNumber};
use super::relation;
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::{Branch, EffectId, Site};

pub struct AccumulatorPistonFriction;

impl Effect for AccumulatorPistonFriction {
    fn id(&self) -> EffectId {
        EffectId::AccumulatorPistonFriction
    }

    fn name(&self) -> &'static str {
        "friction of the floating piston"
    }

    fn meaning(&self) -> &'static str {
        "the seal of the piston resists up to the pressure difference p_f and deforms elastically over the volume V_s before it slides"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[("pressure_i_Pa", "p_f"), ("presliding_volume_m3", "V_s")]
    }

    fn changed_relation(&self, site: &Site) -> String {
        format!("piston of {}", relation::named(site))
    }

    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        Some(self)
    }
}

impl ActsOn<Strut> for AccumulatorPistonFriction {
    fn equation(&self) -> Equation {
        TermId::AccumulatorPistonFriction.equation()
    }

    fn candidates(&self, model: &StrutModel, _excitation: &excitation::Strut) -> Vec<Candidate> {
        if model.effects.accumulator_piston_friction.is_some() {
            return vec![];
        }
        Branch::ALL
            .map(|branch| {
                let i = branch.number();
                let parameters = vec![
                    Parameter::amount(format!("pressure_{i}_Pa"), 1e4, 3e6),
                    Parameter::log("presliding_volume_m3", 3e-7, (1e-8, 2e-5)),
                ];
                Candidate::new(self.id(), Site::Accumulator(branch), parameters).starting_at(vec![vec![1e5, 5e-7]])
            })
            .to_vec()
    }

    fn put(&self, model: &mut StrutModel, candidate: &Candidate, values: &[f64]) {
        let none = Term {
            pressure_1_pa: 0.0,
            pressure_2_pa: 0.0,
            presliding_volume_m3: values[1],
        };
        let term = model.effects.accumulator_piston_friction.get_or_insert(none);
        term.presliding_volume_m3 = values[1];
        *match candidate.place.branch() {
            Some(Branch::Second) => &mut term.pressure_2_pa,
            _ => &mut term.pressure_1_pa,
        } = values[0];
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "a triangle of 10 mm at 5 mm/s, all valves open, force and all pressures recorded",
            shows: "gives a hysteresis in p1 and in the pressure of its accumulator, not in the force alone",
        }
    }
}

impl Concealed for AccumulatorPistonFriction {
    fn variants(&self) -> usize {
        2
    }

    fn amounts(&self, _variant: usize) -> Option<(f64, f64)> {
        Some((100.0, 5e5))
    }

    fn put_true(&self, model: &mut StrutModel, drawn: &Drawn, amount: f64) -> Vec<TrueNumber> {
        let volume = libm::exp(drawn.between(0, libm::log(1e-7), libm::log(2e-6)));
        let [first, second] = drawn.in_its_branch(amount);
        model.effects.accumulator_piston_friction = Some(Term {
            pressure_1_pa: first,
            pressure_2_pa: second,
            presliding_volume_m3: volume,
        });
        let branch = drawn.branch();
        let key = format!("pressure_{}_Pa", branch.number());
        vec![
            TrueNumber::new(Site::Accumulator(branch), key, amount),
            TrueNumber::new(Site::Accumulator(branch), "presliding_volume_m3", volume),
        ]
    }
}
