//! Contact with a stop near an end of travel.

use oleo_plant_sim::strut::{BumpStop as Term, Equation, StrutModel, TermId};

use super::candidate::Candidate;
use super::contract::{ActsOn, Concealed, Effect, Experiment, Strut, StrutEffect};
use super::drawn::{Drawn, TrueNumber};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::{EffectId, Site};

/// Variant with a stop at the jounce end only.
const JOUNCE: usize = 0;
/// Variant with a stop at the rebound end only; the third has both.
const REBOUND: usize = 1;
/// Clearance of a stop that is never touched, m.
const FAR_M: f64 = 1.0;

pub struct BumpStop;

impl Effect for BumpStop {
    fn id(&self) -> EffectId {
        EffectId::BumpStop
    }

    fn name(&self) -> &'static str {
        "contact with a stop"
    }

    fn meaning(&self) -> &'static str {
        "the stop acts beyond its clearance; d is the travel beyond it"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[
            ("stiffness_N_m", "k"),
            ("progression_N_m3", "c"),
            ("bump_clearance_m", ""),
            ("rebound_clearance_m", ""),
        ]
    }

    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        Some(self)
    }
}

impl ActsOn<Strut> for BumpStop {
    fn equation(&self) -> Equation {
        TermId::BumpStop.equation()
    }

    fn candidates(&self, model: &StrutModel, excitation: &excitation::Strut) -> Vec<Candidate> {
        if model.effects.bump_stop.is_some() {
            return vec![];
        }
        let (low, high) = excitation.displacement_m;
        let (low, high) = ((-low).max(1e-3), high.max(1e-3));
        let parameters = vec![
            Parameter::linear("bump_clearance_m", 0.85 * high, 0.05 * high, (0.2 * high, 1.2 * high)),
            Parameter::linear("rebound_clearance_m", 0.85 * low, 0.05 * low, (0.2 * low, 1.2 * low)),
            Parameter::amount("stiffness_N_m", 1e4, 1e8),
            Parameter::amount("progression_N_m3", 1e8, 1e13),
        ];
        let at = |a: f64, b: f64| vec![a * high, b * low, 0.0, 0.0];
        let starts = vec![
            at(0.7, 0.7),
            at(0.5, 1.1),
            at(1.1, 0.5),
            at(0.6, 0.95),
            at(0.9, 1.1),
            at(1.1, 0.9),
        ];
        vec![Candidate::new(self.id(), Site::EndStop, parameters).starting_at(starts)]
    }

    fn put(&self, model: &mut StrutModel, _candidate: &Candidate, values: &[f64]) {
        model.effects.bump_stop = Some(Term {
            bump_clearance_m: values[0],
            rebound_clearance_m: values[1],
            stiffness_n_m: values[2],
            progression_n_m3: values[3],
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "a triangle over the whole travel at 5 mm/s and at 0.2 m/s, all valves open",
            shows: "adds a force beyond one displacement only, the same at both speeds",
        }
    }
}

impl Concealed for BumpStop {
    fn variants(&self) -> usize {
        3
    }

    fn amounts(&self, _variant: usize) -> Option<(f64, f64)> {
        Some((100.0, 5e6))
    }

    fn put_true(&self, model: &mut StrutModel, drawn: &Drawn, amount: f64) -> Vec<TrueNumber> {
        // At the jounce end, at the rebound end, or both; all within the travel of the moves.
        let bump = if drawn.variant == REBOUND {
            FAR_M
        } else {
            drawn.between(0, 0.05, 0.075)
        };
        let rebound = if drawn.variant == JOUNCE {
            FAR_M
        } else {
            drawn.between(1, 0.05, 0.075)
        };
        let progression = amount * drawn.between(2, 0.0, 4e3);
        model.effects.bump_stop = Some(Term {
            bump_clearance_m: bump,
            rebound_clearance_m: rebound,
            stiffness_n_m: amount,
            progression_n_m3: progression,
        });
        let number = |key: &str, value| TrueNumber::new(Site::EndStop, key, value);
        let mut all = vec![number("stiffness_N_m", amount)];
        if drawn.variant != REBOUND {
            all.push(number("bump_clearance_m", bump));
        }
        if drawn.variant != JOUNCE {
            all.push(number("rebound_clearance_m", rebound));
        }
        all.push(number("progression_N_m3", progression));
        all
    }
}
