//! Dry friction of a rod by what rubs there: the seal and the guides; of one strut, or of several side by side.

use super::friction::{PRESLIDING_STIFFNESS_N_M, after_stroke, after_stroke_between};
use super::terms::{Effects, GuideLevel, SealLevel};
use crate::lanes::Number;

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
    /// Force of the oil at its beginning and at its end, N.
    pub oil_forces_n: [N; 2],
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
    /// Levels at which the rod slides, N, at the beginning of a stroke and at its end. That of the seal is the one of the mean speed at both; that of the
    /// guides follows the force of the oil.
    #[inline(always)]
    pub fn levels_n(&self, rod: &Stroke<N>) -> [N; 2] {
        let mut levels_n = [rod.stroke_m.of(0.0); 2];
        if let Some(seal) = &self.seal {
            levels_n = [seal.at_n(rod.stroke_m / rod.duration_s); 2];
        }
        if let Some(guides) = &self.guides {
            let displacements_m = [rod.displacement_m - rod.stroke_m, rod.displacement_m];
            for (k, level_n) in levels_n.iter_mut().enumerate() {
                *level_n = *level_n + guides.at_n(rod.oil_forces_n[k], displacements_m[k]);
            }
        }
        levels_n
    }

    /// Friction after a stroke, N, from that before it.
    #[inline(always)]
    pub fn after_n(&self, friction_n: N, rod: &Stroke<N>) -> N {
        let levels_n = self.levels_n(rod);
        if self.guides.is_some() {
            self.between_n(friction_n, rod.stroke_m, levels_n)
        } else {
            after_stroke(friction_n, rod.stroke_m, levels_n[1], self.presliding_stiffness_n_m)
        }
    }

    /// The same from the levels at the beginning and at the end of the stroke (m), N.
    #[inline(always)]
    pub fn between_n(&self, friction_n: N, stroke_m: N, levels_n: [N; 2]) -> N {
        after_stroke_between(friction_n, stroke_m, levels_n, self.presliding_stiffness_n_m)
    }
}
