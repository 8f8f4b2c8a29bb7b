//! Types of values as FMI asks for them.

/// A type of values as FMI asks for them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Asked {
    /// Numbers.
    Real,
    /// Switches.
    Switch,
    /// Words, as numbers from 0.
    Word,
    /// Bytes.
    Binary,
    /// Clocks.
    Clock,
    /// A type of which no variable is, by its name.
    Other(&'static str),
}

impl Asked {
    /// In words, after "is".
    pub fn words(self) -> &'static str {
        match self {
            Self::Real => "a floating-point number",
            Self::Switch => "a boolean",
            Self::Word => "an enumeration",
            Self::Binary => "a binary",
            Self::Clock => "a clock",
            Self::Other(name) => name,
        }
    }
}
