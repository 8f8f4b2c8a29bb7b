//! The valves open gradually, not in a step.

use oleo_plant_sim::strut::{Equation, StrutModel, TermId, TransitionShape, ValveTransition as Term};

use super::candidate::Candidate;
use super::contract::{ActsOn, Concealed, Effect, Experiment, ShowsIn, Strut, StrutEffect};
use super::drawn::{Drawn, TrueNumber};
use crate::excitation;
use crate::vocabulary::{EffectId, Site};

pub struct ValveTransition;

impl Effect for ValveTransition {
    fn id(&self) -> EffectId {
        EffectId::ValveTransition
    }

    fn name(&self) -> &'static str {
        "gradual valve opening"
    }

    fn meaning(&self) -> &'static str {
        "the valve opens gradually instead of in one step; the opening u is the straight line through 5 % at the initial delay and 95 % at the total response time"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[]
    }

    fn shows_in(&self) -> ShowsIn {
        ShowsIn::EveryChannel
    }

    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        Some(self)
    }
}

impl ActsOn<Strut> for ValveTransition {
    fn equation(&self) -> Equation {
        TermId::ValveTransition.equation()
    }

    fn candidates(&self, model: &StrutModel, excitation: &excitation::Strut) -> Vec<Candidate> {
        if model.effects.valve_transition.is_some() {
            return vec![];
        }
        vec![Candidate::new(self.id(), Site::Valves, vec![]).testable_unless(excitation.no_edges())]
    }

    fn put(&self, model: &mut StrutModel, _candidate: &Candidate, _values: &[f64]) {
        model.effects.valve_transition = Some(Term {
            shape: TransitionShape::Linear,
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "steps of each valve at pressure differences of 0.2, 2 and 6 MPa (30 mm at 0.02, 0.1 and 0.3 m/s before the edge), sampled at 1 kHz or faster",
            shows: "spreads every pressure step over the time in which the valve moves",
        }
    }
}

impl Concealed for ValveTransition {
    fn amounts(&self, _variant: usize) -> Option<(f64, f64)> {
        None
    }

    fn conceal(&self, given: &mut StrutModel) {
        given.effects.valve_transition = None;
    }

    fn put_true(&self, model: &mut StrutModel, _drawn: &Drawn, _amount: f64) -> Vec<TrueNumber> {
        model.effects.valve_transition = Some(Term {
            shape: TransitionShape::Linear,
        });
        vec![TrueNumber::present(Site::Valves)]
    }
}
