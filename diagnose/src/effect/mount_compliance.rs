//! The mount gives way, so the strut moves less than the actuator.

use oleo_plant_sim::strut::{Equation, MountCompliance as Term, StrutModel, TermId};

use super::candidate::Candidate;
use super::contract::{ActsOn, Concealed, Effect, Experiment, ShowsIn, Strut, StrutEffect};
use super::drawn::{Drawn, TrueNumber};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::{EffectId, Site};

/// Compliance of a mount that is stiffer than any is, m/N: division by zero is avoided.
const LEAST_COMPLIANCE_M_N: f64 = 1e-15;

pub struct MountCompliance;

impl Effect for MountCompliance {
    fn id(&self) -> EffectId {
        EffectId::MountCompliance
    }

    fn name(&self) -> &'static str {
        "compliance"
    }

    fn meaning(&self) -> &'static str {
        "the mount yields, so the strut moves less than the actuator"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[("stiffness_N_m", "k")]
    }

    fn shows_in(&self) -> ShowsIn {
        ShowsIn::EveryChannel
    }

    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        Some(self)
    }
}

impl ActsOn<Strut> for MountCompliance {
    fn equation(&self) -> Equation {
        TermId::MountCompliance.equation()
    }

    fn candidates(&self, model: &StrutModel, _excitation: &excitation::Strut) -> Vec<Candidate> {
        if model.effects.mount_compliance.is_some() {
            return vec![];
        }
        let compliance = Parameter::amount("compliance_m_N", 1e-8, 1e-4).shown_as_inverse("stiffness_N_m");
        vec![Candidate::new(self.id(), Site::Mount, vec![compliance])]
    }

    fn put(&self, model: &mut StrutModel, _candidate: &Candidate, values: &[f64]) {
        model.effects.mount_compliance = Some(Term {
            stiffness_n_m: 1.0 / values[0].max(LEAST_COMPLIANCE_M_N),
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "sines of 5 mm at 0.5 m/s with all valves closed, about the static position and about 60 mm of jounce",
            shows: "yields by the same travel for the same force at both positions",
        }
    }
}

impl Concealed for MountCompliance {
    fn amounts(&self, _variant: usize) -> Option<(f64, f64)> {
        Some((1e-10, 1e-6))
    }

    fn put_true(&self, model: &mut StrutModel, _drawn: &Drawn, amount: f64) -> Vec<TrueNumber> {
        model.effects.mount_compliance = Some(Term {
            stiffness_n_m: 1.0 / amount,
        });
        vec![TrueNumber::new(Site::Mount, "stiffness_N_m", 1.0 / amount)]
    }
}
