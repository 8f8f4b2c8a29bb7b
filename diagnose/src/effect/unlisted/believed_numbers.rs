//! Numbers of a strut's model that are other than believed, by more than their tolerance.
//!
//! A model of which one number is wrong lacks no law, and yet what it predicts is off: a damper that was rebuilt, an oil of another bulk modulus, a valve with
//! another orifice. Each row is a number of the model file, or several that go together, and the one relative departure that is fitted. The gas volumes are not
//! among them, since they have a name: the gas charge error.

use std::ops::Range;

use oleo_interface::Valve::{Bypass1, Bypass2, Spring};
use oleo_plant_sim::model_file::Checked;
use oleo_plant_sim::strut::{Equation, StrutModel};
use oleo_report::significant;

use super::swinging_textbook;
use super::textbook;
use super::words::NamelessLaw;
use crate::effect::candidate::Candidate;
use crate::effect::drawn::{Drawn, TrueNumber};
use crate::parameter::{Parameter, Shown};
use crate::vocabulary::{Branch, EffectId, Site};

/// A relative departure that would be visible.
const VISIBLE: f64 = 0.02;
/// Smallest and largest relative departure, where the model file allows as much: a tenth of the number to ten times.
const DEPARTURE: (f64, f64) = (-0.9, 9.0);
/// Halvings that find the largest departure that the model file allows, to one part in a million.
const HALVINGS: usize = 24;
/// Departures from which a fit starts too, half of what is believed and twice as much: from a time constant that is a third, what is believed is beyond
/// a maximum of the misfit.
const FARTHER: [f64; 2] = [-0.5, 1.0];
/// The largest amount that a self-test conceals: at an amount of one a number is 1.6 times, or 1/1.6 of, what is believed.
const MOST: f64 = 0.6;

/// Digits of what was found.
const DIGITS: usize = 4;

/// A number of the model, or several that go together.
struct BelievedNumber {
    /// Label of its candidate, and its name in a sentence.
    label: &'static str,
    /// Key under which it is reported: that of the model file, or of a factor.
    key: &'static str,
    site: Site,
    /// The numbers in a model, which all depart by one factor. None where the model does not have them.
    of: fn(&mut StrutModel) -> Vec<&mut f64>,
    /// Key of the calibration value that is its tolerance.
    tolerance: Option<&'static str>,
    /// What is reported: the first of the numbers, or the factor of them all.
    shown: Reported,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Reported {
    Number,
    Factor,
}

const fn row(
    shown: Reported,
    label: &'static str,
    key: &'static str,
    site: Site,
    tolerance: Option<&'static str>,
    of: fn(&mut StrutModel) -> Vec<&mut f64>,
) -> BelievedNumber {
    BelievedNumber {
        label,
        key,
        site,
        of,
        tolerance,
        shown,
    }
}

/// How many of them, the first, every strut of a self-test has.
const IN_EVERY_STRUT: usize = 14;

static NUMBERS: [BelievedNumber; 19] = [
    row(
        Reported::Number,
        "a wrong static pressure",
        "static_pressure_Pa",
        Site::MainChamber,
        Some("static_pressure"),
        |m| vec![&mut m.cylinder.static_pressure_pa],
    ),
    row(
        Reported::Number,
        "a wrong bore",
        "bore_m",
        Site::MainChamber,
        None,
        |m| vec![&mut m.cylinder.bore_m],
    ),
    row(
        Reported::Number,
        "a wrong oil volume",
        "oil_volume_m3",
        Site::MainChamber,
        Some("oil_volume"),
        |m| vec![&mut m.cylinder.oil_volume_m3],
    ),
    row(
        Reported::Number,
        "a wrong bulk modulus of the oil",
        "bulk_modulus_Pa",
        Site::MainChamber,
        Some("bulk_modulus"),
        |m| (m.effects.oil_compressibility.iter_mut().map(|t| &mut t.bulk_modulus_pa)).collect(),
    ),
    row(
        Reported::Number,
        "a wrong thermal time constant of accumulator 1",
        "time_constant_1_s",
        Site::Accumulator(Branch::First),
        Some("time_constant_1"),
        |m| (m.effects.gas_heat_transfer.iter_mut().map(|t| &mut t.time_constant_1_s)).collect(),
    ),
    row(
        Reported::Number,
        "a wrong thermal time constant of accumulator 2",
        "time_constant_2_s",
        Site::Accumulator(Branch::Second),
        Some("time_constant_2"),
        |m| (m.effects.gas_heat_transfer.iter_mut().map(|t| &mut t.time_constant_2_s)).collect(),
    ),
    row(
        Reported::Factor,
        "a wrong strength of damper 1",
        "pressure_drop_factor",
        Site::Path(Branch::First),
        None,
        |m| m.damper[0].pressure_drop_pa.iter_mut().collect(),
    ),
    row(
        Reported::Factor,
        "a wrong strength of damper 2",
        "pressure_drop_factor",
        Site::Path(Branch::Second),
        None,
        |m| m.damper[1].pressure_drop_pa.iter_mut().collect(),
    ),
    row(
        Reported::Number,
        "a wrong flow coefficient of valve 1",
        "flow_coefficient",
        Site::Valve(Bypass1),
        Some("flow_coefficient_1"),
        |m| vec![&mut m.valve[0].flow_coefficient],
    ),
    row(
        Reported::Number,
        "a wrong flow coefficient of valve 2",
        "flow_coefficient",
        Site::Valve(Bypass2),
        Some("flow_coefficient_2"),
        |m| vec![&mut m.valve[1].flow_coefficient],
    ),
    row(
        Reported::Number,
        "a wrong flow coefficient of valve 3",
        "flow_coefficient",
        Site::Valve(Spring),
        Some("flow_coefficient_3"),
        |m| vec![&mut m.valve[2].flow_coefficient],
    ),
    row(
        Reported::Factor,
        "a wrong response time of the valves",
        "response_time_factor",
        Site::Valves,
        None,
        |m| m.valve_timing.response_polynomial_s.iter_mut().collect(),
    ),
    row(
        Reported::Number,
        "a wrong delay before the valves move",
        "initial_delay_fraction",
        Site::Valves,
        None,
        |m| vec![&mut m.valve_timing.initial_delay_fraction],
    ),
    row(
        Reported::Number,
        "a wrong friction of the seal",
        "coulomb_force_N",
        Site::MainSeal,
        None,
        |m| {
            let friction = m.effects.seal_friction.iter_mut();
            friction
                .flat_map(|t| [&mut t.coulomb_force_n, &mut t.breakaway_force_n])
                .collect()
        },
    ),
    row(
        Reported::Number,
        "a wrong volume of entrained air",
        "volume_fraction",
        Site::MainChamber,
        None,
        |m| (m.effects.entrained_air.iter_mut().map(|t| &mut t.volume_fraction)).collect(),
    ),
    row(
        Reported::Number,
        "a wrong temperature of the gas",
        "temperature_K",
        Site::Accumulators,
        Some("temperature_K"),
        |m| match m.effects.real_gas {
            // The pressures of an ideal gas are the same at any temperature of its surroundings.
            Some(_) => vec![&mut m.gas.temperature_k],
            None => vec![],
        },
    ),
    row(
        Reported::Number,
        "a wrong friction under side load",
        "coefficient",
        Site::MainSeal,
        None,
        |m| (m.effects.side_load_friction.iter_mut().map(|t| &mut t.coefficient)).collect(),
    ),
    row(
        Reported::Number,
        "a wrong stiffness of the end stop",
        "stiffness_N_m",
        Site::EndStop,
        None,
        |m| {
            let stop = m.effects.bump_stop.iter_mut();
            stop.flat_map(|t| [&mut t.stiffness_n_m, &mut t.progression_n_m3])
                .collect()
        },
    ),
    row(
        Reported::Number,
        "a wrong stiffness of the mount",
        "stiffness_N_m",
        Site::Mount,
        None,
        |m| (m.effects.mount_compliance.iter_mut().map(|t| &mut t.stiffness_n_m)).collect(),
    ),
];

impl BelievedNumber {
    /// The number that a model states, or 1 for a factor; `None` where the model has no such number, or has it as nothing.
    fn believed(&self, model: &StrutModel) -> Option<f64> {
        let mut model = model.clone();
        let first = (self.of)(&mut model).first().map(|first| **first)?;
        match self.shown {
            Reported::Number => Some(first).filter(|believed| *believed > 0.0),
            Reported::Factor => Some(1.0),
        }
    }

    /// Multiplies the numbers in a model.
    fn multiply(&self, model: &mut StrutModel, factor: f64) {
        for number in (self.of)(model) {
            *number *= factor;
        }
    }

    /// The departure up to this one with which a model is still one that its file may state.
    fn farthest(&self, model: &StrutModel, end: f64) -> f64 {
        let allowed = |departure: f64| {
            let mut model = model.clone();
            self.multiply(&mut model, 1.0 + departure);
            model.check().is_ok()
        };
        if allowed(end) {
            return end;
        }
        let halved = |(inside, outside): (f64, f64), _| match 0.5 * (inside + outside) {
            middle if allowed(middle) => (middle, outside),
            middle => (inside, middle),
        };
        (0..HALVINGS).fold((0.0, end), halved).0
    }

    fn candidate(&self, model: &StrutModel) -> Option<Candidate> {
        let believed = self.believed(model)?;
        let range = (self.farthest(model, DEPARTURE.0), self.farthest(model, DEPARTURE.1));
        let departure = Parameter::departure(self.key, VISIBLE, range).shown_as_number(believed);
        let farther = FARTHER
            .into_iter()
            .filter(|departure| range.0 < *departure && *departure < range.1);
        Some(
            Candidate::new(EffectId::Unlisted, self.site.clone(), vec![departure])
                .starting_at(farther.map(|departure| vec![departure]).collect())
                .labelled(self.label)
                .of_believed_number(self.tolerance),
        )
    }
}

fn of_label(label: &str) -> Option<&'static BelievedNumber> {
    NUMBERS.iter().find(|number| number.label == label)
}

/// Whether a label is that of a number.
#[must_use]
pub fn is_label(label: &str) -> bool {
    of_label(label).is_some()
}

/// Candidates for every number that a model has.
pub fn candidates(model: &StrutModel) -> impl Iterator<Item = Candidate> {
    NUMBERS.iter().filter_map(|number| number.candidate(model))
}

/// Puts the departure of a candidate into a model; `false` for a label that is no number's.
pub fn put(model: &mut StrutModel, label: &str, values: &[f64]) -> bool {
    let Some(number) = of_label(label) else { return false };
    number.multiply(model, 1.0 + values.first().copied().unwrap_or(0.0));
    true
}

/// The words of a label; `None` if it is no number's.
pub fn words(label: &str) -> Option<NamelessLaw> {
    of_label(label).map(|number| NamelessLaw {
        label: number.label,
        name: number.label,
        equation: Equation {
            text: match number.shown {
                Reported::Number => "y = (1 + e) y_b",
                Reported::Factor => "y = k y_b",
            },
            source: "the model file",
        },
    })
}

/// The meaning of a label's equation, as [`crate::effect::Effect::meaning`].
pub fn meaning(label: &str) -> Option<&'static str> {
    of_label(label).map(|number| match number.shown {
        Reported::Number => "here y is the number, y_b what the model states, and e the relative error",
        Reported::Factor => "here y is each of the numbers, y_b what the model states, and k their common factor",
    })
}

/// The symbol of the number that is reported.
pub fn symbol(label: &str) -> Option<&'static str> {
    of_label(label).map(|number| match number.shown {
        Reported::Number => "y",
        Reported::Factor => "k",
    })
}

/// What was found of a candidate beside what is believed; `None` if it is no number's.
pub fn found(candidate: &Candidate, values: &[f64]) -> Option<String> {
    let (Some(parameter), Some(value)) = (candidate.parameters.first(), values.first()) else {
        return None;
    };
    match parameter.shown {
        Shown::AsNumberBelievedToBe(believed) => {
            let [found, believed] = [parameter.reported(*value), believed].map(|v| significant(v, DIGITS));
            Some(format!("{} = {found}, believed to be {believed}", parameter.key))
        }
        Shown::AsFitted | Shown::AsInverse(_) => None,
    }
}

/// Variants of the effect `unlisted` beyond all laws: the numbers of a strut's model that the self-test makes wrong.
#[must_use]
pub fn variants() -> Range<usize> {
    let from = textbook::COUNT + swinging_textbook::COUNT;
    from..from + IN_EVERY_STRUT
}

/// Makes the number of a variant another in a true model; `None` if the variant is none of these, or the model does not have it.
pub fn put_true(model: &mut StrutModel, drawn: &Drawn, amount: f64) -> Option<Vec<TrueNumber>> {
    let number = NUMBERS.get(drawn.variant.checked_sub(variants().start)?)?;
    let believed = number.believed(model)?;
    let factor = libm::pow(1.0 + MOST * amount, drawn.sign);
    number.multiply(model, factor);
    Some(vec![TrueNumber::new(
        number.site.clone(),
        number.key,
        believed * factor,
    )])
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::selftest::{Draw, nominal};

    /// A strut with as many terms as the preset has.
    fn strut() -> StrutModel {
        StrutModel::defender110(8000.0)
    }

    #[test]
    fn a_departure_of_nothing_changes_nothing_and_any_other_one_number() {
        let model = strut();
        let all: Vec<Candidate> = candidates(&model).collect();
        assert_eq!(all.len(), 17, "the preset has neither side load nor a mount");
        for candidate in all {
            let put = |departure: f64| {
                let mut changed = model.clone();
                assert!(put(&mut changed, &candidate.label, &[departure]));
                changed
            };
            assert_eq!(put(0.0), model, "{}", candidate.label);
            let reported = candidate.parameters[0].reported(0.25);
            let number = of_label(&candidate.label).expect("a number");
            let first = |mut m: StrutModel| (number.of)(&mut m).first().map(|v| **v).expect("a number");
            let expected = match number.shown {
                Reported::Number => first(put(0.25)),
                Reported::Factor => first(put(0.25)) / first(model.clone()),
            };
            assert!(
                (reported / expected - 1.0).abs() < 1e-12,
                "{}: {reported} {expected}",
                candidate.label
            );
        }
    }

    #[test]
    fn a_number_stays_where_the_model_file_allows_it() {
        let model = strut();
        let mut ends = BTreeMap::new();
        for candidate in candidates(&model) {
            let parameter = &candidate.parameters[0];
            for departure in [parameter.lower, parameter.upper] {
                let mut changed = model.clone();
                assert!(put(&mut changed, &candidate.label, &[departure]));
                assert_eq!(changed.check(), Ok(()), "{}", candidate.label);
            }
            ends.insert(parameter.key.clone(), parameter.reported(parameter.upper));
        }
        for (key, most) in [("temperature_K", 1000.0), ("initial_delay_fraction", 1.0)] {
            assert!((ends[key] / most - 1.0).abs() < 1e-5, "{key}: {}", ends[key]);
        }
    }

    #[test]
    fn every_strut_of_a_self_test_has_the_numbers_that_it_makes_wrong() {
        let given = nominal("a", &mut Draw::named("a"));
        for variant in variants() {
            let drawn = Drawn {
                variant,
                sign: -1.0,
                shape: [0.5; 4],
                response: [0.04, 0.002, 1e-4],
            };
            let mut truth = given.clone();
            truth.effects.seal_friction.clone_from(&strut().effects.seal_friction);
            let told = put_true(&mut truth, &drawn, 1.0).expect("a number");
            assert_ne!(truth, given, "{variant}");
            // Found from what is given, the true number is what is reported.
            let number = &NUMBERS[variant - variants().start];
            let believed = number.believed(&truth).expect("a number");
            assert!(number.shown == Reported::Factor || (told[0].value / believed - 1.0).abs() < 1e-12);
            assert!((told[0].value * (1.0 + MOST) / believed - 1.0).abs() < 1e-12 || number.shown == Reported::Number);
        }
        let beyond = Drawn {
            variant: 0,
            sign: 1.0,
            shape: [0.5; 4],
            response: [0.04, 0.002, 1e-4],
        };
        assert_eq!(put_true(&mut given.clone(), &beyond, 1.0), None);
    }
}
