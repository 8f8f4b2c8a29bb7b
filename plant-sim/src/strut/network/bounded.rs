//! Limits the change of a pressure drop in one iteration of the solver.

/// A longer change of a drop is not trusted, Pa. Near vacuum the chamber is soft on one side and hard on the other; an
/// unbounded step leaps the gap.
const LONGEST_STEP_PA: f64 = 2e6;

/// A change of a drop, as far as it is trusted.
#[inline(always)]
#[expect(clippy::manual_clamp, reason = "clamp's care of NaN costs three times as much")]
pub(super) fn bounded(step: f64) -> f64 {
    if step > LONGEST_STEP_PA {
        LONGEST_STEP_PA
    } else if step < -LONGEST_STEP_PA {
        -LONGEST_STEP_PA
    } else {
        step
    }
}
