//! The response time of the valves depends on the pressure difference.

use oleo_plant_sim::strut::{Equation, StrutModel, TermId, ValveDelay as Term};

use super::candidate::Candidate;
use super::contract::{ActsOn, Concealed, Effect, Experiment, ShowsIn, Strut, StrutEffect};
use super::drawn::{Drawn, TrueNumber};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::{EffectId, Site};

pub struct ValveDelay;

impl Effect for ValveDelay {
    fn id(&self) -> EffectId {
        EffectId::ValveDelay
    }

    fn name(&self) -> &'static str {
        "pressure-dependent valve response time"
    }

    fn meaning(&self) -> &'static str {
        "the equation gives the response time in s; dP is the pressure difference across the valve at the switching edge in MPa"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[("c0_s", "c0"), ("c1_s_MPa", "c1"), ("c2_s_MPa2", "c2")]
    }

    fn shows_in(&self) -> ShowsIn {
        ShowsIn::EveryChannel
    }

    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        Some(self)
    }
}

impl ActsOn<Strut> for ValveDelay {
    fn equation(&self) -> Equation {
        TermId::ValveDelay.equation()
    }

    fn candidates(&self, model: &StrutModel, excitation: &excitation::Strut) -> Vec<Candidate> {
        // A model whose own response depends on the pressure has the effect already.
        let polynomial = &model.valve_timing.response_polynomial_s;
        if model.effects.valve_delay.is_some() || polynomial.iter().skip(1).any(|c| *c != 0.0) {
            return vec![];
        }
        let parameters = vec![
            Parameter::linear("c0_s", polynomial[0], 0.005, (0.0, 0.5)),
            Parameter::linear("c1_s_MPa", 0.0, 0.002, (-0.05, 0.05)),
            Parameter::linear("c2_s_MPa2", 0.0, 2e-4, (-0.005, 0.005)),
        ];
        vec![Candidate::new(self.id(), Site::Valves, parameters).testable_unless(excitation.no_edges())]
    }

    fn put(&self, model: &mut StrutModel, _candidate: &Candidate, values: &[f64]) {
        model.effects.valve_delay = Some(Term {
            response_polynomial_s: [values[0], values[1], values[2]],
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "steps of each valve at pressure differences of 0.2, 2 and 6 MPa (30 mm at 0.02, 0.1 and 0.3 m/s before the edge), sampled at 1 kHz or faster",
            shows: "delays the response by a time that depends on the pressure difference",
        }
    }
}

impl Concealed for ValveDelay {
    fn amounts(&self, _variant: usize) -> Option<(f64, f64)> {
        Some((1e-3, 4.0))
    }

    fn conceal(&self, given: &mut StrutModel) {
        given.valve_timing.response_polynomial_s.truncate(1);
    }

    fn put_true(&self, model: &mut StrutModel, drawn: &Drawn, amount: f64) -> Vec<TrueNumber> {
        let [constant, linear, square] = drawn.response;
        let polynomial = [constant, amount * linear, amount * square];
        model.effects.valve_delay = Some(Term {
            response_polynomial_s: polynomial,
        });
        vec![
            TrueNumber::new(Site::Valves, "c1_s_MPa", polynomial[1]),
            TrueNumber::new(Site::Valves, "c0_s", polynomial[0]),
            TrueNumber::new(Site::Valves, "c2_s_MPa2", polynomial[2]),
        ]
    }
}
