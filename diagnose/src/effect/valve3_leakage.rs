//! Leakage of oil through the closed valve 3.

use oleo_interface::Valve;
use oleo_plant_sim::strut::{Equation, StrutModel, TermId, Valve3Leakage as Term};

use super::candidate::Candidate;
use super::contract::{ActsOn, Concealed, Effect, Experiment, Strut, StrutEffect};
use super::drawn::{Drawn, TrueNumber};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::{EffectId, Site};

/// Time for which valve 3 must hold a pressure difference before a leak can be seen, s.
const LEAST_HOLDING_S: f64 = 0.5;

/// Largest leak over the flow coefficient of the open valve: one that does not close at all, with a margin for what is believed
/// of the open one.
const LARGEST_OVER_OPEN: f64 = 1.5;

pub struct Valve3Leakage;

impl Effect for Valve3Leakage {
    fn id(&self) -> EffectId {
        EffectId::Valve3Leakage
    }

    fn name(&self) -> &'static str {
        "leakage through the closed valve"
    }

    fn meaning(&self) -> &'static str {
        "oil leaks through the closed valve with the flow coefficient c"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[("flow_coefficient", "c")]
    }

    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        Some(self)
    }
}

impl ActsOn<Strut> for Valve3Leakage {
    fn equation(&self) -> Equation {
        TermId::Valve3Leakage.equation()
    }

    fn candidates(&self, model: &StrutModel, excitation: &excitation::Strut) -> Vec<Candidate> {
        if model.effects.valve3_leakage.is_some() {
            return vec![];
        }
        let cannot = (excitation.valve3_holding_s < LEAST_HOLDING_S).then(|| {
            "valve 3 is never closed against a pressure difference; close it at 30 mm of jounce and hold 5 s".to_owned()
        });
        let most = LARGEST_OVER_OPEN * model.valve[Valve::Spring.index()].total_flow_coefficient();
        let leak = Parameter::amount("flow_coefficient", 1e-10, most);
        vec![Candidate::new(self.id(), Site::Valve(Valve::Spring), vec![leak]).testable_unless(cannot)]
    }

    fn put(&self, model: &mut StrutModel, _candidate: &Candidate, values: &[f64]) {
        model.effects.valve3_leakage = Some(Term {
            flow_coefficient: values[0],
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "valve 3 closed at rest, a step to 30 mm at 0.1 m/s held for 60 s, valves 1 and 2 open",
            shows: "lets p3 and p4 approach each other until they are equal",
        }
    }
}

impl Concealed for Valve3Leakage {
    fn amounts(&self, _variant: usize) -> Option<(f64, f64)> {
        Some((1e-13, 2e-6))
    }

    fn put_true(&self, model: &mut StrutModel, _drawn: &Drawn, amount: f64) -> Vec<TrueNumber> {
        model.effects.valve3_leakage = Some(Term {
            flow_coefficient: amount,
        });
        vec![TrueNumber::new(Site::Valve(Valve::Spring), "flow_coefficient", amount)]
    }
}
