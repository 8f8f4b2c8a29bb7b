//! One instant of a drive: everything that can be measured of the vehicle, at the controller's tick.

use oleo_interface::{Corners, StrutValves};

use crate::vehicle::{SeatAcceleration, Seats};

/// Switching signals of the twelve valves, `true` open.
pub type Signals = Corners<StrutValves<bool>>;

/// One instant. Roll is positive with the left side up, pitch with the nose down; yaw, steer and lateral values to the left.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sample {
    /// Time since the start, s.
    pub time_s: f64,
    /// Centre of mass of the body ahead of the start, m.
    pub station_m: f64,
    /// Centre of mass of the body to the left of the start, m.
    pub lateral_m: f64,
    /// Centre of mass of the body above its height at rest, m.
    pub heave_m: f64,
    /// Heading of the body, rad, positive to the left.
    pub yaw_rad: f64,
    /// Pitch of the body, rad.
    pub pitch_rad: f64,
    /// Roll of the body, rad, within +-pi.
    pub roll_rad: f64,
    /// Speed along the heading, m/s.
    pub speed_m_s: f64,
    /// Angle between velocity and heading, rad.
    pub side_slip_rad: f64,
    /// Yaw rate of the body, rad/s, positive to the left.
    pub yaw_rate_rad_s: f64,
    /// Horizontal acceleration of the body's centre of mass along the heading, m/s2.
    pub longitudinal_acceleration_m_s2: f64,
    /// Horizontal acceleration of the body's centre of mass to the left of the heading, m/s2.
    pub lateral_acceleration_m_s2: f64,
    /// Vertical acceleration of the body's centre of mass, m/s2.
    pub vertical_acceleration_m_s2: f64,
    /// Angle of the steering wheel over the steering ratio, rad.
    pub steer_rad: f64,
    /// Angle of the front wheels against the body, rad.
    pub wheel_steer_rad: f64,
    /// Force of the road on each wheel along its normal, N; 0 off the ground.
    pub wheel_load_n: Corners<f64>,
    /// Displacement of the struts or springs, m, compression positive.
    pub strut_displacement_m: Corners<f64>,
    /// Force of the struts, or of springs and dampers, N, compression positive.
    pub strut_force_n: Corners<f64>,
    /// What accelerometers on the seats read.
    pub seat: Seats<SeatAcceleration>,
    /// Middle of the front axle above its height at rest, m.
    pub front_axle_heave_m: f64,
    /// Roll of the front axle, rad.
    pub front_axle_roll_rad: f64,
    /// Switching signals of the valves from this instant on; all closed for a suspension that has none.
    pub valves: Signals,
}
