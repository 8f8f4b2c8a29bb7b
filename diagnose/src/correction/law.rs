//! A law without a name at an input, an output or a parameter of somebody else's model: a table.

use oleo_plant_sim::model_file::limits::{as_many, increasing};
use oleo_plant_sim::model_file::{Checked, InvalidValue, Limit, Range};
use serde::{Deserialize, Serialize};

use super::quantity::Quantity;

/// Where a law acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// Its value is added to what the model is given of a column.
    Input,
    /// Its value is added to what the model gives for a column.
    Output,
    /// A parameter is multiplied by its value.
    Parameter,
}

/// A law: its value over a quantity, linear between the points of its table. Beyond its ends a table of more than two points holds; two points are a straight line everywhere.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Law {
    /// Where it acts.
    pub at: Target,
    /// Column, or name of the parameter.
    pub of: String,
    /// What it depends on.
    pub over: Quantity,
    /// Values of the quantity, increasing.
    pub argument: Vec<f64>,
    /// The law's values there.
    pub value: Vec<f64>,
}

impl Checked for Law {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::list("argument", Range::Finite, "", |law| &law.argument),
        Limit::list("value", Range::Finite, "", |law| &law.value),
    ];

    fn check_together(&self) -> Result<(), InvalidValue> {
        increasing("argument", &self.argument)?;
        as_many("value", &self.value, "argument", &self.argument)
    }
}

impl Law {
    /// Its value at an argument.
    #[must_use]
    pub fn value_at(&self, argument: f64) -> f64 {
        let last = self.argument.len().saturating_sub(2);
        let argument = match self.argument.as_slice() {
            [first, _, .., end] if last > 0 => argument.max(*first).min(*end),
            _ => argument,
        };
        let k = self
            .argument
            .partition_point(|a| *a <= argument)
            .saturating_sub(1)
            .min(last);
        match (self.argument.get(k..k + 2), self.value.get(k..k + 2)) {
            (Some(&[a, b]), Some(&[from, to])) => from + (argument - a) / (b - a) * (to - from),
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_linear_between_its_points_and_holds_beyond() {
        let law = Law {
            at: Target::Output,
            of: "force_N".to_owned(),
            over: Quantity::Time,
            argument: vec![0.0, 1.0, 3.0],
            value: vec![0.0, 2.0, 0.0],
        };
        assert_eq!(
            [-1.0, 0.5, 1.0, 2.0, 4.0].map(|a| law.value_at(a)),
            [0.0, 1.0, 2.0, 1.0, 0.0]
        );
        assert!(law.check().is_ok());
        let line = Law {
            argument: vec![-1.0, 1.0],
            value: vec![-3.0, 3.0],
            ..law.clone()
        };
        assert_eq!([-2.0, 0.0, 5.0].map(|a| line.value_at(a)), [-6.0, 0.0, 15.0]);
        let broken = Law {
            value: vec![0.0],
            ..law
        };
        assert!(broken.check().is_err());
        assert_eq!(broken.value_at(0.0), 0.0);
    }
}
