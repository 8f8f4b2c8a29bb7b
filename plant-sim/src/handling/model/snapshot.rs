//! The state of the vehicle on struts as data: to go back to a moment, or to go on in another process.

use nalgebra::{Matrix3, Vector3};
use oleo_interface::{Axles, Corners};
use serde::{Deserialize, Serialize};

use super::HandlingVehicle;
use crate::handling::attitude::Attitude;
use crate::handling::axle_place::AxleCoordinates;
use crate::handling::dynamics::Accelerations;
use crate::handling::steering::SteeringState;
use crate::handling::wheel::{ContactState, WheelState};
use crate::vehicle::StrutElementSnapshot;

/// Everything that a vehicle carries from one step to the next. A vehicle of the same parameters on the same road that is put into this state goes
/// on with the same bits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VehicleSnapshot {
    steps: u64,
    rest_height_m: f64,
    position: Vector3<f64>,
    velocity: Vector3<f64>,
    attitude: Attitude,
    rotation: Matrix3<f64>,
    angular: Vector3<f64>,
    axles: Axles<AxleCoordinates>,
    axle_rates: Axles<AxleCoordinates>,
    spin: Corners<f64>,
    twist: f64,
    twist_rate: f64,
    contacts: Corners<ContactState>,
    steering: SteeringState,
    acceleration: Accelerations,
    wheels: Corners<WheelState>,
    struts: Corners<StrutElementSnapshot>,
}

impl HandlingVehicle {
    /// The present state.
    #[must_use]
    pub fn snapshot(&self) -> VehicleSnapshot {
        VehicleSnapshot {
            steps: self.steps,
            rest_height_m: self.rest_height_m,
            position: self.position,
            velocity: self.velocity,
            attitude: self.attitude,
            rotation: self.rotation,
            angular: self.angular,
            axles: self.axles,
            axle_rates: self.axle_rates,
            spin: self.spin,
            twist: self.twist,
            twist_rate: self.twist_rate,
            contacts: self.contacts,
            steering: self.steering,
            acceleration: self.acceleration,
            wheels: self.wheels,
            struts: self.suspension.snapshot(),
        }
    }

    /// Puts the vehicle into a state that it, or another vehicle of the same parameters on the same road, was in.
    pub fn restore(&mut self, kept: &VehicleSnapshot) {
        self.steps = kept.steps;
        self.rest_height_m = kept.rest_height_m;
        self.position = kept.position;
        self.velocity = kept.velocity;
        self.attitude = kept.attitude;
        self.rotation = kept.rotation;
        self.angular = kept.angular;
        self.axles = kept.axles;
        self.axle_rates = kept.axle_rates;
        self.spin = kept.spin;
        self.twist = kept.twist;
        self.twist_rate = kept.twist_rate;
        self.contacts = kept.contacts;
        self.steering = kept.steering;
        self.acceleration = kept.acceleration;
        self.wheels = kept.wheels;
        self.suspension.restore(&kept.struts);
    }
}
