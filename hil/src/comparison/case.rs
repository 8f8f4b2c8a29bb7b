//! One drive: road, manoeuvre, driver.

use oleo_plant_sim::course::{DriverStyle, LaneChange, Manoeuvre};

/// One drive that every setting makes alike.
#[derive(Clone, Debug, PartialEq)]
pub struct DriveCase {
    /// Built-in road or path of a file.
    pub road: String,
    /// What is driven, and how fast.
    pub manoeuvre: Manoeuvre,
    /// Who drives.
    pub driver: DriverStyle,
    /// Of the road and of the sensors' noise.
    pub seed: u64,
    /// When the manoeuvre begins, s: [`drive::beginning_s`](super::beginning_s) tells.
    pub begins_s: Option<f64>,
}

/// Time driven straight ahead before a manoeuvre begins, s: start-up, and time for the controller to know the road.
pub const RUN_UP_S: f64 = 8.0;

impl DriveCase {
    /// Straight ahead, m/s and s.
    pub fn straight(road: &str, speed_m_s: f64, duration_s: f64, seed: u64) -> Self {
        let manoeuvre = Manoeuvre::Straight { speed_m_s, duration_s };
        Self::new(road, manoeuvre, DriverStyle::Eased, seed)
    }

    /// A lane change of ISO 3888 after the run-up.
    pub fn lane_change(road: &str, kind: LaneChange, speed_m_s: f64, driver: DriverStyle, seed: u64) -> Self {
        let manoeuvre = Manoeuvre::LaneChange {
            kind,
            speed_m_s,
            entry_m: RUN_UP_S * speed_m_s,
            duration_s: None,
        };
        Self::new(road, manoeuvre, driver, seed)
    }

    /// Everything in one drive: straight ahead, the lane change of ISO 3888-2 at 60 km/h, and straight ahead again, on one road.
    pub fn mixed(road: &str, seed: u64) -> Self {
        let speed_m_s = 60.0 / 3.6;
        let manoeuvre = Manoeuvre::LaneChange {
            kind: LaneChange::ObstacleAvoidance,
            speed_m_s,
            entry_m: 10.0 * speed_m_s,
            duration_s: Some(26.0),
        };
        Self::new(road, manoeuvre, DriverStyle::Eased, seed)
    }

    /// A step of steer of ISO 7401 after the run-up, for `angle_rad` at the front wheels.
    pub fn step_steer(road: &str, speed_m_s: f64, angle_rad: f64, seed: u64) -> Self {
        let manoeuvre = Manoeuvre::StepSteer {
            speed_m_s,
            angle_rad,
            at_s: RUN_UP_S,
            duration_s: RUN_UP_S + 4.0,
        };
        Self::new(road, manoeuvre, DriverStyle::Eased, seed)
    }

    fn new(road: &str, manoeuvre: Manoeuvre, driver: DriverStyle, seed: u64) -> Self {
        Self {
            road: road.into(),
            manoeuvre,
            driver,
            seed,
            begins_s: None,
        }
    }

    /// Whether the vehicle only drives straight ahead.
    pub fn is_straight(&self) -> bool {
        matches!(self.manoeuvre, Manoeuvre::Straight { .. })
    }

    /// Name of the manoeuvre in tables and files.
    pub fn manoeuvre_name(&self) -> &'static str {
        match self.manoeuvre {
            Manoeuvre::Straight { .. } => "straight",
            Manoeuvre::LaneChange {
                kind: LaneChange::Severe,
                ..
            } => "iso-3888-1",
            Manoeuvre::LaneChange {
                kind: LaneChange::ObstacleAvoidance,
                ..
            } => "iso-3888-2",
            Manoeuvre::StepSteer { .. } => "step-steer",
            Manoeuvre::ConstantRadius { .. } => "constant-radius",
            Manoeuvre::Braking { .. } => "braking",
            Manoeuvre::Acceleration { .. } => "acceleration",
        }
    }

    /// Name of the driver for a lane change; nothing else depends on it.
    pub fn driver_name(&self) -> &'static str {
        match self.manoeuvre {
            Manoeuvre::LaneChange { .. } => self.driver.key(),
            _ => "",
        }
    }
}
