//! A wheel on the ground: contact, slip with relaxation, and the forces on axle and wheel.
//!
//! Contact. A thin disc of free radius R0 on a plane (see `ground`): the tyre's force acts along the plane's normal, its
//! deflection is `R0 cos(camber) - distance of the wheel centre from the plane`, spring and damper push and never pull.
//! With camber the point of contact moves with the disc.
//!
//! Slip. Contact deflections u (along) and v (across) obey Pacejka's first-order lag (2002, 7.2; the restoring forces' slips
//! are `u / sigma`, `v / sigma`):
//!
//! ```text
//! u' = -Vsx - |Vx| u / sigma_kappa       kappa = u / sigma_kappa
//! v' =  Vsy - |Vx| v / sigma_alpha   tan(alpha) = v / sigma_alpha
//! ```
//!
//! solved implicitly over the step, so that standing still and walking pace are no special case; below 2.5 m/s his
//! added damping (equation 8.128: 770 N s/m, faded in with a cosine) keeps the stopped wheel from ringing.

use core::f64::consts::PI;
use serde::{Deserialize, Serialize};

use libm::{atan, cos};
use nalgebra::{Matrix3, Vector3};

use super::axle_place::AxlePlace;
use super::dynamics::Wrench;
use super::ground::Plane;
use super::guide::Guide;
use super::magic_formula::MagicFormula;

/// Below this speed slip damping is added, m/s, and how much of it at rest, N s/m.
const LOW_SPEED_M_S: f64 = 2.5;
const LOW_SPEED_DAMPING_N_S_M: f64 = 770.0;
/// Slips are kept within what any tyre file is meant for.
const SLIP_LIMIT: f64 = 1.5;
/// Spin at which a brake has its full torque, rad/s: 0.2 m/s.
const BRAKED_RAD_S: f64 = 0.5;
/// A disc that lies this flat rolls no more (cosine of camber).
const FLATTEST: f64 = 0.25;

/// A wheel with its tyre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tyre {
    pub(super) stiffness_n_m: f64,
    pub(super) damping_n_s_m: f64,
    pub(super) free_radius_m: f64,
}

/// What a wheel does now.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct WheelState {
    /// Force along the road's normal, N; 0 off the ground.
    pub load_n: f64,
    /// Forces in the road's plane, N: along the wheel, to its left.
    pub longitudinal_n: f64,
    /// To the left, N.
    pub lateral_n: f64,
    /// Moment of the tyre about the road's normal, N m, turning left positive.
    pub aligning_n_m: f64,
    /// Longitudinal slip, driving positive.
    pub slip: f64,
    /// Slip angle, rad, sliding left positive.
    pub slip_angle_rad: f64,
    /// Camber against the road, rad, leaning right positive.
    pub camber_rad: f64,
    /// Spin, rad/s, rolling ahead positive.
    pub spin_rad_s: f64,
    /// Height of the wheel centre, world, m.
    pub centre_height_m: f64,
    /// Road below the wheel, world, m.
    pub road_height_m: f64,
}

/// Contact deflections: the tyre's memory.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct ContactState {
    along_m: f64,
    across_m: f64,
}

/// Where and how a wheel moves, body axes but for `height_m`.
pub(super) struct WheelMotion {
    pub(super) centre: Vector3<f64>,
    /// Unit vector along the wheel's axis, to the left.
    pub(super) axis: Vector3<f64>,
    /// Velocity of the wheel centre, and angular velocity of the axle.
    pub(super) velocity: Vector3<f64>,
    pub(super) turn: Vector3<f64>,
    /// Spin about the wheel's axis, rad/s, against the world and not against the axle.
    pub(super) spin: f64,
    /// Height of the centre in the world, m.
    pub(super) height_m: f64,
}

/// Torque on a wheel about its axis, N m, both 0 or more in their own sense.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct WheelTorque {
    /// Turns the wheel ahead.
    pub(super) drive_n_m: f64,
    /// Holds it, whichever way it turns.
    pub(super) brake_n_m: f64,
}

impl WheelTorque {
    /// Torque on a wheel that turns with `spin` rad/s. A brake fades in over [`BRAKED_RAD_S`], so that it holds a standing
    /// wheel instead of turning it back.
    fn at(&self, spin: f64) -> f64 {
        self.drive_n_m - self.brake_n_m * (spin / BRAKED_RAD_S).clamp(-1.0, 1.0)
    }
}

/// What the wheel passes on.
pub(super) struct WheelLoads {
    pub(super) state: WheelState,
    /// On the axle, without the part that spins the wheel.
    pub(super) wrench: Wrench,
    /// On the wheel's spin, N m.
    pub(super) spin_torque_n_m: f64,
}

impl Tyre {
    /// Moves the tyre through a step of `step_s` to a motion over `plane`, with `torque` at the wheel; `attitude` turns body
    /// into world axes.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn roll(
        &self,
        formula: &MagicFormula,
        contact: &mut ContactState,
        motion: &WheelMotion,
        plane: &Plane,
        attitude: &Matrix3<f64>,
        axle: (&AxlePlace, &Guide),
        torque: WheelTorque,
        step_s: f64,
    ) -> WheelLoads {
        let applied_n_m = torque.at(motion.spin);
        let normal = attitude.tr_mul(&plane.normal);
        let distance_m = (motion.height_m - plane.height_m) * plane.normal.z;
        let sin_camber = motion.axis.dot(&normal).clamp(-1.0, 1.0);
        let cos_camber = (1.0 - sin_camber * sin_camber).sqrt().max(FLATTEST);
        let deflection_m = self.free_radius_m * cos_camber - distance_m;
        let load_n = if deflection_m > 0.0 {
            let rate_m_s = -motion.velocity.dot(&normal);
            (self.stiffness_n_m * deflection_m + self.damping_n_s_m * rate_m_s).max(0.0)
        } else {
            0.0
        };
        let mut state = WheelState {
            load_n,
            camber_rad: libm::asin(sin_camber),
            spin_rad_s: motion.spin,
            centre_height_m: motion.height_m,
            road_height_m: plane.height_m,
            ..WheelState::default()
        };
        let reaction = motion.axis * -applied_n_m;
        if load_n <= 0.0 {
            *contact = ContactState::default();
            let wrench = Wrench::on_axle(axle, Vector3::zeros(), motion.centre, reaction);
            return WheelLoads {
                state,
                wrench,
                spin_torque_n_m: applied_n_m,
            };
        }

        // Directions in the road's plane, and the point of contact below the disc.
        let ahead = motion.axis.cross(&normal) / cos_camber;
        let left = normal.cross(&ahead);
        let down = (normal - motion.axis * sin_camber) * (distance_m / (cos_camber * cos_camber));
        let point = motion.centre - down;
        // The axle's own turning about the wheel's axis does not roll the wheel: the bearing is between them.
        let across = motion.turn - motion.axis * motion.turn.dot(&motion.axis);
        let velocity = motion.velocity - across.cross(&down);

        let tyre = formula.at(load_n, state.camber_rad, self.free_radius_m);
        let radius_m = formula.rolling_radius_m(self.free_radius_m, deflection_m, self.stiffness_n_m);
        let speed = velocity.dot(&ahead);
        let sliding_along = speed - radius_m * motion.spin;
        let sliding_across = velocity.dot(&left);
        let (sigma_along, sigma_across) = tyre.relaxation_m();
        let rolled = step_s * speed.abs();
        let lag = |deflection: f64, sliding: f64, sigma: f64| {
            let limit = SLIP_LIMIT * sigma;
            ((deflection + step_s * sliding) / (1.0 + rolled / sigma)).clamp(-limit, limit)
        };
        contact.along_m = lag(contact.along_m, -sliding_along, sigma_along);
        contact.across_m = lag(contact.across_m, sliding_across, sigma_across);
        let damping = if speed.abs() < LOW_SPEED_M_S {
            0.5 * LOW_SPEED_DAMPING_N_S_M * (1.0 + cos(PI * speed / LOW_SPEED_M_S))
        } else {
            0.0
        };
        state.slip = contact.along_m / sigma_along - damping / tyre.slip_stiffness_n() * sliding_along;
        let tangent = contact.across_m / sigma_across + damping / tyre.cornering_stiffness_n_rad() * sliding_across;
        state.slip = state.slip.clamp(-SLIP_LIMIT, SLIP_LIMIT);
        state.slip_angle_rad = atan(tangent);

        let forces = tyre.forces(state.slip, state.slip_angle_rad);
        state.longitudinal_n = forces.longitudinal_n;
        state.lateral_n = forces.lateral_n;
        state.aligning_n_m = forces.aligning_n_m;
        let force = normal * load_n + ahead * forces.longitudinal_n + left * forces.lateral_n;
        // Resistance fades in over 0.1 m/s, so that a standing wheel stands.
        let rolling_n_m = -tyre.rolling_resistance_n_m() * (speed / 0.1).clamp(-1.0, 1.0);
        let aligning = normal * forces.aligning_n_m;
        // The wheel keeps what turns it about its axis; the axle gets the rest and the reaction of the drive.
        let spinning = motion.axis.dot(&(aligning - down.cross(&force)));
        let wrench = Wrench::on_axle(axle, force, point, aligning - motion.axis * spinning + reaction);
        WheelLoads {
            state,
            wrench,
            spin_torque_n_m: applied_n_m + spinning + rolling_n_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::handling::HandlingParameters;
    use crate::handling::assembly::masses;
    use crate::handling::axle_place::AxleCoordinates;
    use crate::vehicle::VehicleParameters;

    /// A wheel under its static load at `speed` with `spin`, on an axle that turns by `turn`; its state after the slip has
    /// settled, and the torque on its spin.
    fn rolling(speed: f64, spin: f64, turn: Vector3<f64>, torque: WheelTorque) -> (WheelState, f64) {
        let (vehicle, handling) = (VehicleParameters::defender110(), HandlingParameters::defender110());
        let masses = masses(&vehicle, &handling);
        let axle = &masses.axles.rear;
        let place = axle.place(AxleCoordinates::default());
        let tyre = Tyre {
            stiffness_n_m: 240_000.0,
            damping_n_s_m: 0.0,
            free_radius_m: 0.403,
        };
        let motion = WheelMotion {
            centre: place.mass_centre + place.left * axle.half_track_m,
            axis: place.left,
            velocity: Vector3::new(speed, 0.0, 0.0),
            turn,
            spin,
            height_m: 0.382,
        };
        let plane = Plane {
            height_m: 0.0,
            normal: Vector3::new(0.0, 0.0, 1.0),
        };
        let mut contact = ContactState::default();
        let mut last = None;
        for _ in 0..2000 {
            let loads = tyre.roll(
                &handling.tyre,
                &mut contact,
                &motion,
                &plane,
                &Matrix3::identity(),
                (&place, &axle.guide),
                torque,
                0.001,
            );
            last = Some((loads.state, loads.spin_torque_n_m));
        }
        last.unwrap()
    }

    /// The bearing is between axle and wheel: an axle that pitches does not turn the wheel over the road.
    #[test]
    fn a_pitching_axle_does_not_roll_the_wheel() {
        let tyre = HandlingParameters::defender110().tyre;
        let spin = 15.0 / tyre.rolling_radius_m(0.403, 0.021, 240_000.0);
        let (still, _) = rolling(15.0, spin, Vector3::zeros(), WheelTorque::default());
        let (pitching, _) = rolling(15.0, spin, Vector3::new(0.0, 1.0, 0.0), WheelTorque::default());
        assert!(still.longitudinal_n.abs() < 1.0, "{still:?}");
        assert_eq!(still.longitudinal_n, pitching.longitudinal_n);
    }

    /// A brake takes spin whichever way the wheel turns, and turns no standing wheel.
    #[test]
    fn a_brake_opposes_the_spin() {
        let brake = WheelTorque {
            drive_n_m: 0.0,
            brake_n_m: 500.0,
        };
        for (spin, expected) in [(40.0, -500.0), (-40.0, 500.0), (0.0, 0.0), (0.25, -250.0)] {
            assert_eq!(brake.at(spin), expected);
        }
        let (standing, torque) = rolling(0.0, 0.0, Vector3::zeros(), brake);
        assert_eq!((standing.longitudinal_n, torque), (0.0, 0.0));
    }
}
