//! Laws around somebody else's model: tables that are added to its outputs and its inputs, and tables by which its tunable parameters are multiplied.

use oleo_plant_sim::strut::{Equation, TermId};

use super::forms::{Added, Factor, Form, Grid};
use crate::correction::{Corrections, Law, Quantity, Target};
use crate::effect::candidate::Candidate;
use crate::effect::contract::{ActsOn, CoSimulation, Experiment};
use crate::excitation::{self, Known};
use crate::parameter::Parameter;
use crate::vocabulary::{Column, EffectId, Site};

/// Points of a table on either side of zero, as parts of the largest argument: dense about zero, where friction and gaps show.
const ABOUT_ZERO: [f64; 4] = [0.02, 0.1, 0.35, 1.0];
/// Points of a table over a quantity of one sign.
const EVENLY: usize = 7;
/// The same of a factor on a parameter, each of which costs a simulation of everything.
const OF_FACTOR: usize = 4;
/// A fitted number that would be visible, as a part of the spread of what it is added to.
const VISIBLE: f64 = 0.01;
/// Logarithm of a factor on a parameter that would be visible.
const VISIBLE_FACTOR: f64 = 0.05;
/// Largest constant, as a multiple of the spread of what it is added to.
const MOST: f64 = 5.0;

/// Labels end so where the value is the same everywhere, or in proportion.
const CONSTANT: &str = ", constant";
const PROPORTIONAL: &str = ", proportional";

/// How the values of a law come from what is fitted.
#[derive(Clone, Copy, PartialEq)]
enum Shape {
    Constant,
    Proportional,
    Table,
    Factor,
}

/// The laws of this kind of specimen.
pub struct Laws;

impl ActsOn<CoSimulation> for Laws {
    fn equation(&self) -> Equation {
        TermId::Unlisted.equation()
    }

    fn candidates(&self, _model: &Corrections, excitation: &excitation::CoSimulation) -> Vec<Candidate> {
        let mut all = Vec::new();
        for reading in &excitation.outputs {
            let site = || Site::Output(reading.column.clone());
            let own = Quantity::Simulated(reading.column.to_string());
            all.push(law(site(), Shape::Constant, &anytime(), reading.spread));
            for known in &excitation.quantities {
                // A reading in proportion to itself is a gain, and one in proportion to time a drift.
                if known.quantity != own && known.quantity != Quantity::Time {
                    all.push(law(site(), Shape::Proportional, known, reading.spread));
                }
                if !known.switches && !turns(known) {
                    all.push(law(site(), Shape::Table, known, reading.spread));
                }
            }
        }
        for candidate in &mut all {
            (candidate.parameters.iter_mut()).for_each(|p| p.instrument_only = true);
        }
        for reading in &excitation.inputs {
            let site = || Site::Input(reading.column.clone());
            let name = reading.column.as_str();
            all.push(law(site(), Shape::Constant, &anytime(), reading.spread));
            let own = (excitation.quantities.iter())
                .filter(|known| matches!(&known.quantity, Quantity::Input(n) | Quantity::Rate(n) if n == name));
            all.extend(own.map(|known| law(site(), Shape::Table, known, reading.spread)));
        }
        for name in &excitation.tunable {
            let site = || Site::Parameter(Column::named(name.clone()));
            // What the model gives is not known before it is simulated.
            let before = (excitation.quantities.iter())
                .filter(|known| !matches!(known.quantity, Quantity::Simulated(_)) && !turns(known));
            all.extend(before.map(|known| law(site(), Shape::Factor, known, 1.0)));
        }
        all
    }

    fn put(&self, model: &mut Corrections, candidate: &Candidate, values: &[f64]) {
        model.law.extend(table(candidate, values));
    }

    fn experiment(&self) -> Experiment {
        Experiment {
            record: "the same inputs at half and at twice their size, each at a third and at three times the rate",
            shows: "depends on the quantity of its table, whatever else is changed",
        }
    }
}

/// Whether a quantity is limited by itself, so that a line over it says all.
fn turns(known: &Known) -> bool {
    matches!(known.quantity, Quantity::SinceTurned(..))
}

/// What a constant depends on.
fn anytime() -> Known {
    Known {
        quantity: Quantity::Time,
        range: (0.0, 1.0),
        switches: false,
    }
}

/// A candidate. `spread` is the size of what the law is added to.
fn law(site: Site, shape: Shape, known: &Known, spread: f64) -> Candidate {
    let (quantity, range) = (&known.quantity, known.range);
    let name = match &site {
        Site::Output(name) | Site::Input(name) | Site::Parameter(name) => name.to_string(),
        _ => String::new(),
    };
    let end = match shape {
        Shape::Constant => CONSTANT,
        Shape::Proportional => PROPORTIONAL,
        Shape::Table | Shape::Factor => "",
    };
    let knots = knots(shape, known);
    let grid = Grid {
        knots: &knots,
        at_rest: at_rest(&knots),
        visible: if shape == Shape::Factor {
            VISIBLE_FACTOR
        } else {
            VISIBLE * spread
        },
        longest_s: 1.0,
    };
    let visible = VISIBLE * spread;
    let parameters = match shape {
        Shape::Constant => vec![Parameter::departure("offset", visible, (-MOST * spread, MOST * spread))],
        Shape::Proportional => {
            let largest = range.0.abs().max(range.1.abs());
            let most = MOST * spread / largest;
            vec![Parameter::departure("slope", visible / largest, (-most, most))]
        }
        Shape::Table => keyed(&knots, "rise_", Added.parameters(&grid)),
        Shape::Factor => keyed(&knots, "log_rise_", Factor.parameters(&grid)),
    };
    Candidate::new(EffectId::Unlisted, site, parameters)
        .labelled(&format!("{name} over {quantity}{end}"))
        .in_place_of(EffectId::Unlisted)
}

/// Where a law changes nothing: at zero, or at the first point.
fn at_rest(knots: &[f64]) -> f64 {
    if knots.contains(&0.0) {
        0.0
    } else {
        knots.first().copied().unwrap_or(0.0)
    }
}

/// Points of the table, rounded as far as they stay apart.
fn knots(shape: Shape, known: &Known) -> Vec<f64> {
    let exact = exact_knots(shape, known);
    let rounded: Vec<f64> = (exact.iter())
        .map(|knot| format!("{knot:.2e}").parse().unwrap_or(*knot))
        .collect();
    let apart = |knots: &[f64], least: f64| knots.windows(2).all(|w| w[1] - w[0] > least);
    let least = exact.windows(2).map(|w| w[1] - w[0]).fold(f64::MAX, f64::min);
    if apart(&rounded, 0.5 * least) { rounded } else { exact }
}

fn exact_knots(shape: Shape, known: &Known) -> Vec<f64> {
    let (low, high) = known.range;
    let count = match shape {
        Shape::Constant | Shape::Proportional => return vec![-1.0, 1.0],
        Shape::Table if low < 0.0 && high > 0.0 => {
            let below = ABOUT_ZERO.iter().rev().map(|part| part * low);
            return below
                .chain([0.0])
                .chain(ABOUT_ZERO.iter().map(|part| part * high))
                .collect();
        }
        Shape::Table => EVENLY,
        Shape::Factor if known.switches => 2,
        Shape::Factor => OF_FACTOR,
    };
    (0..count)
        .map(|k| low + (high - low) * k as f64 / (count - 1) as f64)
        .collect()
}

/// The law of a candidate with its fitted numbers. The points of its table are in the keys of what is fitted.
fn table(candidate: &Candidate, fitted: &[f64]) -> Option<Law> {
    let (at, of) = match &candidate.place.site {
        Site::Output(column) => (Target::Output, column),
        Site::Input(column) => (Target::Input, column),
        Site::Parameter(name) => (Target::Parameter, name),
        _ => return None,
    };
    let over = candidate.label.strip_prefix(&format!("{of} over "))?;
    let (over, shape) = if let Some(over) = over.strip_suffix(CONSTANT) {
        (over, Shape::Constant)
    } else if let Some(over) = over.strip_suffix(PROPORTIONAL) {
        (over, Shape::Proportional)
    } else if at == Target::Parameter {
        (over, Shape::Factor)
    } else {
        (over, Shape::Table)
    };
    let (argument, value) = match shape {
        Shape::Constant => (vec![-1.0, 1.0], vec![*fitted.first()?; 2]),
        Shape::Proportional => (vec![-1.0, 1.0], vec![-fitted.first()?, *fitted.first()?]),
        Shape::Table | Shape::Factor => {
            let knots = knots_of(candidate)?;
            let grid = Grid {
                knots: &knots,
                at_rest: at_rest(&knots),
                visible: 1.0,
                longest_s: 1.0,
            };
            let form: &dyn Form = if shape == Shape::Factor { &Factor } else { &Added };
            let values = form.values(&grid, fitted);
            (knots, values)
        }
    };
    Some(Law {
        at,
        of: of.to_string(),
        over: Quantity::from(over.to_owned()),
        argument,
        value,
    })
}

/// Parameters of a table with keys that hold its points to the bit.
fn keyed(knots: &[f64], prefix: &str, parameters: Vec<Parameter>) -> Vec<Parameter> {
    (parameters.into_iter().zip(knots.windows(2)))
        .map(|(parameter, ends)| Parameter {
            key: format!("{prefix}{:e}_to_{:e}", ends[0], ends[1]),
            ..parameter
        })
        .collect()
}

/// The points of the table of a candidate, as its keys have them.
fn knots_of(candidate: &Candidate) -> Option<Vec<f64>> {
    let mut knots = Vec::with_capacity(candidate.parameters.len() + 1);
    for parameter in &candidate.parameters {
        let (from, to) = parameter.key.rsplit_once("rise_")?.1.split_once("_to_")?;
        if knots.is_empty() {
            knots.push(from.parse().ok()?);
        }
        knots.push(to.parse().ok()?);
    }
    Some(knots)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::Reading;

    fn excitation() -> excitation::CoSimulation {
        let reading = |name, spread| Reading {
            column: Column::known(name),
            spread,
        };
        let known = |quantity, range| Known {
            quantity,
            range,
            switches: false,
        };
        excitation::CoSimulation {
            outputs: vec![reading("force_N", 100.0)],
            inputs: vec![reading("x_m", 0.1)],
            quantities: vec![
                known(Quantity::Input("x_m".to_owned()), (-0.05, 0.05)),
                known(Quantity::Rate("x_m".to_owned()), (-0.7, 0.6)),
                known(Quantity::Simulated("force_N".to_owned()), (10.0, 110.0)),
                known(Quantity::Time, (0.0, 60.0)),
            ],
            tunable: vec!["damper.c".to_owned()],
            duration_s: 60.0,
            interval_s: 0.01,
        }
    }

    #[test]
    fn every_candidate_is_a_law_that_does_nothing_at_its_start() {
        let all = Laws.candidates(&Corrections::default(), &excitation());
        assert!(all.len() > 12);
        for candidate in &all {
            let start: Vec<f64> = candidate.parameters.iter().map(|p| p.start).collect();
            let law = table(candidate, &start).unwrap_or_else(|| panic!("{}", candidate.name()));
            let nothing = if law.at == Target::Parameter { 1.0 } else { 0.0 };
            assert!(law.value.iter().all(|v| *v == nothing), "{}", candidate.name());
            assert!(law.argument.windows(2).all(|w| w[0] < w[1]), "{}", candidate.name());
            let same = all
                .iter()
                .filter(|c| c.label == candidate.label && c.place == candidate.place);
            assert_eq!(same.count(), 1, "{}", candidate.name());
            assert!(candidate.absent_at(&start));
        }
    }

    #[test]
    fn a_table_that_is_fitted_is_the_law_that_is_put() {
        let all = Laws.candidates(&Corrections::default(), &excitation());
        let friction = (all.iter().find(|c| c.label == "force_N over rate of x_m")).expect("a candidate");
        let mut model = Corrections::default();
        let rises: Vec<f64> = friction.parameters.iter().map(|_| 10.0).collect();
        Laws.put(&mut model, friction, &rises);
        let law = &model.law[0];
        assert_eq!(
            (law.at, law.over.clone()),
            (Target::Output, Quantity::Rate("x_m".to_owned()))
        );
        assert_eq!(law.value_at(0.0), 0.0);
        assert!((law.value_at(0.6) - 40.0).abs() < 0.1 && (law.value_at(-0.7) + 40.0).abs() < 0.1);
        let slope = all
            .iter()
            .find(|c| c.label == "force_N over x_m, proportional")
            .expect("a candidate");
        Laws.put(&mut model, slope, &[7.0]);
        assert!((model.law[1].value_at(0.02) - 0.14).abs() < 1e-12);
    }
}
