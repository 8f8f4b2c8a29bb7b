//! Dry friction at the rod seal and, from bending, at the guides.
//!
//! Coulomb friction with a Stribeck rise at low speed and elastic presliding: the seal's lip shears before it slides,
//!
//! `dF/dx = k (1 - sgn(v) F / g)`, `g = F_c + (F_s - F_c) exp(-(v/v_s)^2) + mu |F_strut|`
//!
//! (Dahl 1968 in the sliding limit; the Stribeck curve as in Canudas de Wit et al., "A new model for control of systems
//! with friction", IEEE TAC 40(3), 1995, without the bristle damping). Over a step of constant speed the equation is
//! solved exactly, so the step may be long against `g / (k v)`.

use super::effects::{SealFriction, SideLoadFriction};

/// Presliding stiffness where only side-load friction is in the model, N/m (recordings README, of the seal).
const SIDE_LOAD_PRESLIDING_N_M: f64 = 2e6;

/// Friction force after a stroke of `stroke_m` made in `duration_s`, from `force_n` before it; N, positive against jounce.
#[inline]
#[must_use]
pub fn advance_friction(
    force_n: f64,
    stroke_m: f64,
    duration_s: f64,
    strut_force_n: f64,
    seal: Option<&SealFriction>,
    side_load: Option<&SideLoadFriction>,
) -> f64 {
    if stroke_m == 0.0 {
        return force_n;
    }
    let mut level = 0.0;
    let mut stiffness = SIDE_LOAD_PRESLIDING_N_M;
    if let Some(seal) = seal {
        let ratio = stroke_m / duration_s / seal.stribeck_speed_m_s;
        level += seal.coulomb_force_n + (seal.breakaway_force_n - seal.coulomb_force_n) * libm::exp(-ratio * ratio);
        stiffness = seal.presliding_stiffness_n_m;
    }
    if let Some(side) = side_load {
        level += side.coefficient * strut_force_n.abs();
    }
    if level <= 0.0 {
        return 0.0;
    }
    let target = level.copysign(stroke_m);
    target + (force_n - target) * libm::exp(-stiffness * stroke_m.abs() / level)
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

    #[test]
    fn slides_at_the_coulomb_level_and_reverses() {
        let fast = advance_friction(0.0, 0.05, 0.1, 0.0, Some(&SEAL), None);
        assert!((fast - 100.0).abs() < 1e-6, "{fast}");
        let slow = advance_friction(fast, -0.05, 1e3, 0.0, Some(&SEAL), None);
        assert!((slow + 150.0).abs() < 0.01, "{slow}");
    }

    #[test]
    fn presliding_stiffness_is_the_initial_slope() {
        let f = advance_friction(0.0, 1e-8, 1.0, 0.0, Some(&SEAL), None);
        assert!((f / 1e-8 / 2e6 - 1.0).abs() < 1e-3);
    }

    #[test]
    fn two_half_strokes_are_one_stroke() {
        let one = advance_friction(-80.0, 4e-5, 2.0, 0.0, Some(&SEAL), None);
        let half = advance_friction(-80.0, 2e-5, 1.0, 0.0, Some(&SEAL), None);
        assert!((one - advance_friction(half, 2e-5, 1.0, 0.0, Some(&SEAL), None)).abs() < 1e-9);
    }

    #[test]
    fn side_load_grows_with_the_strut_force() {
        let side = SideLoadFriction { coefficient: 0.02 };
        let f = advance_friction(0.0, 0.01, 1.0, 8000.0, None, Some(&side));
        assert!((f - 160.0).abs() < 1e-9);
    }
}
