//! Dry friction at the rod seal and, from bending, at the guides.
//!
//! Coulomb friction with a Stribeck rise at low speed and elastic presliding: the seal's lip shears before it slides,
//!
//! `dF/dx = k (1 - sgn(v) F / g)`, `g = F_c + (F_s - F_c) exp(-(v/v_s)^2) + mu |F_strut| / (1 + s x)`
//!
//! (Dahl 1968 in the sliding limit; the Stribeck curve as in Canudas de Wit et al., "A new model for control of systems
//! with friction", IEEE TAC 40(3), 1995, without the bristle damping). Over a step of constant speed the equation is
//! solved exactly, so the step may be long against `g / (k v)`.

use super::effects::{SealFriction, SideLoadFriction};

/// Presliding stiffness where only side-load friction is in the model, N/m (recordings README, of the seal).
const SIDE_LOAD_PRESLIDING_N_M: f64 = 2e6;

impl SealFriction {
    /// Force at which the seal slides at a speed, N.
    #[inline]
    #[must_use]
    pub fn level_n(&self, speed_m_s: f64) -> f64 {
        let ratio = speed_m_s / self.stribeck_speed_m_s;
        self.coulomb_force_n + (self.breakaway_force_n - self.coulomb_force_n) * libm::exp(-ratio * ratio)
    }
}

/// The overlap of the guides never falls below this part of the one at static position.
const LEAST_OVERLAP: f64 = 0.1;

impl SideLoadFriction {
    /// Force at which the bent guides slide, N, under a strut force (N) at a displacement (m).
    #[inline]
    #[must_use]
    pub fn level_n(&self, strut_force_n: f64, displacement_m: f64) -> f64 {
        let overlap = (1.0 + self.overlap_growth_1_m * displacement_m).max(LEAST_OVERLAP);
        self.coefficient * strut_force_n.abs() / overlap
    }
}

/// Friction force after a stroke of `stroke_m`, from `force_n` before it, sliding at `level_n`; N, positive against jounce.
#[inline]
#[must_use]
pub fn advance_friction(force_n: f64, stroke_m: f64, level_n: f64, seal: Option<&SealFriction>) -> f64 {
    if stroke_m == 0.0 {
        return force_n;
    }
    if level_n <= 0.0 {
        return 0.0;
    }
    let stiffness = seal.map_or(SIDE_LOAD_PRESLIDING_N_M, |s| s.presliding_stiffness_n_m);
    let target = level_n.copysign(stroke_m);
    target + (force_n - target) * libm::exp(-stiffness * stroke_m.abs() / level_n)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEAL: SealFriction = SealFriction {
        coulomb_force_n: 100.0,
        breakaway_force_n: 150.0,
        stribeck_speed_m_s: 0.01,
        presliding_stiffness_n_m: 2e6,
    };

    fn slide(force_n: f64, stroke_m: f64, duration_s: f64) -> f64 {
        advance_friction(force_n, stroke_m, SEAL.level_n(stroke_m / duration_s), Some(&SEAL))
    }

    #[test]
    fn slides_at_the_coulomb_level_and_reverses() {
        let fast = slide(0.0, 0.05, 0.1);
        assert!((fast - 100.0).abs() < 1e-6, "{fast}");
        let slow = slide(fast, -0.05, 1e3);
        assert!((slow + 150.0).abs() < 0.01, "{slow}");
    }

    #[test]
    fn presliding_stiffness_is_the_initial_slope() {
        let f = slide(0.0, 1e-8, 1.0);
        assert!((f / 1e-8 / 2e6 - 1.0).abs() < 1e-3);
    }

    #[test]
    fn two_half_strokes_are_one_stroke() {
        let one = slide(-80.0, 4e-5, 2.0);
        let half = slide(-80.0, 2e-5, 1.0);
        assert!((one - slide(half, 2e-5, 1.0)).abs() < 1e-9);
    }

    #[test]
    fn side_load_grows_with_the_strut_force_and_shrinks_with_the_overlap() {
        let side = SideLoadFriction {
            coefficient: 0.02,
            overlap_growth_1_m: 2.5,
        };
        assert!((side.level_n(8000.0, 0.0) - 160.0).abs() < 1e-9);
        assert!((side.level_n(-8000.0, 0.1) - 128.0).abs() < 1e-9);
        assert!((advance_friction(0.0, 0.01, 160.0, None) - 160.0).abs() < 1e-9);
    }
}
