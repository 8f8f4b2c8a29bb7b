//! Dry friction between rod and cylinder: elastic presliding up to the level at which it slides.
//!
//! `dF/dx = k (1 - sgn(v) F / g)` (Dahl, "A solid friction model", Aerospace Corporation, 1968): the lip of the seal shears
//! with the stiffness `k` before it slides at the level `g`. The level is the sum of what the terms `seal_friction` and
//! `side_load_friction` and an unmodelled law give. Over a step of constant speed the equation is solved exactly, so the
//! step may be long against `g / (k v)`.

use crate::lanes::{Number, decay};

/// Presliding stiffness where the model has friction but no seal with a stiffness of its own, N/m (recordings README, of
/// the seal).
pub const PRESLIDING_STIFFNESS_N_M: f64 = 2e6;

/// Friction force after a stroke of `stroke_m`, from `force_n` before it, where it slides at `level_n`; N, positive
/// against jounce.
///
/// ```
/// use oleo_plant_sim::strut::{PRESLIDING_STIFFNESS_N_M, advance_friction};
/// // A long stroke slides at the level; coming back by 10 um only shears the seal.
/// let sliding = advance_friction(0.0, 0.05, 120.0, PRESLIDING_STIFFNESS_N_M);
/// assert!((sliding - 120.0).abs() < 1e-9);
/// let back = advance_friction(sliding, -1.0e-5, 120.0, PRESLIDING_STIFFNESS_N_M);
/// assert!(back > 75.0 && back < 85.0, "{back}");
/// ```
#[inline]
#[must_use]
pub fn advance_friction(force_n: f64, stroke_m: f64, level_n: f64, stiffness_n_m: f64) -> f64 {
    after_stroke(force_n, stroke_m, level_n, stiffness_n_m)
}

/// The same of several rods side by side.
#[inline(always)]
pub(super) fn after_stroke<N: Number>(force_n: N, stroke_m: N, level_n: N, stiffness_n_m: N) -> N {
    let zero = force_n.of(0.0);
    let target_n = N::choose(stroke_m.above(zero), level_n, -level_n);
    let sheared = decay(-(stiffness_n_m * stroke_m.abs()) / level_n);
    let slid_n = target_n + (force_n - target_n) * sheared;
    let rubbed_n = N::choose(level_n.up_to(zero), zero, slid_n);
    N::choose(stroke_m.abs().above(zero), rubbed_n, force_n)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slide(force_n: f64, stroke_m: f64) -> f64 {
        advance_friction(force_n, stroke_m, 100.0, 2e6)
    }

    #[test]
    fn slides_at_the_level_and_reverses() {
        let there = slide(0.0, 0.05);
        assert!((there - 100.0).abs() < 1e-6, "{there}");
        let back = slide(there, -0.05);
        assert!((back + 100.0).abs() < 1e-6, "{back}");
        assert_eq!(slide(there, 0.0), there, "at rest it keeps what it has");
        assert_eq!(advance_friction(there, 0.01, 0.0, 2e6), 0.0);
    }

    #[test]
    fn presliding_stiffness_is_the_initial_slope() {
        assert!((slide(0.0, 1e-8) / 1e-8 / 2e6 - 1.0).abs() < 1e-3);
    }

    proptest::proptest! {
        #[test]
        fn two_parts_of_a_stroke_are_the_whole(force in -100.0..100.0f64, stroke in -1e-4..1e-4f64, part in 0.0..1.0f64) {
            let two = slide(slide(force, part * stroke), (1.0 - part) * stroke);
            proptest::prop_assert!((slide(force, stroke) - two).abs() < 1e-9);
        }
    }
}
