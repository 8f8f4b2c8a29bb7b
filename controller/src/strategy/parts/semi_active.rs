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
//! Nell & Steyn's rule looks at the body as a whole and is in `nell_steyn.rs`; the stops are treated alike.
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

use super::nell_steyn;
use crate::estimate::Estimate;
use crate::filter::{LeakyIntegrator, LowPass, at_least};
use crate::plausibility::Trusted;
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
    /// High at those corners whose forces together oppose the body's heave, roll and pitch best.
    NellSteyn,
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
    /// Body acceleration below 4 Hz over the running RMS that Hoelscher and Huang's rule and Nell and Steyn's need to act, 0 to 100.
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
    combination: nell_steyn::Parameters,
}

impl Parameters {
    /// From a description and a tuning that have been checked.
    pub(crate) fn new(vehicle: &VehicleDescription, tuning: &Tuning) -> Self {
        let square = |x: f32| x * x;
        let place_m = places_m(vehicle);
        Self {
            policy: tuning.policy,
            place_m,
            body_velocity: LeakyIntegrator::from_corner_hz(0.2),
            // Body frequencies only: the valves cannot follow the wheel.
            body_band: LowPass::from_corner_hz(4.0),
            body_velocity_share_2: square(tuning.body_velocity_share_s),
            body_acceleration_share_2: square(tuning.body_acceleration_share),
            combination: nell_steyn::Parameters::new(vehicle, &place_m, tuning.body_acceleration_share),
        }
    }
}

/// Places of the struts ahead of and to the left of the centre of gravity, m.
pub(crate) fn places_m(vehicle: &VehicleDescription) -> Corners<(f32, f32)> {
    Corners::from_fn(|corner| {
        let ahead_m = match corner.axle() {
            Axle::Front => vehicle.axle_distance_m.front,
            Axle::Rear => -vehicle.axle_distance_m.rear,
        };
        let half_m = 0.5 * vehicle.strut_spacing_m[corner.axle()];
        let left_m = if corner.side() == Side::Left { half_m } else { -half_m };
        (ahead_m, left_m)
    })
}

/// State of the four corners.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct State {
    corners: Corners<CornerState>,
    combination: nell_steyn::State,
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
        combination: nell_steyn::State::INITIAL,
    };

    /// One tick; returns whether low damping is wanted at each corner.
    pub fn step(&mut self, parameters: &Parameters, estimate: &Estimate, trusted: &Trusted) -> Corners<bool> {
        if parameters.policy == DamperPolicy::NellSteyn {
            let high = self.combination.step(&parameters.combination, estimate, trusted);
            return Corners::from_fn(|corner| {
                let speed = estimate.strut_speed_m_s[corner];
                !(high[corner] || near_stop(trusted.displacement_m[corner], speed))
            });
        }
        for (corner, state) in self.corners.iter_mut() {
            let acceleration = acceleration_at(parameters.place_m[corner], estimate);
            let velocity = parameters.body_velocity.step(&mut state.velocity_m_s, acceleration);
            state.step(
                parameters,
                estimate.strut_speed_m_s[corner],
                acceleration,
                velocity,
                estimate.vertical_mean_square,
                trusted.displacement_m[corner],
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

/// Whether a strut is near a stop and moves on towards it.
fn near_stop(displacement_m: f32, speed_m_s: f32) -> bool {
    let (jounce, rebound) = NEAR_STOP_M;
    (displacement_m > jounce && speed_m_s > 0.0) || (displacement_m < -rebound && speed_m_s < 0.0)
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
            DamperPolicy::Low | DamperPolicy::NellSteyn => (0.0, f32::MAX),
            DamperPolicy::Karnopp => by_velocity,
            DamperPolicy::ShAdd if near_resonance => by_velocity,
            DamperPolicy::HoelscherHuang | DamperPolicy::ShAdd => by_acceleration,
        };
        let opposes = if body < 0.0 { -extension } else { extension };
        if near_stop(displacement_m, speed) {
            self.high = true;
        } else if body * body < least_2 || opposes < -DEAD_BAND_M_S {
            self.high = false;
        } else if opposes > DEAD_BAND_M_S {
            self.high = true;
        }
    }
}

#[cfg(test)]
mod tests;
