//! Damper switching in ride mode: high where it calms the body.
//!
//! A damper can only oppose the relative motion of body and wheel. Let `w` be the extension speed of the strut (minus its
//! compression speed), `v` and `a` the body's vertical velocity and acceleration over it. High damping helps
//!
//! ```text
//!   Karnopp             v w > 0      the damper pulls against the body's velocity (skyhook, two stages)
//!   Hoelscher & Huang   a w > 0      the damper's force reduces |a|
//! ```
//!
//! Sources: Karnopp, Crosby & Harwood, "Vibration control using semi-active force generators", J. Eng. Ind. 96 (1974); Hoelscher & Huang
//! as described by Nell & Steyn (report, reference 16). Both *recalled*.
//!
//! Valves of 40 to 90 ms lag 14 to 65 degrees at 1 to 2 Hz and cannot follow the wheel at all, so `w` is lagged at 4 Hz and switching has
//! a dead band and a least body motion: where the body hardly moves the damping stays low and the valves rest. The least motion grows with
//! the running RMS of the vertical acceleration: a body that swings at 1.5 Hz has `v = a / 9.4 s`, so where the velocity is much less
//! than that the acceleration comes from the wheels, and high damping would only pass on more of it.

use oleo_interface::Corners;

use super::DamperPolicy;
use crate::configuration::Configuration;
use crate::estimate::Estimate;
use crate::filter::at_least;
use crate::plausibility::Trusted;

/// Square of the body velocity below which Karnopp's rule is not asked, m2/s2.
const LEAST_VELOCITY_2: f32 = 0.08 * 0.08;
/// Square of the body acceleration below which Hoelscher and Huang's rule is not asked, m2/s4.
const LEAST_ACCELERATION_2: f32 = 0.5 * 0.5;
/// Half width of the dead band of the relative speed, m/s.
const DEAD_BAND_M_S: f32 = 0.02;
/// Compression from which damping is high going further in, and extension from which it is high going further out, m: the stops are harder than any damper.
const NEAR_STOP_M: (f32, f32) = (0.06, 0.11);

/// State of the four corners.
#[derive(Clone, Copy, Debug, Default)]
pub struct SemiActive {
    corners: Corners<Corner>,
}

/// State of one corner.
#[derive(Clone, Copy, Debug, Default)]
struct Corner {
    speed_m_s: f32,
    acceleration_m_s2: f32,
    high: bool,
}

impl SemiActive {
    /// One tick; low damping wanted, by corner.
    pub fn step(&mut self, c: &Configuration, estimate: &Estimate, trusted: &Trusted) -> Corners<bool> {
        for (corner, state) in self.corners.iter_mut() {
            let speed = estimate.strut_speed_m_s[corner];
            let extension = -c.body_band.step(&mut state.speed_m_s, speed);
            let body_acceleration = c
                .body_band
                .step(&mut state.acceleration_m_s2, estimate.corner_acceleration_m_s2[corner]);
            let (body, least_2) = match c.damper_policy {
                DamperPolicy::Low => (0.0, f32::MAX),
                DamperPolicy::Karnopp => (
                    estimate.corner_velocity_m_s[corner],
                    at_least(
                        c.body_velocity_share_2 * estimate.vertical_mean_square,
                        LEAST_VELOCITY_2,
                    ),
                ),
                DamperPolicy::HoelscherHuang => (
                    body_acceleration,
                    at_least(
                        c.body_acceleration_share_2 * estimate.vertical_mean_square,
                        LEAST_ACCELERATION_2,
                    ),
                ),
            };
            let x = trusted.displacement_m[corner];
            let (jounce, rebound) = NEAR_STOP_M;
            let near_stop = (x > jounce && speed > 0.0) || (x < -rebound && speed < 0.0);
            let opposes = if body < 0.0 { -extension } else { extension };
            if near_stop {
                state.high = true;
            } else if body * body < least_2 || opposes < -DEAD_BAND_M_S {
                state.high = false;
            } else if opposes > DEAD_BAND_M_S {
                state.high = true;
            }
        }
        self.corners.map(|state| !state.high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settled(policy: DamperPolicy, extension_m_s: f32, velocity: f32, acceleration: f32, x_m: f32) -> bool {
        let c = Configuration::defender110().with_damper_policy(policy);
        let estimate = Estimate {
            strut_speed_m_s: Corners::splat(-extension_m_s),
            corner_velocity_m_s: Corners::splat(velocity),
            corner_acceleration_m_s2: Corners::splat(acceleration),
            ..Estimate::default()
        };
        let trusted = Trusted {
            displacement_m: Corners::splat(x_m),
            ..Trusted::default()
        };
        let mut state = SemiActive::default();
        let mut low = Corners::splat(false);
        for _ in 0..100 {
            low = state.step(&c, &estimate, &trusted);
        }
        let [one, ..] = low.into_array();
        assert_eq!(low, Corners::splat(one));
        !one
    }

    #[test]
    fn quadrants_of_both_rules() {
        for w in [0.3, -0.3] {
            for v in [0.4, -0.4] {
                assert_eq!(settled(DamperPolicy::Karnopp, w, v, 0.0, 0.0), w * v > 0.0);
                assert_eq!(settled(DamperPolicy::HoelscherHuang, w, 0.0, 5.0 * v, 0.0), w * v > 0.0);
                assert!(!settled(DamperPolicy::Low, w, v, 5.0 * v, 0.0));
            }
        }
    }

    #[test]
    fn a_quiet_body_rests_the_valves_and_a_near_stop_does_not() {
        assert!(!settled(DamperPolicy::Karnopp, 0.3, 0.05, 0.0, 0.0));
        assert!(settled(DamperPolicy::Karnopp, -0.3, 0.0, 0.0, 0.07));
        assert!(!settled(DamperPolicy::Karnopp, 0.3, 0.0, 0.0, 0.07));
    }
}
