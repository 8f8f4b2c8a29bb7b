//! The random draws with which a self-test conceals an effect.

use crate::vocabulary::{Branch, Site};

/// What is drawn of a concealed effect before its amount is known.
#[derive(Debug, Clone)]
pub struct Drawn {
    /// Which of the effect's variants.
    pub variant: usize,
    /// 1 or -1, for what may have either sign.
    pub sign: f64,
    /// Uniform numbers in 0..1 that shape the rest.
    pub shape: [f64; 4],
    /// Valve response of the complete model: s, s/MPa, s/MPa2.
    pub response: [f64; 3],
}

impl Drawn {
    /// A value between two limits that the `k`-th uniform number decides.
    #[must_use]
    pub fn between(&self, k: usize, low: f64, high: f64) -> f64 {
        low + (high - low) * self.shape[k]
    }

    /// The branch of an effect that has a variant for each.
    #[must_use]
    pub const fn branch(&self) -> Branch {
        match self.variant {
            0 => Branch::First,
            _ => Branch::Second,
        }
    }

    /// The amount in the drawn branch, and none in the other: branch 1, branch 2.
    #[must_use]
    pub fn in_its_branch(&self, amount: f64) -> [f64; 2] {
        Branch::ALL.map(|branch| if branch == self.branch() { amount } else { 0.0 })
    }
}

/// A concealed number, as the report should give it.
#[derive(Debug, Clone, PartialEq)]
pub struct TrueNumber {
    /// Place where the effect acts.
    pub site: Site,
    /// Key with unit, empty for an effect without numbers.
    pub key: String,
    /// True value, in the unit of the key.
    pub value: f64,
}

impl TrueNumber {
    /// A number with its key.
    #[must_use]
    pub fn new(site: Site, key: impl Into<String>, value: f64) -> Self {
        Self {
            site,
            key: key.into(),
            value,
        }
    }

    /// An effect that is there and has no numbers.
    #[must_use]
    pub fn present(site: Site) -> Self {
        Self::new(site, "", 0.0)
    }
}
