//! The laws that are tried on a strut, as tables of place, dependence and form, one file for each part of the strut, and others for
//! what swings in time, what changes at a moment, and tables in fine steps.
//!
//! A new row is a new law to search for; a new dependence or place is one of plant-sim's (`LawArgument`, `LawPlace`).

mod accumulators;
mod fine;
mod instruments;
mod law;
mod moments;
mod mount;
mod oscillations;
mod paths;
mod seal_and_chamber;
mod valves;

use law::Law;
use oleo_plant_sim::strut::{LawArgument, UnlistedLaw};

use super::forms::ClosedForm;
use crate::effect::candidate::{Candidate, ExclusionGroup, Joins};
use crate::parameter::Parameter;
use crate::vocabulary::EffectId;

/// The longest recording is taken to last at least this long, s.
const LEAST_DURATION_S: f64 = 1.0;

/// All laws.
fn laws() -> impl Iterator<Item = &'static Law> {
    screened().chain(at_last()).chain(fine::laws())
}

/// The law of a label.
fn of(label: &str) -> Option<&'static Law> {
    laws().find(|law| law.label == label)
}

/// Laws that are screened.
fn screened() -> impl Iterator<Item = &'static Law> {
    (seal_and_chamber::LAWS.iter())
        .chain(mount::LAWS)
        .chain(paths::LAWS)
        .chain(valves::LAWS)
        .chain(accumulators::LAWS)
        .chain(instruments::LAWS.iter().flatten())
        .chain(instruments::MEMORIES)
        .chain(oscillations::LAWS)
}

/// Laws that are screened when nothing else joins a model.
fn at_last() -> impl Iterator<Item = &'static Law> {
    moments::laws().chain(valves::TABLES)
}

/// Candidates for every law. The longest recording lasts this long, s.
pub fn candidates(longest_s: f64) -> Vec<Candidate> {
    let candidate = |law: &Law, joins: Joins| {
        let grid = law.grid(longest_s.max(LEAST_DURATION_S));
        let mut parameters = law.form.parameters(&grid);
        if law.is_of_output_only() {
            parameters = parameters.into_iter().map(Parameter::on_instrument).collect();
        }
        Candidate::new(EffectId::Unlisted, law.site.clone(), parameters)
            .labelled(law.label)
            .starting_at(law.form.starts(&grid))
            .beside_others()
            .oscillating(law.depends_on == LawArgument::Phase)
            .in_group(is_one_table_of_two_places(law).then_some(ExclusionGroup(EffectId::Unlisted)))
            .joining(joins)
    };
    (screened().map(|law| candidate(law, Joins::Screened)))
        .chain(at_last().map(|law| candidate(law, Joins::AtLast)))
        .chain(fine::laws().map(|law| candidate(law, Joins::InPlace)))
        .collect()
}

/// Whether the model has one table for this law and for one that is reported at another place. A model has one of the two.
fn is_one_table_of_two_places(law: &Law) -> bool {
    laws().any(|other| other.place == law.place && other.depends_on == law.depends_on && other.site != law.site)
}

/// The law of a candidate with its fitted numbers, as a model file holds it; `None` for a label that no law has.
#[must_use]
pub fn table(label: &str, fitted: &[f64]) -> Option<UnlistedLaw> {
    let law = of(label)?;
    let grid = law.grid(LEAST_DURATION_S);
    Some(UnlistedLaw {
        place: law.place,
        depends_on: law.depends_on,
        argument: law.form.argument(&grid, fitted),
        value: law.form.values(&grid, fitted),
        time_constant_s: law.form.time_constant_s(fitted),
        frequency_hz: law.form.frequency_hz(fitted),
        presliding_volume_m3: law.form.presliding_volume_m3(fitted),
        attraction: law.form.attraction(fitted),
    })
}

/// The numbers with which a law comes near another one of these numbers at the same place over the same quantity; `None` where they are not
/// such two, or where that says nothing. The longest recording lasts this long, s.
#[must_use]
pub fn near(label: &str, other: &str, fitted: &[f64], longest_s: f64) -> Option<Vec<f64>> {
    let (law, there) = (of(label)?, of(other)?);
    let same = law.place == there.place && law.depends_on == there.depends_on;
    let grid = law.grid(longest_s.max(LEAST_DURATION_S));
    same.then(|| law.form.near(&grid, &table(other, fitted)?)).flatten()
}

/// The law of a label as an equation; `None` for a table of free points.
#[must_use]
pub fn closed(label: &str) -> Option<ClosedForm> {
    of(label)?.form.closed()
}

/// The symbol of a fitted number in the equation of a law.
#[must_use]
pub fn symbol(label: &str, key: &str) -> Option<&'static str> {
    let law = of(label)?;
    let position = (law.form.parameters(&law.grid(LEAST_DURATION_S)).iter()).position(|p| p.key == key)?;
    law.form.closed()?.symbols.get(position).copied()
}

/// The law of a candidate as an equation with its fitted numbers; `None` for a form that is no equation.
#[must_use]
pub fn equation(label: &str, fitted: &[f64]) -> Option<String> {
    let law = of(label)?;
    let quantity = label.split(" over ").next().unwrap_or(label);
    law.form.equation(quantity, fitted)
}

#[cfg(test)]
mod tests {
    use oleo_plant_sim::model_file::Checked;

    use super::*;

    #[test]
    fn plant_sim_reads_every_law_where_it_is_put() {
        for law in laws() {
            assert!(law.place.arguments().contains(&law.depends_on), "{}", law.label);
            assert!(law.knots.windows(2).all(|w| w[0] < w[1]), "{}", law.label);
            let others = laws().filter(|other| other.label == law.label);
            assert_eq!(others.count(), 1, "{}", law.label);
        }
    }

    #[test]
    fn a_law_whose_numbers_say_absent_leaves_the_model_as_it_is() {
        for law in laws() {
            let fitted: Vec<f64> = law.form.parameters(&law.grid(50.0)).iter().map(|p| p.start).collect();
            let table = table(law.label, &fitted).expect("a law");
            // What is added is zero, a factor is one.
            let first = table.value[0];
            assert!(first == 0.0 || first == 1.0, "{}", law.label);
            assert_eq!(table.check(), Ok(()), "{}", law.label);
            assert!(table.value.iter().all(|v| *v == first), "{}", law.label);
        }
    }
}
