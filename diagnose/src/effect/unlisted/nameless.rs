//! The effect `unlisted`: a law that has no name in the vocabulary.

use oleo_plant_sim::strut::{Equation, StrutModel, TermId};

use super::words::NamelessLaw;
use super::{
    believed_numbers, co_simulation_laws, cylinder_laws, gas_spring_laws, mechanism_laws, strut_laws, textbook,
    unfamiliar,
};
use crate::effect::candidate::Candidate;
use crate::effect::contract::{
    ActsOn, CoSimulation, Concealed, Cylinder, Effect, Experiment, GasSpring, Mechanism, Strut, StrutEffect,
};
use crate::effect::drawn::{Drawn, TrueNumber};
use crate::excitation;
use crate::vocabulary::{EffectId, SpecimenKind};

/// Laws that the vocabulary has no name for.
pub struct Unlisted;

impl Effect for Unlisted {
    fn id(&self) -> EffectId {
        EffectId::Unlisted
    }

    fn name(&self) -> &'static str {
        "a law without a name in the vocabulary"
    }

    fn meaning(&self) -> &'static str {
        "the law is a table that was fitted to the recordings"
    }

    fn meaning_in(&self, kind: SpecimenKind, label: &str) -> &'static str {
        let of_number = match kind {
            SpecimenKind::TwoStageStrut => believed_numbers::meaning(label),
            _ => None,
        };
        of_number.unwrap_or(self.meaning())
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        &[]
    }

    fn named(&self, kind: SpecimenKind, label: &str) -> &'static str {
        words(kind, label).map_or(self.name(), |law| law.name)
    }

    fn called(&self, kind: SpecimenKind, label: &str) -> String {
        // The labels of tables say what they relate.
        if label.contains(" over ") {
            format!("a law without a name in the vocabulary ({label})")
        } else {
            self.named(kind, label).to_owned()
        }
    }

    fn equation_in(&self, kind: SpecimenKind, label: &str) -> Option<Equation> {
        let tabulated = TermId::Unlisted.equation();
        Some(match kind {
            SpecimenKind::TwoStageStrut if words(kind, label).is_none() => {
                strut_laws::closed(label).map_or(tabulated, |closed| Equation {
                    text: closed.equation,
                    source: tabulated.source,
                })
            }
            _ => words(kind, label).map_or(tabulated, |law| law.equation),
        })
    }

    fn symbol_in(&self, kind: SpecimenKind, label: &str, key: &str) -> Option<&'static str> {
        match kind {
            SpecimenKind::TwoStageStrut => believed_numbers::symbol(label).or_else(|| strut_laws::symbol(label, key)),
            _ => self.symbol(key),
        }
    }

    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        Some(self)
    }

    fn in_gas_spring(&self) -> Option<&dyn ActsOn<GasSpring>> {
        Some(&gas_spring_laws::Laws)
    }

    fn in_cylinder(&self) -> Option<&dyn ActsOn<Cylinder>> {
        Some(&cylinder_laws::Laws)
    }

    fn in_mechanism(&self) -> Option<&dyn ActsOn<Mechanism>> {
        Some(&mechanism_laws::Laws)
    }

    fn in_co_simulation(&self) -> Option<&dyn ActsOn<CoSimulation>> {
        Some(&co_simulation_laws::Laws)
    }
}

/// Words of a law of one number or of a wrong number; `None` for a table, which the laws of struts and of somebody else's models are.
fn words(kind: SpecimenKind, label: &str) -> Option<NamelessLaw> {
    match kind {
        SpecimenKind::TwoStageStrut => believed_numbers::words(label),
        SpecimenKind::CoSimulation => None,
        SpecimenKind::GasSpring => gas_spring_laws::words(label),
        SpecimenKind::Cylinder => cylinder_laws::words(label),
        SpecimenKind::Damper | SpecimenKind::Drive => mechanism_laws::words(label),
    }
}

impl ActsOn<Strut> for Unlisted {
    fn equation(&self) -> Equation {
        TermId::Unlisted.equation()
    }

    fn candidates(&self, model: &StrutModel, excitation: &excitation::Strut) -> Vec<Candidate> {
        let laws = strut_laws::candidates(excitation.duration_s);
        believed_numbers::candidates(model).chain(laws).collect()
    }

    fn put(&self, model: &mut StrutModel, candidate: &Candidate, values: &[f64]) {
        if !believed_numbers::put(model, &candidate.label, values) {
            let law = strut_laws::table(&candidate.label, values);
            model.effects.unlisted.extend(law);
        }
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "triangles of 20 and 80 mm, each at 5 mm/s and at 0.5 m/s, in all four states of valves 1 and 3, valve 2 open",
            shows: "depends on the quantity of its table, whatever else is changed",
        }
    }
}

impl Concealed for Unlisted {
    fn variants(&self) -> usize {
        textbook::COUNT
    }

    fn amounts(&self, _variant: usize) -> Option<(f64, f64)> {
        Some((1e-5, 1.0))
    }

    fn put_true(&self, model: &mut StrutModel, drawn: &Drawn, amount: f64) -> Vec<TrueNumber> {
        believed_numbers::put_true(model, drawn, amount).unwrap_or_else(|| {
            let (law, numbers) = unfamiliar::law(drawn, amount).unwrap_or_else(|| textbook::law(drawn, amount));
            model.effects.unlisted.push(law);
            numbers
        })
    }
}
