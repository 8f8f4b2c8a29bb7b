//! Friction that grows with the force of the strut, or with the pressure of a cylinder.

use oleo_plant_sim::specimen::{CylinderEffects, CylinderModel};
use oleo_plant_sim::strut::{Equation, SideLoadFriction as Term, StrutModel, TermId};

use super::candidate::Candidate;
use super::contract::{ActsOn, Concealed, Cylinder, Effect, Experiment, Strut, StrutEffect};
use super::drawn::{Drawn, TrueNumber};
use super::seal_friction::seal;
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::{EffectId, Site};

pub struct SideLoadFriction;

impl Effect for SideLoadFriction {
    fn id(&self) -> EffectId {
        EffectId::SideLoadFriction
    }

    fn name(&self) -> &'static str {
        "load-dependent friction"
    }

    fn meaning(&self) -> &'static str {
        "the load that presses on the seal or bends the rod causes friction, which decreases as the overlap of the guides grows"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[("coefficient", "mu"), ("overlap_growth_1_m", "s")]
    }

    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        Some(self)
    }

    fn in_cylinder(&self) -> Option<&dyn ActsOn<Cylinder>> {
        Some(self)
    }
}

impl ActsOn<Strut> for SideLoadFriction {
    fn equation(&self) -> Equation {
        TermId::SideLoadFriction.equation()
    }

    fn candidates(&self, model: &StrutModel, _excitation: &excitation::Strut) -> Vec<Candidate> {
        if model.effects.side_load_friction.is_some() {
            return vec![];
        }
        let parameters = vec![
            Parameter::amount("coefficient", 0.003, 0.5),
            Parameter::linear("overlap_growth_1_m", 0.0, 1.0, (-4.0, 6.0)),
        ];
        vec![Candidate::new(self.id(), Site::MainSeal, parameters)]
    }

    fn put(&self, model: &mut StrutModel, _candidate: &Candidate, values: &[f64]) {
        model.effects.side_load_friction = Some(Term {
            coefficient: values[0],
            overlap_growth_1_m: values[1],
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "the same triangle of 10 mm at 5 mm/s about -60, 0 and 60 mm, all valves open, force and p1 recorded",
            shows: "gives a hysteresis in the force only, which is wider where the force is larger",
        }
    }
}

impl Concealed for SideLoadFriction {
    fn amounts(&self, _variant: usize) -> Option<(f64, f64)> {
        Some((1e-5, 0.2))
    }

    fn put_true(&self, model: &mut StrutModel, _drawn: &Drawn, amount: f64) -> Vec<TrueNumber> {
        model.effects.side_load_friction = Some(Term {
            coefficient: amount,
            overlap_growth_1_m: 0.0,
        });
        vec![TrueNumber::new(Site::MainSeal, "coefficient", amount)]
    }
}

impl ActsOn<Cylinder> for SideLoadFriction {
    fn equation(&self) -> Equation {
        CylinderEffects::SIDE_LOAD_FRICTION
    }

    fn candidates(&self, model: &CylinderModel, excitation: &excitation::Cylinder) -> Vec<Candidate> {
        if model.effects.side_load_friction.is_some() {
            return vec![];
        }
        let (force, pressing) = (excitation.force_n, excitation.pressing_n);
        let coefficient = Parameter::linear(
            "coefficient",
            0.02 * force / pressing,
            0.01 * force / pressing,
            (0.0, 1.0),
        );
        let candidate = Candidate::new(self.id(), Site::MainSeal, vec![coefficient]);
        vec![candidate.testable_unless(excitation.one_pressure.clone())]
    }

    fn put(&self, model: &mut CylinderModel, _candidate: &Candidate, values: &[f64]) {
        model.effects.side_load_friction = Some(Term {
            coefficient: values[0],
            overlap_growth_1_m: 0.0,
        });
        // Friction shears a seal, whichever part of it there is.
        seal(model);
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "strokes of full travel at a tenth and at ten times the speed, each at the lowest and the highest pressure",
            shows: "gives a force against the motion that grows with the pressure at every speed",
        }
    }
}
