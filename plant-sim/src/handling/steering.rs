//! The steering from the driver to the front wheels: limits of angle and rate, and the elasticity of the linkage.
//!
//! The linkage between a held steering wheel and the road wheels gives way to the torque about the swivel pins, which the
//! tyres' aligning moments and their side forces at the castor trail make:
//!
//! ```text
//! T = sum over front wheels (Mz - t_castor Fy)        K (delta + tau delta') = T
//! ```
//!
//! with the stiffness K of the whole linkage at the wheels and a short time constant tau for its damping. A side force to
//! the left turns the wheels to the right: understeer (T. D. Gillespie, *Fundamentals of Vehicle Dynamics*, SAE 1992, 6:
//! "steering system compliance"). Both wheels turn alike: no Ackermann, no toe, no torque from unequal drive forces.

use super::parameters::Steering;
use serde::{Deserialize, Serialize};

/// Where the front wheels point.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct SteeringState {
    /// Angle that the driver sets, divided by the steering ratio, rad, left positive.
    pub(super) set_rad: f64,
    /// Angle that the linkage has given way, rad, left positive.
    pub(super) given_way_rad: f64,
}

impl SteeringState {
    /// Steer angle of the front wheels against the axle, rad, left positive.
    pub(super) fn wheel_rad(&self) -> f64 {
        self.set_rad + self.given_way_rad
    }

    /// The driver turns towards `wanted_rad` for `duration_s`, as fast and as far as the steering goes.
    pub(super) fn turn(&mut self, steering: &Steering, wanted_rad: f64, duration_s: f64) {
        let most = steering.max_rate_rad_s * duration_s;
        let wanted = wanted_rad.clamp(-steering.max_angle_rad, steering.max_angle_rad);
        self.set_rad += (wanted - self.set_rad).clamp(-most, most);
    }

    /// The linkage gives way to a torque about the swivel pins (N m, left positive) for `duration_s`.
    pub(super) fn give_way(&mut self, steering: &Steering, torque_n_m: f64, duration_s: f64) {
        let settled = torque_n_m / steering.linkage_stiffness_n_m_rad;
        let share = duration_s / (steering.linkage_time_constant_s + duration_s);
        self.given_way_rad += (settled - self.given_way_rad) * share;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::handling::HandlingParameters;

    #[test]
    fn turns_no_further_and_no_faster_than_it_can() {
        let steering = HandlingParameters::defender110().steering;
        let mut state = SteeringState::default();
        for _ in 0..100 {
            state.turn(&steering, 10.0, 0.001);
        }
        assert!((state.set_rad - 0.1 * steering.max_rate_rad_s).abs() < 1e-12);
        for _ in 0..10_000 {
            state.turn(&steering, 10.0, 0.001);
        }
        assert_eq!(state.set_rad, steering.max_angle_rad);
    }

    #[test]
    fn gives_way_by_torque_over_stiffness_within_its_time_constant() {
        let steering = HandlingParameters::defender110().steering;
        let mut state = SteeringState::default();
        let settled = 400.0 / steering.linkage_stiffness_n_m_rad;
        for i in 1..=20_000 {
            state.give_way(&steering, 400.0, 1e-5);
            let time_s = 1e-5 * f64::from(i);
            let exact = settled * (1.0 - libm::exp(-time_s / steering.linkage_time_constant_s));
            assert!((state.wheel_rad() - exact).abs() < 1e-3 * settled);
        }
    }
}
