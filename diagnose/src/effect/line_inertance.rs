//! The oil column in line 2 has mass.

use oleo_plant_sim::strut::{Equation, LineInertance as Term, StrutModel, TermId};

use super::candidate::Candidate;
use super::contract::{ActsOn, Concealed, Effect, Experiment, Strut, StrutEffect};
use super::drawn::{Drawn, TrueNumber};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::{Branch, EffectId, Site};

pub struct LineInertance;

impl Effect for LineInertance {
    fn id(&self) -> EffectId {
        EffectId::LineInertance
    }

    fn name(&self) -> &'static str {
        "mass of the oil column in a line"
    }

    fn meaning(&self) -> &'static str {
        "the mass of the oil column causes a pressure drop in series with the damper pack, which is proportional to the rate of change of the flow; I is the inertance"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[("inertance_2_kg_m4", "I")]
    }

    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        Some(self)
    }
}

impl ActsOn<Strut> for LineInertance {
    fn equation(&self) -> Equation {
        TermId::LineInertance.equation()
    }

    fn candidates(&self, model: &StrutModel, excitation: &excitation::Strut) -> Vec<Candidate> {
        if model.effects.line_inertance.is_some() {
            return vec![];
        }
        let inertance = Parameter::amount("inertance_2_kg_m4", 1e6, 1e9);
        let candidate = Candidate::new(self.id(), Site::Path(Branch::Second), vec![inertance]);
        vec![candidate.testable_unless(excitation.no_drop(Branch::Second))]
    }

    fn put(&self, model: &mut StrutModel, _candidate: &Candidate, values: &[f64]) {
        model.effects.line_inertance = Some(Term {
            inertance_2_kg_m4: values[0],
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "sines of 5 mm at 0.1, 0.3 and 0.6 m/s, all valves open",
            shows: "adds a pressure drop that leads the flow by a quarter of a period and grows with the square of the frequency",
        }
    }
}

impl Concealed for LineInertance {
    fn amounts(&self, _variant: usize) -> Option<(f64, f64)> {
        Some((1e3, 2e7))
    }

    fn put_true(&self, model: &mut StrutModel, _drawn: &Drawn, amount: f64) -> Vec<TrueNumber> {
        model.effects.line_inertance = Some(Term {
            inertance_2_kg_m4: amount,
        });
        vec![TrueNumber::new(Site::Path(Branch::Second), "inertance_2_kg_m4", amount)]
    }
}
