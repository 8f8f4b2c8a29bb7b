//! Campaigns whose instruments have a flaw.

use serde::Serialize;
use strum::VariantArray;

use crate::median::median;
use crate::selftest::flaw::Flaw;
use crate::selftest::statistics::Rate;
use crate::selftest::trial::{Reported, Trial};

/// What was said of campaigns whose instruments have a flaw.
#[derive(Debug, Clone, Serialize)]
pub struct Flawed {
    /// What is wrong with the instruments.
    pub flaw: Flaw,
    /// Campaigns in which that was said.
    pub said: Rate,
    /// Campaigns in which something else was said of an instrument.
    pub said_else: Rate,
    /// Campaigns in which an effect was reported that is not there, the unnamed remainder left out.
    pub false_effect: Rate,
    /// Campaigns in which an unnamed remainder was reported.
    pub remainder: Rate,
    /// Concealed effects that were found, where there are any.
    pub found: Rate,
    /// Median noise ratio of the improved model on held-out blocks.
    pub noise_ratio: f64,
}

/// A row for each flaw that there is.
pub(super) fn instruments(trials: &[&Trial]) -> Vec<Flawed> {
    (Flaw::VARIANTS.iter())
        .filter_map(|&flaw| {
            let own: Vec<&Trial> = trials.iter().copied().filter(|t| t.flaw == Some(flaw)).collect();
            let mut row = Flawed {
                flaw,
                said: Rate::default(),
                said_else: Rate::default(),
                false_effect: Rate::default(),
                remainder: Rate::default(),
                found: Rate::default(),
                noise_ratio: median(own.iter().map(|t| t.noise_ratio.1).collect()),
            };
            for t in &own {
                let is_own = |said: &&(String, String)| said.0 == flaw.is_said_as();
                row.said.count(t.said.iter().any(|s| is_own(&s)));
                row.said_else.count(!t.said.iter().all(|s| is_own(&s)));
                let named = |r: &&Reported| r.gain.is_some();
                row.false_effect
                    .count(t.reported.iter().filter(named).any(|r| !t.there(r)));
                row.remainder.count(t.reported.iter().any(|r| r.gain.is_none()));
                t.hidden_ids().iter().for_each(|id| row.found.count(t.found(*id)));
            }
            (!own.is_empty()).then_some(row)
        })
        .collect()
}
