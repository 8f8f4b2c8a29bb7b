//! The oil of the main chamber has a finite bulk modulus.

use oleo_plant_sim::strut::{Equation, OilCompressibility as Term, OilCount, StrutModel, TermId};

use super::candidate::Candidate;
use super::contract::{ActsOn, Concealed, Effect, Experiment, Strut, StrutEffect};
use super::drawn::{Drawn, TrueNumber};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::{EffectId, Site};

/// Compressibility at which the oil would be a hundred times stiffer than any oil is, 1/Pa: division by zero is avoided.
const LEAST_COMPRESSIBILITY: f64 = 1e-13;

pub struct OilCompressibility;

impl Effect for OilCompressibility {
    fn id(&self) -> EffectId {
        EffectId::OilCompressibility
    }

    fn name(&self) -> &'static str {
        "oil compressibility"
    }

    fn meaning(&self) -> &'static str {
        "the oil column between piston and dampers acts as a spring; beta is the bulk modulus"
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[("bulk_modulus_Pa", "beta")]
    }

    fn told_from(&self, rival: EffectId) -> Option<&'static str> {
        match rival {
            EffectId::MountCompliance => Some(
                "sines of 5 mm at 0.5 m/s with all valves closed, once about the static position and once about 60 mm of jounce: \
                 the mount has the same stiffness at both positions, the oil column is stiffer at the second",
            ),
            EffectId::EntrainedAir => Some(
                "a sawtooth from -80 mm to 60 mm at 5 mm/s, valve 3 closed, valves 1 and 2 open: air has an effect below 1 MPa only",
            ),
            _ => None,
        }
    }

    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        Some(self)
    }
}

impl ActsOn<Strut> for OilCompressibility {
    fn equation(&self) -> Equation {
        TermId::OilCompressibility.equation()
    }

    fn candidates(&self, model: &StrutModel, _excitation: &excitation::Strut) -> Vec<Candidate> {
        if model.effects.oil_compressibility.is_some() {
            return vec![];
        }
        let compressibility = Parameter::amount("compressibility_1_Pa", 1e-10, 2e-8);
        vec![Candidate::new(
            self.id(),
            Site::MainChamber,
            vec![compressibility.shown_as_inverse("bulk_modulus_Pa")],
        )]
    }

    fn put(&self, model: &mut StrutModel, _candidate: &Candidate, values: &[f64]) {
        model.effects.oil_compressibility = Some(Term {
            bulk_modulus_pa: 1.0 / values[0].max(LEAST_COMPRESSIBILITY),
            counted_at: OilCount::default(),
        });
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "sines of 5 mm at 0.5 m/s with all valves closed, about the static position and about 60 mm of jounce",
            shows: "gives the trapped oil a stiffness that rises as its column shortens",
        }
    }
}

impl Concealed for OilCompressibility {
    fn amounts(&self, _variant: usize) -> Option<(f64, f64)> {
        Some((1e-13, 1.0 / 0.8e9))
    }

    fn conceal(&self, given: &mut StrutModel) {
        given.effects.oil_compressibility = None;
    }

    fn put_true(&self, model: &mut StrutModel, _drawn: &Drawn, amount: f64) -> Vec<TrueNumber> {
        model.effects.oil_compressibility = Some(Term {
            bulk_modulus_pa: 1.0 / amount,
            counted_at: OilCount::Chamber,
        });
        vec![TrueNumber::new(Site::MainChamber, "bulk_modulus_Pa", 1.0 / amount)]
    }
}
