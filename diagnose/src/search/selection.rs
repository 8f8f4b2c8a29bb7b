//! The outcome of the search.

use serde::{Deserialize, Serialize};

use super::evidence::HeldOutGain;
use super::power::LeastSize;
use crate::estimation::{Fit, Point};

/// Told what is being done, and the fraction of the work that is done, 0 to 1.
pub type Progress<'a> = &'a (dyn Fn(&str, f64) + Sync);

/// What the search found.
#[derive(Debug, Clone)]
pub struct Selection {
    /// The model calibrated within tolerance, no effect added.
    pub calibrated: Fit,
    /// The improved model.
    pub best: Fit,
    /// Effects of the improved model, the one of largest gain first.
    pub effects: Vec<SelectedEffect>,
    /// Every testable candidate.
    pub scores: Vec<CandidateScore>,
    /// Held-out noise ratio of the calibrated model.
    pub calibrated_ratio: f64,
    /// Held-out noise ratio of the improved model.
    pub improved_ratio: f64,
    /// Frequencies, Hz, at which what is left swings and at which an input of the recording repeats too: whether time or motion makes it
    /// cannot be told. Asked only of a model that stays incomplete with laws without a name.
    pub of_excitation_hz: Vec<f64>,
    /// Whether laws without a name were tried in pairs, because none was accepted alone.
    pub law_pairs: LawPairs,
    /// True if the improved model is not complete: something predictable or large remains.
    pub incomplete: bool,
    /// Noise ratio on the blocks that the improved model was fitted to, if it is complete by them and not by those held out.
    pub complete_where_fitted: Option<f64>,
}

/// Whether laws without a name were tried in pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LawPairs {
    /// There was no need.
    #[default]
    NotTried,
    /// They were tried, and none was accepted.
    NoneAccepted,
    /// One was accepted.
    Found,
}

/// An effect of the improved model, and how sure it is.
#[derive(Debug, Clone)]
pub struct SelectedEffect {
    /// Index of the candidate.
    pub candidate: usize,
    /// Gain over the best model without it.
    pub gain: HeldOutGain,
    /// The best model without it.
    pub without: Point,
    /// Its held-out noise ratio.
    pub ratio_without: f64,
    /// The strongest rival, fitted in its place; `None` where none could be fitted.
    pub rival: Option<Rival>,
    /// A wrong number of the model that does as well in its place; `None` where none does.
    pub as_good: Option<Fitted>,
}

/// A candidate with the values that were fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// Index of the candidate.
    pub candidate: usize,
    /// Values of its parameters.
    pub values: Vec<f64>,
}

/// The strongest other candidate in the place of an effect.
#[derive(Debug, Clone, Copy)]
pub struct Rival {
    /// Index of the candidate.
    pub candidate: usize,
    /// Gain of the effect over the rival: by how much the rival's model meets held-out blocks worse.
    pub lead: HeldOutGain,
    /// True if the rival does as well, as far as the recordings can tell.
    pub ambiguous: bool,
}

impl SelectedEffect {
    /// The rival that the recordings cannot tell from the effect, if there is one.
    #[must_use]
    pub fn ambiguous_rival(&self) -> Option<usize> {
        self.rival.filter(|r| r.ambiguous).map(|r| r.candidate)
    }

    /// All that the recordings cannot tell from the effect: its rival, and a wrong number of the model.
    pub fn indistinguishable(&self) -> impl Iterator<Item = usize> {
        let number = self.as_good.as_ref().map(|number| number.candidate);
        self.ambiguous_rival().into_iter().chain(number)
    }
}

/// What one candidate can explain.
#[derive(Debug, Clone)]
pub struct CandidateScore {
    /// Index of the candidate.
    pub candidate: usize,
    /// Held-out noise ratio with it alone beside the calibrated model; infinite where it cannot be simulated.
    pub alone: f64,
    /// Held-out noise ratio with it added to the improved model; `None` if it is in it or excluded by it.
    pub added: Option<f64>,
    /// From which sizes the recordings would have shown it beside the improved model, if that is complete; one entry for each size.
    pub least_sizes: Vec<LeastSize>,
}
