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

/// A stroke over the distance along which the seal shears, below which the exponential is a straight line.
const SHORT: f64 = 1e-5;

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
    let left = decay(-(stiffness_n_m * stroke_m.abs()) / level_n);
    let slid_n = target_n + (force_n - target_n) * left;
    let rubbed_n = N::choose(level_n.up_to(zero), zero, slid_n);
    N::choose(stroke_m.abs().above(zero), rubbed_n, force_n)
}

/// The same where the level changes evenly over the stroke, between the levels at its ends (N).
///
/// `dF/du = x (g(u) - F)` with `g = g_0 + (g_1 - g_0) u` over the part *u* of the stroke has the end `g_1 - (g_1 - g_0) f + (F_0 - g_0) e`, where
/// `e = exp(-x)`, `f = (1 - e) / x` and *x* is the stroke over the distance along which the seal shears at the middle level. That this distance changes too
/// is left out: less than 2 % of the change of level for a rod that slides, less than 7 % after a turn.
#[inline(always)]
pub(super) fn after_stroke_between<N: Number>(force_n: N, stroke_m: N, levels_n: [N; 2], stiffness_n_m: N) -> N {
    let (zero, one) = (force_n.of(0.0), force_n.of(1.0));
    let forward = stroke_m.above(zero);
    let levels_n = [levels_n[0].at_least(zero), levels_n[1]];
    let [begin_n, end_n] = levels_n.map(|level_n| N::choose(forward, level_n, -level_n));
    let shears = stiffness_n_m * stroke_m.abs() / ((levels_n[0] + levels_n[1]) * 0.5);
    let left = decay(-shears);
    // Where the seal hardly shears, the difference to one would have no digits left.
    let mean_left = N::choose(
        shears.above(force_n.of(SHORT)),
        (one - left) / shears,
        one - shears * 0.5,
    );
    let slid_n = (end_n - (end_n - begin_n) * mean_left) + (force_n - begin_n) * left;
    let rubbed_n = N::choose(levels_n[1].up_to(zero), zero, slid_n);
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

    /// By how much the friction after a stroke is off, over the change of the level, from one beside which the stroke is made in 4,000 parts.
    fn off_by(force_n: f64, stroke_m: f64, levels_n: [f64; 2]) -> f64 {
        let change_n = levels_n[1] - levels_n[0];
        let parts = 4000;
        let in_parts_n = (0..parts).fold(force_n, |force_n, k| {
            let middle = (f64::from(k) + 0.5) / f64::from(parts);
            let level_n = levels_n[0] + change_n * middle;
            advance_friction(force_n, stroke_m / f64::from(parts), level_n, 2e6)
        });
        (after_stroke_between(force_n, stroke_m, levels_n, 2e6) - in_parts_n) / change_n
    }

    #[test]
    fn a_level_that_changes_is_followed() {
        for stroke_m in [1e-10, 1e-6, 3e-5, 1e-4, 4e-4, 3e-3] {
            for levels_n in [[100.0, 101.0], [150.0, 148.0], [100.0, 130.0]] {
                // With the level at the end it would be up to 0.30 where the rod slides. After a turn the distance along which the seal shears changes, too.
                let (slides, turns) = (off_by(100.0, stroke_m, levels_n), off_by(-40.0, stroke_m, levels_n));
                assert!(
                    slides.abs() < 0.02 && turns.abs() < 0.07,
                    "{stroke_m} {levels_n:?}: {slides} {turns}"
                );
                assert!((off_by(-100.0, -stroke_m, levels_n) + slides).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_level_that_stays_is_the_level() {
        for (force_n, stroke_m) in [(0.0, 1e-9), (-40.0, 1e-5), (100.0, -3e-4), (20.0, 0.05), (20.0, 0.0)] {
            let between_n = after_stroke_between(force_n, stroke_m, [100.0; 2], 2e6);
            assert_eq!(
                between_n.to_bits(),
                slide(force_n, stroke_m).to_bits(),
                "{force_n} {stroke_m}"
            );
        }
        assert_eq!(after_stroke_between(5.0, 1e-4, [10.0, 0.0], 2e6), 0.0);
        assert_eq!(after_stroke_between(5.0, 1e-4, [0.0, 0.0], 2e6), 0.0);
        assert_eq!(after_stroke_between(5.0, 0.0, [0.0, 0.0], 2e6), 5.0);
        let from_below = [-300.0, 0.0].map(|begin_n| after_stroke_between(5.0, 1e-4, [begin_n, 10.0], 2e6));
        assert_eq!(from_below[0], from_below[1], "a level is not negative");
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
