//! The path of keys from the top of a model file to one value.

use std::borrow::Cow;
use std::fmt;

/// One step on the way to a value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Step {
    /// Into a table, to the value of this key.
    Key(Cow<'static, str>),
    /// Into an array, to the entry at this position; the first is 0.
    Entry(usize),
}

impl From<&'static str> for Step {
    fn from(key: &'static str) -> Self {
        Self::Key(Cow::Borrowed(key))
    }
}

impl From<String> for Step {
    fn from(key: String) -> Self {
        Self::Key(Cow::Owned(key))
    }
}

impl From<usize> for Step {
    fn from(position: usize) -> Self {
        Self::Entry(position)
    }
}

/// The way from the top of a file to one value: the steps, outermost first.
///
/// It is shown as people look for it: the table in brackets, then the key, entries counted from 1.
///
/// ```
/// use oleo_plant_sim::model_file::KeyPath;
/// let volume = KeyPath::to("static_gas_volume_m3").inside(1).inside("accumulator");
/// assert_eq!(volume.to_string(), "[accumulator 2] static_gas_volume_m3");
/// let point = KeyPath::to(3).inside("pressure_drop_Pa").inside(0).inside("damper");
/// assert_eq!(point.to_string(), "[damper 1] pressure_drop_Pa, entry 4,");
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct KeyPath {
    steps: Vec<Step>,
}

impl KeyPath {
    /// The path of one step.
    #[must_use]
    pub fn to(step: impl Into<Step>) -> Self {
        Self {
            steps: vec![step.into()],
        }
    }

    /// The same value seen from one table or array further out.
    #[must_use]
    pub fn inside(mut self, step: impl Into<Step>) -> Self {
        self.steps.insert(0, step.into());
        self
    }

    /// The path of something within the value that this path leads to.
    #[must_use]
    pub fn then(mut self, step: impl Into<Step>) -> Self {
        self.steps.push(step.into());
        self
    }

    /// The steps, outermost first.
    #[must_use]
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }
}

impl fmt::Display for KeyPath {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let key = self
            .steps
            .iter()
            .rposition(|step| matches!(step, Step::Key(_)))
            .unwrap_or(0);
        let (table, value) = self.steps.split_at(key);
        if !table.is_empty() {
            out.write_str("[")?;
            for (k, step) in table.iter().enumerate() {
                match step {
                    Step::Key(key) => write!(out, "{}{key}", if k == 0 { "" } else { "." })?,
                    Step::Entry(position) => write!(out, "{}{}", if k == 0 { "" } else { " " }, position + 1)?,
                }
            }
            out.write_str("] ")?;
        }
        for step in value {
            match step {
                Step::Key(key) => out.write_str(key)?,
                Step::Entry(position) => write!(out, ", entry {},", position + 1)?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_stand_in_brackets_and_keys_behind_them() {
        for (path, shown) in [
            (KeyPath::default(), ""),
            (KeyPath::to("speed_km_h"), "speed_km_h"),
            (KeyPath::to("bore_m").inside("cylinder"), "[cylinder] bore_m"),
            (
                KeyPath::to("coulomb_force_N").inside("seal_friction").inside("effects"),
                "[effects.seal_friction] coulomb_force_N",
            ),
            (
                KeyPath::to(2)
                    .inside("value")
                    .inside(0)
                    .inside("unlisted")
                    .inside("effects"),
                "[effects.unlisted 1] value, entry 3,",
            ),
            (KeyPath::to("place").inside(1), "[2] place"),
            (
                KeyPath::to("effects").then("unlisted").then(1),
                "[effects] unlisted, entry 2,",
            ),
        ] {
            assert_eq!(path.to_string(), shown);
        }
    }
}
