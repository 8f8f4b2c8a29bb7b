//! Where an instance is in its life.

use serde::{Deserialize, Serialize};

/// Where an instance is in its life.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    Instantiated,
    Initializing,
    Stepping,
    Terminated,
    Configuring,
    Events,
}

impl Phase {
    /// In words, after "the instance is".
    pub fn words(self) -> &'static str {
        match self {
            Self::Instantiated => "before the initialization mode",
            Self::Initializing => "in the initialization mode",
            Self::Stepping => "between the initialization mode and the end",
            Self::Terminated => "after the end",
            Self::Configuring => "in the configuration mode",
            Self::Events => "in the event mode",
        }
    }
}
