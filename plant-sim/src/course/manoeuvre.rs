//! The manoeuvres of the standards with their speeds, times and dimensions.

use super::style::DriverStyle;
use super::track::Track;

/// A standard lane change between cones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LaneChange {
    /// ISO 3888-1, severe double lane change: the report's manoeuvre.
    Severe,
    /// ISO 3888-2, obstacle avoidance.
    ObstacleAvoidance,
}

/// Where in a drive that corners the vehicle is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Straight ahead, before.
    Before,
    /// In the manoeuvre.
    Cornering,
    /// Straight ahead behind the last cones.
    After,
}

/// A manoeuvre with its speeds, times and dimensions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Manoeuvre {
    /// Straight ahead at constant speed.
    Straight {
        /// Forward speed, m/s.
        speed_m_s: f64,
        /// Time to drive, s.
        duration_s: f64,
    },
    /// ISO 3888: a double lane change at constant speed.
    LaneChange {
        /// Which of the standard's two.
        kind: LaneChange,
        /// Forward speed, m/s.
        speed_m_s: f64,
        /// Station of the first cones, m: how far the vehicle drives straight ahead before.
        entry_m: f64,
        /// Time to drive, s, straight ahead in the last lane behind the cones; `None` ends the drive there.
        duration_s: Option<f64>,
    },
    /// ISO 4138, constant radius: follow a circle while the speed rises evenly.
    ConstantRadius {
        /// Radius, m, positive to the left.
        radius_m: f64,
        /// Speed at the start, m/s.
        from_m_s: f64,
        /// Speed at the end, m/s.
        to_m_s: f64,
        /// Time in which the speed rises from the first to the last, s.
        duration_s: f64,
    },
    /// ISO 7401, step of steer at constant speed: after `at_s` to `angle_rad` at the steering's highest rate, then held.
    StepSteer {
        /// Forward speed, m/s.
        speed_m_s: f64,
        /// Angle of the steering wheel over the steering ratio, rad, left positive.
        angle_rad: f64,
        /// Begin of the step, s.
        at_s: f64,
        /// Time to drive, s.
        duration_s: f64,
    },
    /// Braking from constant speed to a stop, straight ahead or (ISO 7975) in a bend with the steering wheel held as it was.
    Braking {
        /// Speed before the brakes are applied, m/s.
        speed_m_s: f64,
        /// Radius of the bend, m, positive to the left; `None` is straight ahead.
        radius_m: Option<f64>,
        /// Deceleration that the brake force is set for, m/s2; tyres and brakes may give less.
        deceleration_m_s2: f64,
        /// Begin of braking, s.
        at_s: f64,
        /// Longest time to drive, s.
        duration_s: f64,
    },
    /// Acceleration straight ahead from constant speed.
    Acceleration {
        /// Speed before the acceleration begins, m/s.
        speed_m_s: f64,
        /// Acceleration that the drive force is set for, m/s2; engine power may give less.
        acceleration_m_s2: f64,
        /// Begin of the acceleration, s.
        at_s: f64,
        /// Time to drive, s.
        duration_s: f64,
    },
}

impl Manoeuvre {
    /// Longest time that it takes, s. A lane change without a time of its own is given two and a half times what its length takes
    /// at its speed.
    pub fn duration_s(&self, track: &Track) -> f64 {
        match *self {
            Self::Straight { duration_s, .. }
            | Self::ConstantRadius { duration_s, .. }
            | Self::StepSteer { duration_s, .. }
            | Self::Braking { duration_s, .. }
            | Self::Acceleration { duration_s, .. } => duration_s,
            Self::LaneChange {
                duration_s: Some(duration_s),
                ..
            } => duration_s,
            Self::LaneChange { speed_m_s, .. } => 2.5 * track.end_m().unwrap_or(0.0) / speed_m_s.max(1.0),
        }
    }

    /// Whether the drive is over behind the last cones.
    pub fn ends_behind_cones(&self) -> bool {
        matches!(self, Self::LaneChange { duration_s: None, .. })
    }

    /// Time from which the vehicle corners, s: a lane change from a second before its first cones, since the driver looks ahead;
    /// `None` where it goes ahead all the time.
    pub fn corners_from_s(&self) -> Option<f64> {
        match *self {
            Self::LaneChange { entry_m, speed_m_s, .. } => Some((entry_m / speed_m_s - 1.0).max(0.0)),
            Self::StepSteer { at_s, .. } => Some(at_s),
            _ => self.radius_m().map(|_| 0.0),
        }
    }

    /// Speed at the start, m/s.
    pub fn initial_speed_m_s(&self) -> f64 {
        match *self {
            Self::Straight { speed_m_s, .. }
            | Self::LaneChange { speed_m_s, .. }
            | Self::StepSteer { speed_m_s, .. }
            | Self::Braking { speed_m_s, .. }
            | Self::Acceleration { speed_m_s, .. } => speed_m_s,
            Self::ConstantRadius { from_m_s, .. } => from_m_s,
        }
    }

    /// Length of road that it needs, m, and some more.
    pub fn length_m(&self, track: &Track) -> f64 {
        let fastest = match *self {
            Self::ConstantRadius { to_m_s, .. } => to_m_s,
            Self::Acceleration {
                speed_m_s,
                acceleration_m_s2,
                duration_s,
                ..
            } => speed_m_s + acceleration_m_s2 * duration_s,
            _ => self.initial_speed_m_s(),
        };
        let driven = if self.ends_behind_cones() {
            track.end_m().unwrap_or(0.0)
        } else {
            fastest * self.duration_s(track)
        };
        driven + 50.0
    }

    /// Radius of the circle that it goes round, m, positive to the left; `None` where it goes ahead.
    pub fn radius_m(&self) -> Option<f64> {
        match *self {
            Self::ConstantRadius { radius_m, .. } => Some(radius_m),
            Self::Braking { radius_m, .. } => radius_m,
            _ => None,
        }
    }

    /// The line that a driver follows in a vehicle of width `width_m`.
    pub fn track(&self, driver: DriverStyle, width_m: f64) -> Track {
        match *self {
            Self::LaneChange { kind, entry_m, .. } => match kind {
                LaneChange::Severe => Track::severe_lane_change(width_m, entry_m, driver.lane_change_line()),
                LaneChange::ObstacleAvoidance => Track::obstacle_avoidance(width_m, entry_m, driver.lane_change_line()),
            },
            _ => self.radius_m().map_or_else(Track::straight, Track::circle),
        }
    }

    /// A driver keeps to the line. Steering that is set and held leads where it leads.
    pub fn is_guided(&self, time_s: f64) -> bool {
        match *self {
            Self::StepSteer { .. } => false,
            Self::Braking {
                radius_m: Some(_),
                at_s,
                ..
            } => time_s < at_s,
            _ => true,
        }
    }
}
