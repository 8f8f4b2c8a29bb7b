//! Whether a map and a model go together.

use oleo_plant_sim::model_file::InvalidValue;
use oleo_plant_sim::model_file::names::suggestion;

use super::map::{Map, Setting};
use super::simulator::{Role, Variable};
use crate::correction::{Law, Quantity, Target};

/// How many variables are named where one is not found. Models have thousands.
const NAMED: usize = 30;

/// Refuses a map that names what the model does not have.
///
/// # Errors
/// The first entry that does not fit, and what would.
pub fn check(map: &Map, variables: &[Variable]) -> Result<(), InvalidValue> {
    let inputs = |variable: &Variable| variable.role == Role::Input;
    for name in map.inputs.keys() {
        find(variables, name, "inputs", &inputs, "inputs of the model")?;
    }
    let read = |variable: &Variable| matches!(variable.role, Role::Output | Role::Other);
    for name in map.outputs.keys() {
        find(variables, name, "outputs", &read, "outputs of the model")?;
    }
    let settable = |variable: &Variable| variable.role != Role::NoNumber;
    for (name, setting) in &map.parameters {
        if map.inputs.contains_key(name) {
            let what = "is an input too: it is either driven by a column or set";
            return Err(InvalidValue::new(name.clone(), what).inside("parameters"));
        }
        let variable = find(variables, name, "parameters", &settable, "parameters of the model")?;
        check_setting(setting, variable).map_err(|invalid| invalid.inside(name.clone()).inside("parameters"))?;
    }
    for (position, law) in map.effects.law.iter().enumerate() {
        check_law(law, map, variables).map_err(|invalid| invalid.inside(position).inside("law").inside("effects"))?;
    }
    let columns: Vec<&str> = map.compared().chain(map.sources()).collect();
    match map.effects.faulty_columns().find(|column| !columns.contains(column)) {
        Some(unknown) => {
            let what = format!(
                "name {unknown:?}: {}",
                suggestion(unknown, &columns, "columns of this map")
            );
            Err(InvalidValue::new("effects", what))
        }
        None => Ok(()),
    }
}

fn find<'v>(
    variables: &'v [Variable],
    name: &str,
    table: &'static str,
    fits: &dyn Fn(&Variable) -> bool,
    what_they_are: &str,
) -> Result<&'v Variable, InvalidValue> {
    let refuse = |what: String| Err(InvalidValue::new(name.to_owned(), what).inside(table));
    match variables.iter().find(|variable| variable.name == name) {
        Some(variable) if variable.role == Role::NoNumber => {
            refuse("is a text, an array or another thing that is no number: name a variable that is one".to_owned())
        }
        Some(variable) if fits(variable) => Ok(variable),
        found => {
            let mut known: Vec<&str> = variables.iter().filter(|v| fits(v)).map(|v| v.name.as_str()).collect();
            // Those that are alike come first, so that the suggestion is among those that are shown.
            let alike = oleo_plant_sim::model_file::names::did_you_mean(name, known.iter().copied());
            known.sort_by_key(|known| Some(*known) != alike);
            let more = known.len().saturating_sub(NAMED);
            known.truncate(NAMED);
            let what = if found.is_some() {
                "is another thing"
            } else {
                "is not there"
            };
            let list = suggestion(name, &known, what_they_are);
            let more = if more > 0 {
                format!(" and {more} more")
            } else {
                String::new()
            };
            refuse(format!("{what}: {list}{more}"))
        }
    }
}

fn check_setting(setting: &Setting, variable: &Variable) -> Result<(), InvalidValue> {
    let is_calibrated = setting.tolerance.is_some() || setting.tolerance_absolute.is_some();
    if !is_calibrated {
        return Ok(());
    }
    let key = if setting.tolerance.is_some() {
        "tolerance"
    } else {
        "tolerance_absolute"
    };
    if !variable.is_real {
        return Err(InvalidValue::new(
            key,
            "cannot be used: the variable is a switch or a counter, and only its value can be stated",
        ));
    }
    let value = setting.value.or(variable.start);
    match (value, &setting.first_of) {
        (None, None) => Err(InvalidValue::new(
            key,
            "needs a value to begin with: the model states none; state value",
        )),
        (Some(0.0), None) if setting.tolerance.is_some() => Err(InvalidValue::new(
            key,
            "is a part of the value, which is 0: state tolerance_absolute instead",
        )),
        _ => Ok(()),
    }
}

fn check_law(law: &Law, map: &Map, variables: &[Variable]) -> Result<(), InvalidValue> {
    let (compared, sources): (Vec<&str>, Vec<&str>) = (map.compared().collect(), map.sources());
    let known = |key: &'static str, name: &str, known: &[&str], what: &str| match known.contains(&name) {
        true => Ok(()),
        false => Err(InvalidValue::new(
            key,
            format!("is {name:?}: {}", suggestion(name, known, what)),
        )),
    };
    match law.at {
        Target::Output => known("of", &law.of, &compared, "compared columns")?,
        Target::Input => known("of", &law.of, &sources, "columns of inputs")?,
        Target::Parameter => {
            let tunable = |name: &&String| {
                let variable = variables.iter().find(|variable| variable.name == ***name);
                variable.is_some_and(|variable| variable.role == Role::TunableParameter)
            };
            let tunable: Vec<&str> = map.parameters.keys().filter(tunable).map(String::as_str).collect();
            known("of", &law.of, &tunable, "tunable parameters of this map")?;
        }
    }
    match &law.over {
        Quantity::Time => Ok(()),
        Quantity::Input(name) | Quantity::Rate(name) | Quantity::SinceTurned(name, _) => {
            known("over", name, &sources, "columns of inputs")
        }
        Quantity::Simulated(_) if law.at != Target::Output => Err(InvalidValue::new(
            "over",
            "is simulated, which is not known before the simulation: use an input",
        )),
        Quantity::Simulated(name) => known("over", name, &compared, "compared columns"),
    }
}
