//! Dry friction of a rod by what rubs there: the seal and the guides; of one strut, or of several side by side.

use super::friction::{PRESLIDING_STIFFNESS_N_M, after_stroke};
use super::terms::{Effects, GuideLevel, SealLevel};
use crate::lanes::Number;

/// A stroke over the one in which a seal shears that is too short to change anything.
const LEAST_SHEAR: f64 = 1e-6;

/// What rubs at a rod.
#[derive(Debug, Clone)]
pub(super) struct RodFriction<N: Number = f64> {
    seal: Option<SealLevel<N>>,
    guides: Option<GuideLevel<N>>,
    presliding_stiffness_n_m: N,
}

/// What a rod has gone through in a step, as far as its friction depends on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stroke<N = f64> {
    /// Its length, m, jounce positive.
    pub stroke_m: N,
    /// The time that it took, s.
    pub duration_s: N,
    /// Displacement at its end, m.
    pub displacement_m: N,
    /// Force of the oil at its end, N.
    pub oil_force_n: N,
}

impl RodFriction {
    /// What rubs in a model.
    pub fn of(effects: &Effects) -> Self {
        let seal = effects.seal_friction.as_ref();
        Self {
            seal: seal.map(|seal| seal.level()),
            guides: effects.side_load_friction.as_ref().map(|guides| guides.level()),
            presliding_stiffness_n_m: seal.map_or(PRESLIDING_STIFFNESS_N_M, |seal| seal.presliding_stiffness_n_m),
        }
    }

    /// The level (N) that, held over a stroke (m), leads to the friction to which one leads that changes evenly over it, between the levels at its ends.
    /// For a rod that slides it is off by less than 2 % of the change, after a turn by less than 7 %.
    ///
    /// `dF/du = x (g(u) - F)` with `g = g_0 + (g_1 - g_0) u` over the part *u* of the stroke has the end `g_1 - (g_1 - g_0) f + (F_0 - g_0) e`, where
    /// `e = exp(-x)`, `f = (1 - e) / x` and *x* is the stroke over the distance along which the seal shears at the middle level; a held level *g* has the end `g + (F_0 - g) e`.
    pub fn held_level_n(&self, stroke_m: f64, [begin_n, end_n]: [f64; 2]) -> f64 {
        let x = self.presliding_stiffness_n_m * stroke_m.abs() / (0.5 * (begin_n + end_n));
        // Where the seal does not shear or has no level, the friction does not depend on how the level changes.
        if begin_n == end_n || end_n <= 0.0 || !(x > LEAST_SHEAR && x.is_finite()) {
            return end_n;
        }
        let (e, slid) = (libm::exp(-x), -libm::expm1(-x));
        end_n + (end_n - begin_n) * (e - slid / x) / slid
    }

    /// Whether nothing rubs.
    pub fn is_none(&self) -> bool {
        self.seal.is_none() && self.guides.is_none()
    }

    /// That of several struts side by side, `like` any number of their kind. Where nothing rubs in a lane, its friction is zero.
    pub fn abreast<N: Number>(all: &[&Self], like: N) -> RodFriction<N> {
        let seal =
            |value: fn(&SealLevel) -> f64, none: f64| like.gather(|lane| all[lane].seal.as_ref().map_or(none, value));
        let guides = |value: fn(&GuideLevel) -> f64| like.gather(|lane| all[lane].guides.as_ref().map_or(0.0, value));
        RodFriction {
            seal: all.iter().any(|one| one.seal.is_some()).then(|| SealLevel {
                coulomb_n: seal(|seal| seal.coulomb_n, 0.0),
                above_coulomb_n: seal(|seal| seal.above_coulomb_n, 0.0),
                stribeck_m_s: seal(|seal| seal.stribeck_m_s, 1.0),
            }),
            guides: all.iter().any(|one| one.guides.is_some()).then(|| GuideLevel {
                coefficient: guides(|guides| guides.coefficient),
                overlap_growth_1_m: guides(|guides| guides.overlap_growth_1_m),
            }),
            presliding_stiffness_n_m: like.gather(|lane| all[lane].presliding_stiffness_n_m),
        }
    }
}

impl<N: Number> RodFriction<N> {
    /// Level at which the rod slides, N.
    #[inline(always)]
    pub fn level_n(&self, rod: &Stroke<N>) -> N {
        let mut level_n = rod.stroke_m.of(0.0);
        if let Some(seal) = &self.seal {
            level_n = seal.at_n(rod.stroke_m / rod.duration_s);
        }
        if let Some(guides) = &self.guides {
            level_n = level_n + guides.at_n(rod.oil_force_n, rod.displacement_m);
        }
        level_n
    }

    /// Friction after a stroke, N, from that before it and the level at which the rod slides.
    #[inline(always)]
    pub fn after_n(&self, friction_n: N, rod: &Stroke<N>, level_n: N) -> N {
        after_stroke(friction_n, rod.stroke_m, level_n, self.presliding_stiffness_n_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::advance_friction;

    /// By how much the friction after a stroke is off, over the change of the level, from one beside which the stroke is made in 4,000 parts.
    fn off_by(friction_n: f64, stroke_m: f64, levels_n: [f64; 2]) -> f64 {
        let held_n = RodFriction::of(&Effects::default()).held_level_n(stroke_m, levels_n);
        let after =
            |friction_n, stroke_m, level_n| advance_friction(friction_n, stroke_m, level_n, PRESLIDING_STIFFNESS_N_M);
        let change_n = levels_n[1] - levels_n[0];
        let parts = 4000;
        let in_parts_n = (0..parts).fold(friction_n, |friction_n, k| {
            let middle = (f64::from(k) + 0.5) / f64::from(parts);
            after(friction_n, stroke_m / f64::from(parts), levels_n[0] + change_n * middle)
        });
        (after(friction_n, stroke_m, held_n) - in_parts_n) / change_n
    }

    #[test]
    fn a_held_level_ends_where_one_does_that_changes_evenly() {
        for stroke_m in [1e-6, 3e-5, 1e-4, 4e-4, 3e-3] {
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
    fn the_end_holds_where_nothing_shears_or_nothing_changes() {
        let rod = RodFriction::of(&Effects::default());
        assert_eq!(rod.held_level_n(0.0, [100.0, 120.0]), 120.0);
        assert_eq!(rod.held_level_n(1e-4, [120.0, 120.0]), 120.0);
        assert_eq!(rod.held_level_n(1e-4, [10.0, 0.0]), 0.0);
    }
}
