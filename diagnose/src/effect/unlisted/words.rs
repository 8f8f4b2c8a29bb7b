//! A law of one number that the vocabulary has no name for, in words.

use oleo_plant_sim::strut::Equation;

/// The texts of a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NamelessLaw {
    /// The label of its candidates.
    pub label: &'static str,
    /// What it is called in a sentence.
    pub name: &'static str,
    /// Its equation and its source.
    pub equation: Equation,
}
