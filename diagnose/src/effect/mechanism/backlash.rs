//! A gap in a joint.

use oleo_plant_sim::specimen::{Backlash as Term, MechanismEffects};
use oleo_plant_sim::strut::Equation;

use crate::effect::candidate::Candidate;
use crate::effect::contract::{ActsOn, Effect, Experiment, Mechanism};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::EffectId;

pub struct Backlash;

impl Effect for Backlash {
    fn id(&self) -> EffectId {
        EffectId::Backlash
    }

    fn name(&self) -> &'static str {
        "backlash"
    }

    fn meaning(&self) -> &'static str {
        "what is behind a gap of the width b, at y, follows the part at x only when it touches a side of the gap"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[("gap_m", "b")]
    }

    fn in_mechanism(&self) -> Option<&dyn ActsOn<Mechanism>> {
        Some(self)
    }
}

impl ActsOn<Mechanism> for Backlash {
    fn equation(&self) -> Equation {
        Term::EQUATION
    }

    fn candidates(&self, model: &MechanismEffects, excitation: &excitation::Mechanism) -> Vec<Candidate> {
        if model.backlash.is_some() {
            return vec![];
        }
        let stroke = excitation.stroke_m;
        let gap = Parameter::amount("gap_m", 0.002 * stroke, 0.3 * stroke);
        let starts = [0.005, 0.05].map(|part| vec![part * stroke]).to_vec();
        vec![
            Candidate::new(self.id(), excitation.site.clone(), vec![gap])
                .starting_at(starts)
                .testable_unless(excitation.one_way.clone()),
        ]
    }

    fn put(&self, model: &mut MechanismEffects, _candidate: &Candidate, values: &[f64]) {
        model.backlash = Some(Term { gap_m: values[0] });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "triangles of a tenth and all of the stroke, at two speeds",
            shows: "moves without effect over the same displacement after each reversal, at every amplitude and speed",
        }
    }
}
