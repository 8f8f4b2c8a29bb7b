//! Dry friction of a mechanism: the level at which it slides, and its stiffness before.
//!
//! The levels of Coulomb, Stribeck and presliding friction add up. Where presliding friction gives a stiffness, all of them are
//! sheared with it; otherwise the contact is rigid, and holds any force up to the level.

use super::effects::MechanismEffects;
use crate::strut::advance_friction;

/// Slope of presliding friction over displacement, and the friction force: what a step of a drive needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shear {
    /// Friction force now, N, positive against positive motion.
    pub force_n: f64,
    /// Change of the force over displacement in the direction of travel, N/m.
    pub slope_n_m: f64,
}

impl MechanismEffects {
    /// Force at which dry friction slides at a speed (m/s), N; zero where there is none.
    #[must_use]
    pub fn friction_level_n(&self, speed_m_s: f64) -> f64 {
        self.coulomb_friction.as_ref().map_or(0.0, |f| f.level_n())
            + self.stribeck_friction.as_ref().map_or(0.0, |f| f.level_n(speed_m_s))
            + self.presliding_friction.as_ref().map_or(0.0, |f| f.level_n(speed_m_s))
    }

    /// Stiffness before sliding, N/m; `None` for a rigid contact.
    #[must_use]
    pub fn presliding_stiffness_n_m(&self) -> Option<f64> {
        self.presliding_friction.as_ref().map(|f| f.presliding_stiffness_n_m)
    }

    /// Friction force after a stroke (m) at a speed (m/s) of a moved mechanism, from the force before it; N.
    #[must_use]
    pub fn friction_after_n(&self, force_n: f64, stroke_m: f64, speed_m_s: f64) -> f64 {
        let level = self.friction_level_n(speed_m_s);
        match self.presliding_stiffness_n_m() {
            Some(stiffness) => advance_friction(force_n, stroke_m, level, stiffness),
            None if speed_m_s == 0.0 => 0.0,
            None => level.copysign(speed_m_s),
        }
    }

    /// Presliding friction at a force (N) and a speed (m/s); `None` for a rigid contact.
    #[must_use]
    pub fn shear(&self, force_n: f64, speed_m_s: f64) -> Option<Shear> {
        let stiffness = self.presliding_stiffness_n_m()?;
        let level = self.friction_level_n(speed_m_s);
        let direction = if speed_m_s < 0.0 { -1.0 } else { 1.0 };
        let slope_n_m = if level > 0.0 {
            (stiffness * (1.0 - direction * force_n / level)).max(0.0)
        } else {
            0.0
        };
        Some(Shear { force_n, slope_n_m })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen::mechanism::{CoulombFriction, PreslidingFriction};

    fn with_presliding() -> MechanismEffects {
        MechanismEffects {
            presliding_friction: Some(PreslidingFriction {
                coulomb_force_n: 500.0,
                presliding_stiffness_n_m: 1e6,
                breakaway_force_n: None,
                stribeck_speed_m_s: None,
            }),
            ..MechanismEffects::default()
        }
    }

    /// From a reversal at `-g` Dahl's equation has the solution `F = g (1 - 2 exp(-k x / g))`.
    #[test]
    fn a_hysteresis_loop_is_the_closed_form() {
        let effects = with_presliding();
        let mut force = -500.0;
        for k in 1..=300 {
            force = effects.friction_after_n(force, 1e-5, 0.01);
            let x = 1e-5 * f64::from(k);
            let expected = 500.0 * (1.0 - 2.0 * libm::exp(-1e6 * x / 500.0));
            assert!((force - expected).abs() < 1e-9, "{x}: {force} {expected}");
        }
    }

    #[test]
    fn the_slope_of_the_shear_is_the_derivative_over_displacement() {
        let effects = with_presliding();
        for (force, direction) in [(-500.0, 1.0), (0.0, 1.0), (300.0, -1.0), (450.0, 1.0)] {
            let slope = effects.shear(force, 0.01 * direction).expect("a stiffness").slope_n_m;
            let step = 1e-9;
            let after = effects.friction_after_n(force, direction * step, 0.01 * direction);
            let expected = (after - force) / (direction * step);
            assert!((slope - expected).abs() < 1e-3 * 1e6, "{force}: {slope} {expected}");
        }
    }

    #[test]
    fn a_rigid_contact_has_its_level_in_either_direction_and_nothing_at_rest() {
        let effects = MechanismEffects {
            coulomb_friction: Some(CoulombFriction { coulomb_force_n: 20.0 }),
            ..MechanismEffects::default()
        };
        let at = |speed| effects.friction_after_n(7.0, 0.0, speed);
        assert_eq!((at(0.3), at(-1e-4), at(0.0)), (20.0, -20.0, 0.0));
        assert_eq!(effects.shear(0.0, 0.1), None);
    }
}
