//! The solution of the previous stage, from which the start value of the next one is predicted.

use serde::{Deserialize, Serialize};

use super::bounded::bounded;
use crate::lanes::Number;
use crate::strut::gas::Departure;

/// The last solution and how it moves.
///
/// Drops follow the piston's flow within a millisecond, so they are predicted by the last Jacobian's answer to the change
/// of that flow, which is known. What the flow does not explain (gas and chamber filling) goes on at its last rate.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(bound(
    serialize = "N: Serialize, N::Each<usize>: Serialize",
    deserialize = "N: Deserialize<'de>, N::Each<usize>: Deserialize<'de>"
))]
pub(in crate::strut) struct LastSolution<N: Number = f64> {
    /// Drops across packs 1 and 2, Pa.
    pub drop: [N; 2],
    /// Flows of paths 1 and 2, m3/s.
    pub flow: [N; 2],
    /// Segments of the packs' tables that were read.
    pub(super) segment: [N::Each<usize>; 2],
    /// What the real gas added to the ideal law.
    pub(super) real: [Departure<N>; 2],
    /// Flow that the piston supplied, m3/s.
    pub(super) supply: N,
    /// Derivative of the drops by that flow, Pa s/m3.
    pub(super) gain: [N; 2],
    /// Rate of the drops beside it, Pa/s.
    pub(super) drift: [N; 2],
}

impl LastSolution {
    /// Several side by side, `like` any number of their kind.
    #[inline(always)]
    pub fn side_by_side<N: Number>(each: &N::Each<&Self>, like: N) -> LastSolution<N> {
        let all = each.as_ref();
        let segment = |i: usize| N::each(|lane| all[lane].segment[i][0]);
        let real = |i: usize| N::each(|lane| &all[lane].real[i]);
        LastSolution {
            drop: [
                like.gather_from(all, |l| l.drop[0]),
                like.gather_from(all, |l| l.drop[1]),
            ],
            flow: [
                like.gather_from(all, |l| l.flow[0]),
                like.gather_from(all, |l| l.flow[1]),
            ],
            segment: [segment(0), segment(1)],
            real: [
                Departure::side_by_side(&real(0), like),
                Departure::side_by_side(&real(1), like),
            ],
            supply: like.gather_from(all, |l| l.supply),
            gain: [
                like.gather_from(all, |l| l.gain[0]),
                like.gather_from(all, |l| l.gain[1]),
            ],
            drift: [
                like.gather_from(all, |l| l.drift[0]),
                like.gather_from(all, |l| l.drift[1]),
            ],
        }
    }
}

impl<N: Number> LastSolution<N> {
    /// What stands in a lane.
    #[inline(always)]
    pub fn part(&self, lane: usize) -> LastSolution {
        LastSolution {
            drop: [self.drop[0].lane(lane), self.drop[1].lane(lane)],
            flow: [self.flow[0].lane(lane), self.flow[1].lane(lane)],
            segment: [[self.segment[0].as_ref()[lane]], [self.segment[1].as_ref()[lane]]],
            real: [self.real[0].part(lane), self.real[1].part(lane)],
            supply: self.supply.lane(lane),
            gain: [self.gain[0].lane(lane), self.gain[1].lane(lane)],
            drift: [self.drift[0].lane(lane), self.drift[1].lane(lane)],
        }
    }

    /// Drops as far as a new supply (m3/s) explains them, Pa.
    #[inline(always)]
    pub(super) fn explained(&self, supply: N) -> [N; 2] {
        let change = supply - self.supply;
        let [drop1, drop2] = self.drop;
        let [gain1, gain2] = self.gain;
        [drop1 + bounded(gain1 * change), drop2 + bounded(gain2 * change)]
    }

    /// Drops predicted a while (s) after the last solution, Pa.
    #[inline(always)]
    pub(super) fn predicted(&self, explained: [N; 2], since_s: N) -> [N; 2] {
        let [explained1, explained2] = explained;
        let [drift1, drift2] = self.drift;
        [
            explained1 + bounded(drift1 * since_s),
            explained2 + bounded(drift2 * since_s),
        ]
    }
}
