//! The map between somebody else's model and recordings: which column is which input, which output is compared with which column, what may be
//! calibrated.
//!
//! ```toml
//! [specimen]
//! name = "front strut"                                       # the model's name unless stated
//!
//! [inputs]                                                   # variable of the model = where it comes from
//! displacement_m = { column = "displacement_m", at = "begin" }
//! speed_m_s = { rate_of = "displacement_m" }
//! valve1 = { column = "valve1" }
//!
//! [outputs]                                                  # variable of the model = what it is compared with
//! force_N = { column = "force_N", noise = 20.0 }
//!
//! [parameters]                                               # set before every simulation, and calibrated where there is a tolerance
//! "accumulator[1].static_gas_volume_m3" = { tolerance = 0.02 }
//! mass_kg = { value = 12.0, tolerance_absolute = 0.5 }
//!
//! [run]
//! step_s = 0.001                                             # one step for each sample unless stated
//! ```

use std::collections::BTreeMap;

use oleo_plant_sim::model_file::{Checked, InvalidValue, Limit, ModelFileError, Range, checked, read};
use serde::{Deserialize, Serialize};

use crate::correction::Corrections;

/// A map.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Map {
    /// What is recorded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub specimen: Option<Named>,
    /// Inputs of the model, by the name of the variable.
    #[serde(default)]
    pub inputs: BTreeMap<String, Input>,
    /// Outputs that are compared, by the name of the variable.
    pub outputs: BTreeMap<String, Output>,
    /// What is set before every simulation, by the name of the variable.
    #[serde(default)]
    pub parameters: BTreeMap<String, Setting>,
    /// How the model is run.
    #[serde(default)]
    pub run: Running,
    /// What is added from outside.
    #[serde(default, skip_serializing_if = "is_nothing")]
    pub effects: Corrections,
}

fn is_nothing(corrections: &Corrections) -> bool {
    *corrections == Corrections::default()
}

/// What is recorded.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Named {
    /// Its name.
    pub name: String,
}

/// Where an input comes from: `factor` times the column, or its rate per second, plus `offset`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// The column that it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub column: Option<String>,
    /// The column whose rate it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate_of: Option<String>,
    /// Unit of the column in units of the variable.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub factor: Option<f64>,
    /// What is added, in the unit of the variable.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub offset: Option<f64>,
    /// By how much the offset may be off, in the unit of the variable.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub offset_tolerance: Option<f64>,
    /// Half-width of the window, s, over which the column is smoothed by local parabolas before anything else: of what is measured with noise, above all where a rate is taken of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smooth_s: Option<f64>,
    /// Of when the value is that holds during a step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<Instant>,
}

/// The instant of a step whose value holds during it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Instant {
    /// Where it begins: what switches, and what the model moves on by itself.
    Begin,
    /// Its middle: right to second order for whatever changes evenly.
    Middle,
    /// Where it ends.
    End,
}

impl Input {
    /// The column of the recordings.
    #[must_use]
    pub fn source(&self) -> &str {
        self.column.as_deref().or(self.rate_of.as_deref()).unwrap_or_default()
    }
}

/// What an output is compared with: the column is `factor` times the variable plus `offset`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Output {
    /// The column.
    pub column: String,
    /// Standard deviation of its white noise, in the unit of the column.
    pub noise: f64,
    /// Unit of the variable in units of the column.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub factor: Option<f64>,
    /// What is added, in the unit of the column.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub offset: Option<f64>,
    /// By how much the offset may be off.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub offset_tolerance: Option<f64>,
}

/// What is set before every simulation.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setting {
    /// Its value; that of the model unless stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// Column whose first sample of each recording it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_of: Option<String>,
    /// Part of its value by which it may be off.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// The same in its own unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance_absolute: Option<f64>,
}

/// How the model is run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Running {
    /// Step, s; one step for each sample unless stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step_s: Option<f64>,
    /// Time before each recording in which its first inputs hold, s.
    pub settle_s: f64,
    /// Wall-clock time that the simulation of one recording may take, s.
    pub limit_s: f64,
    /// Memory that a process with the model may take, MiB.
    #[serde(rename = "memory_MiB")]
    pub memory_mib: u32,
}

impl Default for Running {
    fn default() -> Self {
        Self {
            step_s: None,
            settle_s: 0.0,
            limit_s: 60.0,
            memory_mib: 4096,
        }
    }
}

impl Checked for Running {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::optional("step_s", Range::FromTo(1e-7, 10.0), "s", |run| run.step_s),
        Limit::one("settle_s", Range::FromTo(0.0, 1e4), "s", |run| run.settle_s),
        Limit::one("limit_s", Range::FromTo(0.01, 1e5), "s", |run| run.limit_s),
        Limit::one("memory_MiB", Range::FromTo(16.0, 1e6), "MiB", |run| {
            f64::from(run.memory_mib)
        }),
    ];
}

impl Map {
    /// Reads a map; `file` names it in messages. What only the model knows is checked with it.
    ///
    /// # Errors
    /// One line: file, line, key, what is wrong, what to do.
    pub fn read(text: &str, file: &str) -> Result<Self, ModelFileError> {
        read(text, file)
    }

    /// The columns of the recordings that are compared, in the order of the outputs.
    pub fn compared(&self) -> impl Iterator<Item = &str> {
        self.outputs.values().map(|output| output.column.as_str())
    }

    /// Half-width of the widest window over which a column is smoothed, s; zero where it is not.
    #[must_use]
    pub fn smoothed_s(&self, column: &str) -> f64 {
        let of_column = self.inputs.values().filter(|input| input.source() == column);
        of_column.filter_map(|input| input.smooth_s).fold(0.0, f64::max)
    }

    /// The columns that inputs are taken from, each once, in their order.
    #[must_use]
    pub fn sources(&self) -> Vec<&str> {
        let mut sources: Vec<&str> = self.inputs.values().map(Input::source).collect();
        sources.sort_unstable();
        sources.dedup();
        sources
    }
}

impl Checked for Map {
    const LIMITS: &'static [Limit<Self>] = &[];

    fn check_together(&self) -> Result<(), InvalidValue> {
        if self.outputs.is_empty() {
            return Err(InvalidValue::new(
                "outputs",
                "is empty: say which output is compared with which column",
            ));
        }
        let finite = |number: Option<f64>, key: &'static str| match number {
            Some(number) if !number.is_finite() => {
                Err(InvalidValue::new(key, format!("is {number}: must be a finite number")))
            }
            _ => Ok(()),
        };
        let tolerance = |tolerance: Option<f64>, key: &'static str| match tolerance {
            Some(tolerance) if !(tolerance.is_finite() && tolerance > 0.0) => {
                Err(InvalidValue::new(key, format!("is {tolerance}: must be above 0")))
            }
            _ => Ok(()),
        };
        for (name, input) in &self.inputs {
            if input.column.is_some() == input.rate_of.is_some() {
                let what = "needs either column or rate_of: the column that it is, or whose rate it is";
                return Err(InvalidValue::new(name.clone(), what).inside("inputs"));
            }
            let inside = |invalid: InvalidValue| invalid.inside(name.clone()).inside("inputs");
            tolerance(input.smooth_s, "smooth_s").map_err(inside)?;
            tolerance(input.offset_tolerance, "offset_tolerance").map_err(inside)?;
            if input.rate_of.is_some() && input.offset_tolerance.is_some() {
                let what = "cannot stand beside rate_of: an offset of the column does not change its rate";
                return Err(inside(InvalidValue::new("offset_tolerance", what)));
            }
            (finite(input.factor, "factor").and_then(|()| finite(input.offset, "offset"))).map_err(inside)?;
        }
        let mut compared: Vec<&str> = Vec::new();
        for (name, output) in &self.outputs {
            let inside = |invalid: InvalidValue| invalid.inside(name.clone()).inside("outputs");
            if !(output.noise.is_finite() && output.noise > 0.0) {
                let what = format!("is {}: must be above 0, in the unit of the column", output.noise);
                return Err(inside(InvalidValue::new("noise", what)));
            }
            (finite(output.factor, "factor").and_then(|()| finite(output.offset, "offset"))).map_err(inside)?;
            tolerance(output.offset_tolerance, "offset_tolerance").map_err(inside)?;
            if compared.contains(&output.column.as_str()) {
                let what = format!(
                    "is {:?}, which another output is compared with: name each column once",
                    output.column
                );
                return Err(inside(InvalidValue::new("column", what)));
            }
            compared.push(&output.column);
        }
        if let Some(both) = self.sources().iter().find(|source| compared.contains(source)) {
            let what = format!(
                "compares {both}, which is an input too: a model that is told what it shall predict predicts nothing"
            );
            return Err(InvalidValue::new("outputs", what));
        }
        for (name, setting) in &self.parameters {
            let inside = |invalid: InvalidValue| invalid.inside(name.clone()).inside("parameters");
            finite(setting.value, "value").map_err(inside)?;
            tolerance(setting.tolerance, "tolerance").map_err(inside)?;
            tolerance(setting.tolerance_absolute, "tolerance_absolute").map_err(inside)?;
            if setting.tolerance.is_some() && setting.tolerance_absolute.is_some() {
                let what = "cannot stand beside tolerance: state one of the two";
                return Err(inside(InvalidValue::new("tolerance_absolute", what)));
            }
            if let Some(column) = &setting.first_of {
                if setting.value.is_some() {
                    return Err(inside(InvalidValue::new(
                        "first_of",
                        "cannot stand beside value: state one of the two",
                    )));
                }
                if !compared.contains(&column.as_str()) && !self.sources().contains(&column.as_str()) {
                    let what =
                        format!("is {column:?}, which no input or output of this map has: name one of their columns");
                    return Err(inside(InvalidValue::new("first_of", what)));
                }
            }
        }
        checked(&self.run, "run")?;
        checked(&self.effects, "effects")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAP: &str = "[inputs]\nu = { column = \"u_N\" }\n[outputs]\nx = { column = \"x_m\", noise = 1e-4 }\n[parameters]\nk = { tolerance = 0.1 }\n";

    #[test]
    fn a_map_is_read_and_written_again() {
        let map = Map::read(MAP, "map.toml").expect("a map");
        assert_eq!(
            (map.sources(), map.compared().collect::<Vec<_>>()),
            (vec!["u_N"], vec!["x_m"])
        );
        let written = toml::to_string_pretty(&map).expect("text");
        assert_eq!(Map::read(&written, "map.toml").ok(), Some(map));
    }

    #[test]
    fn what_is_wrong_is_one_line_with_its_place() {
        for (from, to, expected) in [
            ("noise = 1e-4", "noise = 0.0", "map.toml:4: [outputs.x] noise is 0"),
            ("column = \"u_N\"", "colum = \"u_N\"", "map.toml:2"),
            (
                "{ column = \"u_N\" }",
                "{ factor = 2.0 }",
                "needs either column or rate_of",
            ),
            ("\"x_m\"", "\"u_N\"", "which is an input too"),
            ("tolerance = 0.1", "tolerance = -1.0", "must be above 0"),
            ("tolerance = 0.1", "first_of = \"y\"", "name one of their columns"),
            ("tolerance = 0.1", "value = nan", "must be a finite number"),
        ] {
            let said = Map::read(&MAP.replace(from, to), "map.toml").expect_err(to).to_string();
            assert!(
                said.contains(expected) && said.starts_with("map.toml") && !said.contains('\n'),
                "{said}"
            );
        }
    }
}
