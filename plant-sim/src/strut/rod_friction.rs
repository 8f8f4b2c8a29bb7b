//! Dry friction of a rod by what rubs there: the seal and the guides; of one strut, or of several side by side.

use super::friction::{PRESLIDING_STIFFNESS_N_M, after_stroke};
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
