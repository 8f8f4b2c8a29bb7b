//! Tests that hold for every effect.

use oleo_plant_sim::specimen::{CylinderModel, GasSpringModel, MechanismEffects, SmoothedMotion};
use oleo_plant_sim::strut::{Effects, Equation, StrutModel, TermId};

use strum::VariantArray;

use super::*;
use crate::correction::{Corrections, Quantity};
use crate::excitation;
use crate::parameter::Shown;
use crate::recording::Recording;
use crate::vocabulary::{Column, EffectId, Site, SpecimenKind};

fn bare_strut() -> StrutModel {
    let mut model = StrutModel::defender110(8000.0);
    model.effects = Effects::default();
    model.valve_timing.response_polynomial_s = vec![0.04];
    model
}

/// A model whose own valves respond as the report's do, from which effects are concealed.
fn complete_strut() -> StrutModel {
    let mut model = bare_strut();
    model.valve_timing.response_polynomial_s = vec![0.04, 0.002, 1e-4];
    model
}

fn recording(columns: Vec<Vec<f64>>) -> Recording {
    Recording {
        name: "strokes".into(),
        time_s: (0..200).map(|k| 0.01 * f64::from(k)).collect(),
        columns,
        notes: vec![],
    }
}

fn wave(size: f64) -> Vec<f64> {
    (0..200).map(|k| size * libm::sin(0.1 * f64::from(k))).collect()
}

/// All candidates of a damper or a drive, of which the columns of force and motion are given.
fn of_mechanism(site: Site, [force, motion]: [usize; 2], compared: Column) -> Vec<Candidate> {
    let channels = excitation::Channels {
        site,
        force,
        motion,
        compared,
        motion_noise_m: 1e-5,
        begins_with_instrument: motion == 1,
        mass_kg: if motion == 1 { 100.0 } else { 0.0 },
    };
    let mut columns = vec![wave(0.1), wave(0.1)];
    columns[force] = wave(500.0);
    let motion = SmoothedMotion {
        displacement_m: wave(0.1),
        speed_m_s: wave(1.0),
        acceleration_m_s2: wave(10.0),
    };
    let excitation = excitation::Mechanism::of(channels, &[recording(columns)], &[motion]);
    (ALL.iter().filter_map(|id| of(*id).in_mechanism()))
        .flat_map(|e| e.candidates(&MechanismEffects::default(), &excitation))
        .collect()
}

/// All candidates of a kind of specimen whose recordings excite everything.
fn candidates(kind: SpecimenKind) -> Vec<Candidate> {
    let all = ALL.iter().map(|id| of(*id));
    match kind {
        SpecimenKind::TwoStageStrut => {
            let (model, excitation) = (bare_strut(), excitation::Strut::of_everything());
            all.filter_map(Effect::in_strut)
                .flat_map(|e| e.candidates(&model, &excitation))
                .collect()
        }
        SpecimenKind::GasSpring => {
            let text = "[specimen]\nname = \"a\"\nkind = \"gas spring\"\n[chamber]\narea_m2 = 0.01\nvolume_at_zero_m3 = 0.05\n\
                        [gas]\nspecies = \"nitrogen\"\nprocess = \"adiabatic\"\ntemperature_K = 293.15\n";
            let model = GasSpringModel::from_toml(text, "model.toml").expect("a model");
            let excitation = excitation::GasSpring::of(&[recording(vec![wave(0.5), wave(1e6)])], 690.0, vec![]);
            all.filter_map(Effect::in_gas_spring)
                .flat_map(|e| e.candidates(&model, &excitation))
                .collect()
        }
        SpecimenKind::Damper => of_mechanism(Site::Damper, [1, 0], Column::FORCE),
        SpecimenKind::Drive => of_mechanism(Site::Drive, [0, 1], Column::POSITION),
        SpecimenKind::CoSimulation => {
            let reading = |name| excitation::Reading {
                column: Column::known(name),
                spread: 1.0,
            };
            let known = |quantity, range| excitation::Known {
                quantity,
                range,
                switches: false,
            };
            let excitation = excitation::CoSimulation {
                outputs: vec![reading("force_N")],
                inputs: vec![reading("x_m")],
                quantities: vec![
                    known(Quantity::Input("x_m".to_owned()), (-1.0, 1.0)),
                    known(Quantity::Time, (0.0, 60.0)),
                ],
                tunable: vec!["k".to_owned()],
                duration_s: 60.0,
                interval_s: 0.01,
            };
            all.filter_map(Effect::in_co_simulation)
                .flat_map(|e| e.candidates(&Corrections::default(), &excitation))
                .collect()
        }
        SpecimenKind::Cylinder => {
            let text =
                "[specimen]\nname = \"a\"\nkind = \"cylinder\"\n[[chamber]]\ncolumn = \"p_Pa\"\narea_m2 = 4.9e-4\n";
            let model = CylinderModel::from_toml(text, "model.toml").expect("a model");
            let motion = SmoothedMotion {
                displacement_m: wave(0.1),
                speed_m_s: wave(1.0),
                acceleration_m_s2: wave(10.0),
            };
            let recordings = [recording(vec![wave(0.1), wave(500.0), wave(1e6)])];
            let excitation = excitation::Cylinder::of(&model, &recordings, &[motion]);
            all.filter_map(Effect::in_cylinder)
                .flat_map(|e| e.candidates(&model, &excitation))
                .collect()
        }
    }
}

const KINDS: &[SpecimenKind] = <SpecimenKind as VariantArray>::VARIANTS;

/// Key under which a parameter is reported.
fn reported_key(parameter: &crate::parameter::Parameter) -> &str {
    parameter.reported_key()
}

#[test]
fn the_ids_of_effects_are_the_terms_of_plant_sim() {
    for &id in ALL {
        assert_eq!(of(id).id(), id);
        if of(id).in_strut().is_some() {
            assert!(id.as_str().parse::<TermId>().is_ok(), "{id}");
        }
    }
    for term in TermId::ALL.iter().filter(|term| **term != TermId::SensorOffset) {
        assert!(term.key().parse::<EffectId>().is_ok(), "{term}");
    }
}

#[test]
fn the_faults_that_are_tried_are_all_faults_of_instruments() {
    let mut faults: Vec<EffectId> = ALL.iter().copied().filter(|id| id.is_instrument_fault()).collect();
    let mut tried = sensor::IN_ORDER.to_vec();
    faults.sort_unstable();
    tried.sort_unstable();
    assert_eq!(faults, tried);
}

#[test]
fn every_effect_has_words_and_candidates_where_it_occurs() {
    for &id in ALL {
        let effect = of(id);
        assert!(!effect.name().is_empty() && !effect.meaning().is_empty(), "{id}");
        let mut occurs = false;
        for &kind in KINDS {
            let there = candidates(kind).iter().any(|c| c.id == id);
            occurs |= there;
            assert_eq!(effect.equation_in(kind, "").is_some(), there, "{id} in a {kind}");
            assert_eq!(effect.experiment_in(kind).is_some(), there, "{id} in a {kind}");
        }
        assert!(occurs, "{id} is a candidate nowhere");
    }
}

/// Whether a symbol stands in an equation by itself, not as a part of another symbol.
fn has_symbol(equation: Equation, symbol: &str) -> bool {
    let of_a_symbol = |c: char| c.is_alphanumeric() || c == '_';
    equation.text.match_indices(symbol).any(|(at, _)| {
        let (before, after) = (&equation.text[..at], &equation.text[at + symbol.len()..]);
        !before.ends_with(of_a_symbol) && !after.starts_with(of_a_symbol)
    })
}

#[test]
fn every_number_of_an_effect_has_a_symbol_in_its_equation() {
    for &kind in KINDS {
        for candidate in candidates(kind).iter().filter(|c| !c.is_unlisted()) {
            let effect = of(candidate.id);
            let equation = effect.equation_in(kind, "").expect("an equation");
            for key in candidate.parameters.iter().map(reported_key) {
                let symbol = effect.symbol(key);
                let symbol = symbol.unwrap_or_else(|| panic!("{}: {key} has no symbol", candidate.id));
                // There is none for where an equation begins to hold.
                assert!(
                    symbol.is_empty() || symbol.split('/').all(|part| has_symbol(equation, part)),
                    "{}: {symbol} is not in {}",
                    candidate.id,
                    equation.text
                );
            }
        }
    }
}

#[test]
fn every_number_of_a_law_without_a_name_has_a_symbol_or_the_law_is_a_table() {
    let kind = SpecimenKind::TwoStageStrut;
    let mut closed = 0;
    for candidate in candidates(kind).iter().filter(|c| c.is_unlisted()) {
        let unlisted = of(candidate.id);
        let equation = unlisted.equation_in(kind, &candidate.label).expect("an equation");
        let is_closed = equation.text.contains('=');
        closed += usize::from(is_closed);
        for key in candidate.parameters.iter().map(reported_key) {
            let symbol = unlisted.symbol_in(kind, &candidate.label, key);
            assert_eq!(symbol.is_some(), is_closed, "{}: {key}", candidate.label);
            let shown = symbol.is_none_or(|symbol| has_symbol(equation, symbol));
            assert!(shown, "{}: {key} is not in {}", candidate.label, equation.text);
        }
    }
    assert!(closed > 20, "{closed} laws are equations");
}

#[test]
fn every_pair_has_an_experiment_that_says_what_each_of_the_two_does() {
    for &kind in KINDS {
        let all = candidates(kind);
        for (k, a) in all.iter().enumerate() {
            for b in &all[k + 1..] {
                let text = crate::experiment::separate(kind, a, b);
                assert!(text.contains(&a.name()) && text.contains(&b.name()), "{text}");
                assert!(a.name() != b.name(), "{text}");
                assert!(!text.contains("do not occur"), "{text}");
                if a.is_believed_number || b.is_believed_number {
                    assert!(text.contains("measure the "), "{text}");
                } else if kind == SpecimenKind::TwoStageStrut {
                    // Slow moves are given in mm/s.
                    let speed = text.contains(" m/s") || text.contains(" mm/s");
                    assert!(speed && text.contains(" mm") && text.contains("valve"), "{text}");
                }
                let (one, other) = (of(a.id).experiment_in(kind), of(b.id).experiment_in(kind));
                if a.id != b.id {
                    assert_ne!(one.map(|e| e.shows), other.map(|e| e.shows), "{text}");
                }
            }
        }
    }
}

/// Values of a candidate's parameters that are there and differ from each other.
fn some_values(candidate: &Candidate) -> Vec<f64> {
    (candidate.parameters.iter().zip(1..))
        .map(|(p, k)| p.value(0.3 + 0.1 * f64::from(k)))
        .collect()
}

#[test]
fn what_is_put_into_a_model_is_read_back_from_its_file() {
    for candidate in candidates(SpecimenKind::TwoStageStrut) {
        let effect = of(candidate.id).in_strut().expect("an effect of struts");
        let mut model = bare_strut();
        effect.put(&mut model, &candidate, &some_values(&candidate));
        let term: TermId = candidate.id.as_str().parse().expect("a term");
        // A number that is other than believed is no term.
        assert_eq!(
            model.effects.has(term),
            !candidate.is_believed_number,
            "{}",
            candidate.name()
        );
        let read = StrutModel::from_toml(&model.to_toml(), "model.toml");
        assert_eq!(read.as_ref(), Ok(&model), "{}", candidate.name());
    }
}

/// The same for dampers and drives.
#[test]
fn what_is_put_into_a_mechanism_is_read_back_from_its_file() {
    for kind in [SpecimenKind::Damper, SpecimenKind::Drive] {
        for candidate in candidates(kind) {
            let effect = of(candidate.id).in_mechanism().expect("an effect of mechanisms");
            let mut model = MechanismEffects::default();
            effect.put(&mut model, &candidate, &some_values(&candidate));
            assert_ne!(model, MechanismEffects::default(), "{}", candidate.name());
            let effects = toml::to_string_pretty(&model).expect("TOML");
            assert!(
                effects.contains(candidate.id.as_str()),
                "{}: {effects}",
                candidate.name()
            );
            assert_eq!(toml::from_str(&effects), Ok(model), "{}", candidate.name());
        }
    }
}

/// The numbers in the tables of a model's effects, by their full keys.
fn numbers(model: &StrutModel) -> Vec<(String, f64)> {
    fn collect(prefix: &str, value: &toml::Value, into: &mut Vec<(String, f64)>) {
        match value {
            toml::Value::Table(table) => (table.iter()).for_each(|(k, v)| collect(&format!("{prefix}.{k}"), v, into)),
            toml::Value::Array(list) => {
                (list.iter().enumerate()).for_each(|(k, v)| collect(&format!("{prefix}.{k}"), v, into));
            }
            toml::Value::Float(number) => into.push((prefix.to_owned(), *number)),
            _ => {}
        }
    }
    let mut all = Vec::new();
    collect("", &toml::Value::try_from(&model.effects).expect("a table"), &mut all);
    all
}

#[test]
fn what_a_self_test_conceals_is_what_the_search_puts_for_the_true_numbers() {
    let all = candidates(SpecimenKind::TwoStageStrut);
    for id in in_struts() {
        let effect = of(id).in_strut().expect("an effect of struts");
        assert!(effect.variants() > 0);
        for variant in 0..effect.variants() {
            let drawn = Drawn {
                variant,
                sign: -1.0,
                shape: [0.2, 0.4, 0.6, 0.8],
                response: [0.04, 0.002, 1e-4],
            };
            let amount = effect.amounts(variant).map_or(1.0, |(low, high)| (low * high).sqrt());
            let mut given = complete_strut();
            effect.conceal(&mut given);
            let mut truth = given.clone();
            let numbers_put = effect.put_true(&mut truth, &drawn, amount);
            assert!(!numbers_put.is_empty(), "{id}");
            assert_ne!(truth.effects, given.effects, "{id}");
            assert!(StrutModel::from_toml(&truth.to_toml(), "model.toml").is_ok(), "{id}");
            if id == EffectId::Unlisted {
                // A textbook law is not one of the tables that are searched for.
                assert!(all.iter().any(|c| c.id == id && c.place.site == numbers_put[0].site));
                continue;
            }
            // The candidate that is reported at the places of the truth.
            let mut places: Vec<_> = numbers_put.iter().map(|n| n.site.clone()).collect();
            places.sort_unstable();
            places.dedup();
            let candidate = all.iter().find(|c| {
                let entries = of(id).reported(&c.place.site, c.parameters.len());
                c.id == id && entries.into_iter().map(|(site, _)| site).collect::<Vec<_>>() == places
            });
            let candidate = candidate.unwrap_or_else(|| panic!("{id}: no candidate at {places:?}"));
            let table = numbers(&truth);
            let values: Vec<f64> = (candidate.parameters.iter())
                .map(|p| {
                    let key = reported_key(p);
                    let told = numbers_put.iter().find(|n| n.key == key).map(|n| n.value);
                    // What the truth does not tell is in the model: the stop that is not there, an overlap that is constant.
                    let value = told.or_else(|| table.iter().find(|(k, _)| k.ends_with(key)).map(|(_, v)| *v));
                    let value = value.unwrap_or_else(|| panic!("{id}: no {key}"));
                    match p.shown {
                        Shown::AsInverse(_) => 1.0 / value,
                        _ => value,
                    }
                })
                .collect();
            let mut found = given.clone();
            effect.put(&mut found, candidate, &values);
            let found = numbers(&found);
            assert_eq!(found.len(), table.len(), "{id}");
            for ((a, x), (b, y)) in found.iter().zip(&table) {
                assert!(a == b && (x - y).abs() <= 1e-12 * y.abs(), "{id}: {a} {x}, {b} {y}");
            }
        }
    }
}
