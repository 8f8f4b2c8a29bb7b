//! The solution of the previous stage, from which the start value of the next one is predicted.

use serde::{Deserialize, Serialize};

use super::bounded::bounded;
use crate::strut::gas::Departure;

/// The last solution and how it moves.
///
/// Drops follow the piston's flow within a millisecond, so they are predicted by the last Jacobian's answer to the change
/// of that flow, which is known. What the flow does not explain (gas and chamber filling) goes on at its last rate.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(in crate::strut) struct LastSolution {
    /// Drops across packs 1 and 2, Pa.
    pub drop: [f64; 2],
    /// Flows of paths 1 and 2, m3/s.
    pub flow: [f64; 2],
    /// Segments of the packs' tables that were read.
    pub(super) segment: [usize; 2],
    /// What the real gas added to the ideal law.
    pub(super) real: [Departure; 2],
    /// Flow that the piston supplied, m3/s.
    pub(super) supply: f64,
    /// Derivative of the drops by that flow, Pa s/m3.
    pub(super) gain: [f64; 2],
    /// Rate of the drops beside it, Pa/s.
    pub(super) drift: [f64; 2],
}

impl LastSolution {
    /// Drops as far as a new supply (m3/s) explains them, Pa. `CONNECTED`: valve 3 lets oil through.
    #[inline(always)]
    pub(super) fn explained<const CONNECTED: bool>(&self, supply: f64) -> [f64; 2] {
        let change = supply - self.supply;
        let explained = |i: usize| self.drop[i] + bounded(self.gain[i] * change);
        [explained(0), if CONNECTED { explained(1) } else { 0.0 }]
    }

    /// Drops predicted a while (s) after the last solution, Pa.
    #[inline(always)]
    pub(super) fn predicted<const CONNECTED: bool>(&self, explained: [f64; 2], since_s: f64) -> [f64; 2] {
        let predicted = |i: usize| explained[i] + bounded(self.drift[i] * since_s);
        [predicted(0), if CONNECTED { predicted(1) } else { 0.0 }]
    }
}
