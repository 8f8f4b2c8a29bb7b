//! The numbers of a model file as parameters: each is found by its path, and the file's own checks judge them together.

use oleo_plant_sim::model_file::Quantity;
#[cfg(feature = "pack")]
use oleo_plant_sim::model_file::Range;
use serde::Serialize;
use serde::de::DeserializeOwned;
use toml::Value;

use crate::complaint::Complaint;
use crate::variable::{Role, Variable};

/// One step on the way to a number.
#[derive(Debug, Clone, PartialEq)]
enum Step {
    Key(String),
    Entry(usize),
}

/// A model file with the way to each of its numbers.
#[derive(Debug, Clone)]
pub struct Numbers {
    file: Value,
    paths: Vec<Vec<Step>>,
}

/// What is to be known of a number to make a variable of it: keys on the way to it, entries left out.
pub type Describe = fn(&[&str], Option<usize>) -> Option<(Quantity, Role)>;

impl Numbers {
    /// The numbers of a model, and the variables that they are. `describe` tells range, unit and role of a number by its keys and, in a
    /// list, its place there; a number of which it knows nothing, such as a noise, is no parameter.
    ///
    /// # Errors
    /// The model cannot be written as a file.
    pub fn of(model: &impl Serialize, describe: Describe) -> Result<(Self, Vec<Variable>), Complaint> {
        let file = Value::try_from(model).map_err(Complaint::new)?;
        let mut found = Vec::new();
        walk(&file, &mut Vec::new(), &mut found);
        let (mut paths, mut variables) = (Vec::new(), Vec::new());
        for (path, number) in found {
            let keys: Vec<&str> = path.iter().filter_map(Step::key).collect();
            let place = match path.last() {
                Some(Step::Entry(place)) => Some(*place),
                _ => None,
            };
            let Some((quantity, role)) = describe(&keys, place) else {
                continue;
            };
            let name = name(&path);
            let description = format!("{} of the model file", name.replace("effects.", "term "));
            let Quantity { range, unit, .. } = quantity;
            variables.push(Variable::parameter(name, unit, description, role, range, number));
            paths.push(path);
        }
        Ok((Self { file, paths }, variables))
    }

    /// The model with these numbers in place of its own, in the order of the variables.
    ///
    /// # Errors
    /// The numbers do not make a model file. Whether they make a possible model is for the model to say.
    pub fn model<T: DeserializeOwned>(&self, numbers: impl IntoIterator<Item = f64>) -> Result<T, Complaint> {
        let mut file = self.file.clone();
        for (path, number) in self.paths.iter().zip(numbers) {
            if let Some(place) = path.iter().try_fold(&mut file, |value, step| match step {
                Step::Key(key) => value.get_mut(key.as_str()),
                Step::Entry(entry) => value.get_mut(*entry),
            }) {
                *place = Value::Float(number);
            }
        }
        file.try_into().map_err(Complaint::new)
    }
}

impl Step {
    fn key(&self) -> Option<&str> {
        match self {
            Self::Key(key) => Some(key),
            Self::Entry(_) => None,
        }
    }
}

/// All numbers below a value, in the order of the file. Counts of pieces are no numbers that one tunes.
fn walk(value: &Value, path: &mut Vec<Step>, found: &mut Vec<(Vec<Step>, f64)>) {
    let mut inside = |step: Step, value: &Value| {
        path.push(step);
        walk(value, path, found);
        path.pop();
    };
    match value {
        Value::Float(number) => found.push((path.clone(), *number)),
        Value::Table(table) => {
            for (key, value) in table {
                inside(Step::Key(key.clone()), value);
            }
        }
        Value::Array(entries) => {
            for (entry, value) in entries.iter().enumerate() {
                inside(Step::Entry(entry), value);
            }
        }
        _ => {}
    }
}

/// The name of a number in the structured convention of FMI: `damper[1].flow_m3_s[3]`, entries counted from 1.
fn name(path: &[Step]) -> String {
    let mut name = String::new();
    for step in path {
        match step {
            Step::Key(key) => {
                if !name.is_empty() {
                    name.push('.');
                }
                name.push_str(key);
            }
            Step::Entry(entry) => name.push_str(&format!("[{}]", entry + 1)),
        }
    }
    name
}

/// Range and unit of a key, from the table of a struct of a model file.
pub fn quantity(key: &str, table: Vec<Quantity>) -> Option<Quantity> {
    table.into_iter().find(|quantity| quantity.key == key)
}

/// The lowest and the highest value of a range, as far as there are any.
#[cfg(feature = "pack")]
pub fn ends(range: Range) -> (Option<f64>, Option<f64>) {
    match range {
        Range::Finite => (None, None),
        Range::FromTo(low, high) | Range::FromToBelow(low, high) => (Some(low), Some(high)),
        Range::OneOf(numbers) => {
            let end = |choose: fn(f64, f64) -> f64| numbers.iter().copied().reduce(choose);
            (end(f64::min), end(f64::max))
        }
    }
}
