//! A variable of an FMU, as every tool sees it.

use oleo_plant_sim::model_file::Range;

/// One of the words that a variable may have, with what it means. The first has the number 0.
pub type Word = (&'static str, &'static str);

/// What values a variable has. Each is held as a number: a switch is 0 or 1, a word its place in the list.
#[derive(Debug, Clone, PartialEq)]
pub enum Kind {
    /// A number in a unit, which is empty for a ratio, and the values that it may have.
    Real { unit: &'static str, range: Range },
    /// Off or on.
    Switch,
    /// One of several words: the name of the list, and the words.
    Word { list: &'static str, words: &'static [Word] },
    /// Bytes of a type, which are valid when a clock ticks: the place of the clock in the table. In the table of values they have no value.
    Binary {
        mime_type: &'static str,
        most_bytes: usize,
        clock: usize,
    },
    /// Ticks when the one who has it says so. In the table of values it has no value.
    Clock,
}

/// What a variable is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Simulated time, which the tool counts.
    Time,
    /// Set by the tool before a step.
    Input,
    /// Known after a step.
    Output,
    /// A number of the model that is set before the start.
    Fixed,
    /// A number of the model that may be changed between two steps.
    Tunable,
    /// A switch of the interface that is set in the configuration mode, before everything else.
    Structural,
}

impl Role {
    /// Whether a tool gives the value, so that there is one to start with.
    pub fn is_given(self) -> bool {
        matches!(self, Self::Input | Self::Fixed | Self::Tunable | Self::Structural)
    }

    /// Whether it belongs to the model.
    pub fn is_parameter(self) -> bool {
        matches!(self, Self::Fixed | Self::Tunable)
    }
}

/// A variable. Its place in the table is its value reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name: `force_N`, `cylinder.bore_m`, `damper[1].flow_m3_s[3]`.
    pub name: String,
    /// What it is, in words.
    pub description: String,
    /// What values it has.
    pub kind: Kind,
    /// What it is for.
    pub role: Role,
    /// Value to start with, where the tool gives it.
    pub start: f64,
}

impl Variable {
    /// Simulated time.
    pub fn time() -> Self {
        Self::real("time", "s", "simulated time", Role::Time, Range::Finite, 0.0)
    }

    /// A number that the tool gives, within a range.
    pub fn input(name: impl Into<String>, unit: &'static str, range: Range, description: impl Into<String>) -> Self {
        Self::real(name, unit, description, Role::Input, range, 0.0)
    }

    /// A number that the model gives.
    pub fn output(name: impl Into<String>, unit: &'static str, description: impl Into<String>) -> Self {
        Self::real(name, unit, description, Role::Output, Range::Finite, 0.0)
    }

    /// A number of the model.
    pub fn parameter(
        name: impl Into<String>,
        unit: &'static str,
        description: impl Into<String>,
        role: Role,
        range: Range,
        start: f64,
    ) -> Self {
        debug_assert!(role.is_parameter());
        Self::real(name, unit, description, role, range, start)
    }

    /// A switch that the tool or the model sets.
    pub fn switch(name: impl Into<String>, role: Role, description: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            description: description.into(),
            kind: Kind::Switch,
            role,
            start: 0.0,
        }
    }

    /// One of several words, and the number of that to start with.
    pub fn word(
        name: impl Into<String>,
        list: &'static str,
        words: &'static [Word],
        role: Role,
        start: usize,
        description: impl Into<String>,
    ) -> Self {
        Self {
            name: name.into(),
            description: description.into(),
            kind: Kind::Word { list, words },
            role,
            start: start as f64,
        }
    }

    fn real(
        name: impl Into<String>,
        unit: &'static str,
        description: impl Into<String>,
        role: Role,
        range: Range,
        start: f64,
    ) -> Self {
        Self {
            name: name.into(),
            description: description.into(),
            kind: Kind::Real { unit, range },
            role,
            start,
        }
    }

    /// What is wrong with a value for it, if anything is.
    pub fn refuses(&self, value: f64) -> Option<String> {
        match &self.kind {
            Kind::Real { unit, range } if !range.contains(value) => {
                Some(format!("{} is {value}: {}", self.name, range.demand(unit)))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_outside_its_range_is_refused_in_words() {
        let speed = Variable::input("speed_m_s", "m/s", Range::FromTo(-50.0, 50.0), "speed");
        assert_eq!(speed.refuses(1.0), None);
        assert_eq!(
            speed.refuses(f64::NAN).as_deref(),
            Some("speed_m_s is NaN: must be from -50 to 50 m/s")
        );
        assert_eq!(Variable::switch("valve1", Role::Input, "valve").refuses(1.0), None);
    }
}
