//! Limits the change of a pressure drop in one iteration of the solver.

use crate::lanes::Number;

/// A longer change of a drop is not trusted, Pa. Near vacuum the chamber is soft on one side and hard on the other; an
/// unbounded step leaps the gap.
const LONGEST_STEP_PA: f64 = 2e6;

/// A change of a drop, as far as it is trusted.
#[inline(always)]
pub(super) fn bounded<N: Number>(step: N) -> N {
    let longest = step.of(LONGEST_STEP_PA);
    let from_above = N::choose(step.above(longest), longest, step);
    N::choose((-longest).above(step), -longest, from_above)
}
