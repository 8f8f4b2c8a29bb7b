//! A line in series with a damper has a further viscous loss.

use oleo_plant_sim::strut::{Equation, LineResistance as Term, StrutModel, TermId};

use super::candidate::Candidate;
use super::contract::{ActsOn, Concealed, Effect, Experiment, Strut, StrutEffect};
use super::drawn::{Drawn, TrueNumber};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::{Branch, EffectId, Site};

pub struct LineResistance;

impl Effect for LineResistance {
    fn id(&self) -> EffectId {
        EffectId::LineResistance
    }

    fn name(&self) -> &'static str {
        "viscous loss in a line"
    }

    fn meaning(&self) -> &'static str {
        "viscous flow causes a pressure drop in series with the damper pack; R is the hydraulic resistance"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[("resistance_i_Pa_s_m3", "R")]
    }

    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        Some(self)
    }
}

impl ActsOn<Strut> for LineResistance {
    fn equation(&self) -> Equation {
        TermId::LineResistance.equation()
    }

    fn candidates(&self, model: &StrutModel, excitation: &excitation::Strut) -> Vec<Candidate> {
        if model.effects.line_resistance.is_some() {
            return vec![];
        }
        Branch::ALL
            .map(|branch| {
                let i = branch.number();
                let parameters = vec![Parameter::amount(format!("resistance_{i}_Pa_s_m3"), 3e7, 1e11)];
                Candidate::new(self.id(), Site::Path(branch), parameters).testable_unless(excitation.no_drop(branch))
            })
            .to_vec()
    }

    fn put(&self, model: &mut StrutModel, candidate: &Candidate, values: &[f64]) {
        let none = Term {
            resistance_1_pa_s_m3: 0.0,
            resistance_2_pa_s_m3: 0.0,
        };
        let term = model.effects.line_resistance.get_or_insert(none);
        *match candidate.place.branch() {
            Some(Branch::Second) => &mut term.resistance_2_pa_s_m3,
            _ => &mut term.resistance_1_pa_s_m3,
        } = values[0];
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "sines of 25 mm at 0.05, 0.2 and 0.8 m/s, all valves open",
            shows: "adds a pressure drop that is proportional to the speed, even with the valves open",
        }
    }
}

impl Concealed for LineResistance {
    fn variants(&self) -> usize {
        2
    }

    fn amounts(&self, _variant: usize) -> Option<(f64, f64)> {
        Some((1e4, 3e9))
    }

    fn put_true(&self, model: &mut StrutModel, drawn: &Drawn, amount: f64) -> Vec<TrueNumber> {
        let [first, second] = drawn.in_its_branch(amount);
        model.effects.line_resistance = Some(Term {
            resistance_1_pa_s_m3: first,
            resistance_2_pa_s_m3: second,
        });
        let branch = drawn.branch();
        let key = format!("resistance_{}_Pa_s_m3", branch.number());
        vec![TrueNumber::new(Site::Path(branch), key, amount)]
    }
}
