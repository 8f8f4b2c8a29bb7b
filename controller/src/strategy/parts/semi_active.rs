//! Damper switching in ride mode: high damping where it calms the body.
//!
//! A damper can only oppose the relative motion of body and wheel. Let `w` be the extension speed of the strut (the negative of its
//! compression speed), and `v` and `a` the body's vertical velocity and acceleration above it. High damping helps where
//!
//! ```text
//!   Karnopp             v w > 0      the damper pulls against the body's velocity (skyhook, two stages)
//!   Hoelscher & Huang   a w > 0      the damper's force reduces |a|
//!   SH-ADD              the first where |a| < alpha |v|, which is near the body's resonance, else the second
//! ```
//!
//! Sources: Karnopp, Crosby & Harwood, "Vibration control using semi-active force generators", J. Eng. Ind. 96 (1974);
//! Hoelscher & Huang as described by Nell & Steyn (report, reference 16); Savaresi & Spelta, "Mixed Sky-Hook and ADD: approaching the
//! filtering limits of a semi-active suspension", J. Dyn. Syst. Meas. Control 129 (2007), 382-392. All are *recalled*.
//!
//! Over a strut at `x` ahead and `y` to the left of the centre of gravity, `a = z'' + y phi'' - x theta''` with the accelerations of
//! [`crate::estimate`], and `v` is its integral above 0.2 Hz.
//!
//! Valves of 40 to 90 ms lag by 14 to 65 degrees at 1 to 2 Hz and cannot follow the wheel at all. So `w` is lagged at 4 Hz, and
//! switching has a dead band and needs a least body motion: where the body hardly moves, the damping stays low and the valves
//! rest. The least motion grows with the running RMS of the vertical acceleration. A body that swings at 1.5 Hz has
//! `v = a / 9.4 s`; where its velocity is much less than that, the acceleration comes from the wheels, and high damping would
//! only pass on more of it.

use oleo_interface::{Axle, Corners, Side};
use strum::{EnumString, IntoStaticStr, VariantNames};

use crate::estimate::Estimate;
use crate::filter::{LeakyIntegrator, LowPass, at_least};
use crate::range::{ConfigurationError, within};
use crate::vehicle::VehicleDescription;

/// Square of the body velocity below which Karnopp's rule asks for low damping, m2/s2.
const LEAST_VELOCITY_2: f32 = 0.08 * 0.08;
/// Square of the body acceleration below which Hoelscher and Huang's rule asks for low damping, m2/s4.
const LEAST_ACCELERATION_2: f32 = 0.5 * 0.5;
/// Square of the frequency `alpha` at which SH-ADD goes from one rule to the other, rad2/s2: 1.9 Hz, which is the natural frequency
/// of the body on its soft springs times the root of 2.
const CROSSOVER_2: f32 = 11.9 * 11.9;
/// Half width of the dead band of the relative speed, m/s.
const DEAD_BAND_M_S: f32 = 0.02;
/// Compression above which damping is high while the strut moves further in, and extension above which it is high while the
/// strut moves further out, m: the stops are harder than any damper.
const NEAR_STOP_M: (f32, f32) = (0.06, 0.11);

/// How dampers are switched in ride mode. The names are those of the command line: `hoelscher-huang`.
///
/// ```
/// use oleo_controller::DamperPolicy;
/// assert_eq!("low".parse(), Ok(DamperPolicy::Low));
/// assert_eq!(DamperPolicy::HoelscherHuang.name(), "hoelscher-huang");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, EnumString, IntoStaticStr, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum DamperPolicy {
    /// Low damping always.
    Low,
    /// High where the damper's force opposes the body's velocity (skyhook in two stages).
    #[default]
    Karnopp,
    /// High where the damper's force opposes the body's acceleration.
    HoelscherHuang,
    /// As [`DamperPolicy::Karnopp`] near the body's resonance, and as [`DamperPolicy::HoelscherHuang`] above it.
    ShAdd,
}

impl DamperPolicy {
    /// Name on the command line and in scenario files.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// Policy and thresholds. See [`strategy::Tuning`](crate::strategy::Tuning) for an example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// Which rule decides.
    pub policy: DamperPolicy,
    /// Body velocity over the running RMS of vertical acceleration that Karnopp's rule needs to act, s, 0 to 10.
    pub body_velocity_share_s: f32,
    /// Body acceleration below 4 Hz over the running RMS that Hoelscher and Huang's rule needs to act, 0 to 100.
    pub body_acceleration_share: f32,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            policy: DamperPolicy::Karnopp,
            body_velocity_share_s: 0.35,  // measured: docs/controller.md
            body_acceleration_share: 2.2, // measured: docs/controller.md
        }
    }
}

impl Tuning {
    /// Whether every value is within its range.
    pub(crate) fn check(&self) -> Result<(), ConfigurationError> {
        within(
            "tuning.strategy.ride_handling.dampers.body_velocity_share_s",
            self.body_velocity_share_s,
            0.0,
            10.0,
        )?;
        within(
            "tuning.strategy.ride_handling.dampers.body_acceleration_share",
            self.body_acceleration_share,
            0.0,
            100.0,
        )
    }
}

/// Policy, squared thresholds, places of the struts and filters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parameters {
    policy: DamperPolicy,
    /// Places of the struts ahead of and to the left of the centre of gravity, m.
    place_m: Corners<(f32, f32)>,
    body_velocity: LeakyIntegrator,
    body_band: LowPass,
    body_velocity_share_2: f32,
    body_acceleration_share_2: f32,
}

impl Parameters {
    /// From a description and a tuning that have been checked.
    pub(crate) fn new(vehicle: &VehicleDescription, tuning: &Tuning) -> Self {
        let square = |x: f32| x * x;
        Self {
            policy: tuning.policy,
            place_m: Corners::from_fn(|corner| {
                let ahead_m = match corner.axle() {
                    Axle::Front => vehicle.axle_distance_m.front,
                    Axle::Rear => -vehicle.axle_distance_m.rear,
                };
                let half_m = 0.5 * vehicle.strut_spacing_m[corner.axle()];
                let left_m = if corner.side() == Side::Left { half_m } else { -half_m };
                (ahead_m, left_m)
            }),
            body_velocity: LeakyIntegrator::from_corner_hz(0.2),
            // Body frequencies only: the valves cannot follow the wheel.
            body_band: LowPass::from_corner_hz(4.0),
            body_velocity_share_2: square(tuning.body_velocity_share_s),
            body_acceleration_share_2: square(tuning.body_acceleration_share),
        }
    }
}

/// State of the four corners.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct State {
    corners: Corners<CornerState>,
}

/// State of one corner.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct CornerState {
    velocity_m_s: f32,
    speed_m_s: f32,
    acceleration_m_s2: f32,
    high: bool,
}

impl State {
    pub const INITIAL: Self = Self {
        corners: Corners::splat(CornerState::INITIAL),
    };

    /// One tick; returns whether low damping is wanted at each corner.
    pub fn step(
        &mut self,
        parameters: &Parameters,
        estimate: &Estimate,
        displacement_m: &Corners<f32>,
    ) -> Corners<bool> {
        for (corner, state) in self.corners.iter_mut() {
            let acceleration = acceleration_at(parameters.place_m[corner], estimate);
            let velocity = parameters.body_velocity.step(&mut state.velocity_m_s, acceleration);
            state.step(
                parameters,
                estimate.strut_speed_m_s[corner],
                acceleration,
                velocity,
                estimate.vertical_mean_square,
                displacement_m[corner],
            );
        }
        self.corners.map(|state| !state.high)
    }
}

/// Vertical acceleration of the body, m/s2, at a place ahead of and to the left of its centre of gravity, m.
fn acceleration_at((ahead_m, left_m): (f32, f32), estimate: &Estimate) -> f32 {
    estimate.vertical_acceleration_m_s2 + left_m * estimate.roll_acceleration_rad_s2
        - ahead_m * estimate.pitch_acceleration_rad_s2
}

impl CornerState {
    const INITIAL: Self = Self {
        velocity_m_s: 0.0,
        speed_m_s: 0.0,
        acceleration_m_s2: 0.0,
        high: false,
    };

    /// One tick, from the strut's speed, the body's acceleration and velocity over it, the vertical running mean square and the
    /// displacement.
    #[inline(never)]
    fn step(
        &mut self,
        parameters: &Parameters,
        speed: f32,
        acceleration: f32,
        velocity: f32,
        vertical_mean_square: f32,
        displacement_m: f32,
    ) {
        let band = &parameters.body_band;
        let extension = -band.step(&mut self.speed_m_s, speed);
        let body_acceleration = band.step(&mut self.acceleration_m_s2, acceleration);
        let least = |share_2: f32, least_2| at_least(share_2 * vertical_mean_square, least_2);
        let by_velocity = (velocity, least(parameters.body_velocity_share_2, LEAST_VELOCITY_2));
        let by_acceleration = (
            body_acceleration,
            least(parameters.body_acceleration_share_2, LEAST_ACCELERATION_2),
        );
        let near_resonance = body_acceleration * body_acceleration < CROSSOVER_2 * velocity * velocity;
        let (body, least_2) = match parameters.policy {
            DamperPolicy::Low => (0.0, f32::MAX),
            DamperPolicy::Karnopp => by_velocity,
            DamperPolicy::ShAdd if near_resonance => by_velocity,
            DamperPolicy::HoelscherHuang | DamperPolicy::ShAdd => by_acceleration,
        };
        let (jounce, rebound) = NEAR_STOP_M;
        let near_stop = (displacement_m > jounce && speed > 0.0) || (displacement_m < -rebound && speed < 0.0);
        let opposes = if body < 0.0 { -extension } else { extension };
        if near_stop {
            self.high = true;
        } else if body * body < least_2 || opposes < -DEAD_BAND_M_S {
            self.high = false;
        } else if opposes > DEAD_BAND_M_S {
            self.high = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settled(policy: DamperPolicy, extension_m_s: f32, velocity: f32, acceleration: f32, x_m: f32) -> bool {
        let parameters = parameters(policy);
        let mut state = CornerState::INITIAL;
        for _ in 0..100 {
            state.step(&parameters, -extension_m_s, acceleration, velocity, 0.0, x_m);
        }
        state.high
    }

    fn parameters(policy: DamperPolicy) -> Parameters {
        let tuning = Tuning {
            policy,
            ..Tuning::default()
        };
        Parameters::new(&VehicleDescription::default(), &tuning)
    }

    /// Struts half a metre to the side, 1.389 m ahead and 1.405 m behind: a rigid body. The integral of a constant acceleration
    /// levels off at that times the time constant of 0.2 Hz, 0.8 s.
    #[test]
    fn the_body_moves_differently_over_each_strut() {
        let parameters = parameters(DamperPolicy::Low);
        let estimate = Estimate {
            vertical_acceleration_m_s2: 1.0,
            roll_acceleration_rad_s2: 0.4,
            pitch_acceleration_rad_s2: 0.2,
            ..Estimate::default()
        };
        let expected = [
            1.0 + 0.2 - 0.2778,
            1.0 - 0.2 - 0.2778,
            1.0 + 0.2 + 0.281,
            1.0 - 0.2 + 0.281,
        ];
        let mut state = State::INITIAL;
        for _ in 0..2_000 {
            state.step(&parameters, &estimate, &Corners::default());
        }
        let there = parameters.place_m.zip(state.corners).into_array();
        for ((place_m, corner), expected) in there.into_iter().zip(expected) {
            let found = acceleration_at(place_m, &estimate);
            assert!((found - expected).abs() < 1e-3, "{found}, expected {expected}");
            let velocity = expected / (2.0 * core::f32::consts::PI * 0.2);
            assert!(
                (corner.velocity_m_s - velocity).abs() < 0.01,
                "{} m/s, expected {velocity}",
                corner.velocity_m_s
            );
        }
    }

    #[test]
    fn quadrants_of_both_rules() {
        for w in [0.3, -0.3] {
            for v in [0.4, -0.4] {
                assert_eq!(settled(DamperPolicy::Karnopp, w, v, 0.0, 0.0), w * v > 0.0);
                assert_eq!(settled(DamperPolicy::HoelscherHuang, w, 0.0, 5.0 * v, 0.0), w * v > 0.0);
                assert!(!settled(DamperPolicy::Low, w, v, 5.0 * v, 0.0));
                // The body's velocity decides where it is large against the acceleration, and the acceleration else.
                assert_eq!(settled(DamperPolicy::ShAdd, w, v, -5.0 * v, 0.0), w * v > 0.0);
                assert_eq!(settled(DamperPolicy::ShAdd, w, 0.1 * v, -5.0 * v, 0.0), w * v < 0.0);
            }
        }
    }

    #[test]
    fn a_quiet_body_rests_the_valves_and_a_near_stop_does_not() {
        assert!(!settled(DamperPolicy::Karnopp, 0.3, 0.05, 0.0, 0.0));
        assert!(settled(DamperPolicy::Karnopp, -0.3, 0.0, 0.0, 0.07));
        assert!(!settled(DamperPolicy::Karnopp, 0.3, 0.0, 0.0, 0.07));
    }

    /// Names lead back to policies, and each value outside its range is named.
    #[test]
    fn policies_have_names_and_values_have_ranges() {
        for name in <DamperPolicy as strum::VariantNames>::VARIANTS {
            assert_eq!(name.parse().map(DamperPolicy::name), Ok(*name));
        }
        assert_eq!(Tuning::default().check(), Ok(()));
        let velocity = Tuning {
            body_velocity_share_s: -0.1,
            ..Tuning::default()
        };
        let name = velocity.check().map_err(|error| error.name);
        assert_eq!(name, Err("tuning.strategy.ride_handling.dampers.body_velocity_share_s"));
        let acceleration = Tuning {
            body_acceleration_share: 101.0,
            ..Tuning::default()
        };
        let name = acceleration.check().map_err(|error| error.name);
        assert_eq!(
            name,
            Err("tuning.strategy.ride_handling.dampers.body_acceleration_share")
        );
    }

    #[test]
    fn near_resonance_the_velocity_decides_and_above_it_the_acceleration() {
        // 11.9 rad/s: 15 m/s2 of 2 m/s is nearer to the resonance, 30 m/s2 is above it.
        assert!(settled(DamperPolicy::ShAdd, 0.3, 2.0, -15.0, 0.0));
        assert!(!settled(DamperPolicy::ShAdd, 0.3, 2.0, -30.0, 0.0));
    }

    #[test]
    fn near_each_stop_the_damping_is_high_while_the_strut_moves_on_towards_it() {
        for (x_m, extension_m_s, high) in [
            (0.07, -0.3, true),
            (0.07, 0.3, false),
            (0.05, -0.3, false),
            (-0.12, 0.3, true),
            (-0.12, -0.3, false),
            (-0.10, 0.3, false),
        ] {
            assert_eq!(
                settled(DamperPolicy::Karnopp, extension_m_s, 0.0, 0.0, x_m),
                high,
                "{x_m} m, {extension_m_s} m/s"
            );
        }
    }

    /// Within 0.02 m/s nothing changes, and beyond it on the other side the damping is low again.
    #[test]
    fn the_relative_speed_has_a_dead_band() {
        let parameters = parameters(DamperPolicy::Karnopp);
        let mut state = State::INITIAL;
        let mut low = |extension_m_s: f32| {
            let mut last = Corners::splat(false);
            for _ in 0..100 {
                for corner in state.corners.values_mut() {
                    corner.velocity_m_s = 0.4;
                }
                let estimate = Estimate {
                    strut_speed_m_s: Corners::splat(-extension_m_s),
                    ..Estimate::default()
                };
                last = state.step(&parameters, &estimate, &Corners::default());
            }
            last
        };
        for (extension_m_s, is_low) in [
            (0.01, true),
            (0.03, false),
            (0.01, false),
            (-0.01, false),
            (-0.03, true),
            (-0.01, true),
        ] {
            assert_eq!(low(extension_m_s), Corners::splat(is_low), "{extension_m_s} m/s");
        }
    }
}
