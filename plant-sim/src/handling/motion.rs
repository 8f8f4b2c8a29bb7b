//! Inputs of the vehicle from its driver, and its observable motion, as plain numbers in world axes.

/// What driver or test asks of the vehicle in a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Controls {
    /// Steer angle wanted: angle of the steering wheel over the steering ratio, rad, left positive; limited in angle and rate
    /// by the vehicle.
    pub steer_rad: f64,
    /// Drive force wanted of all wheels together, N, 0 or more.
    pub drive_force_n: f64,
    /// Brake force wanted of all wheels together, N, 0 or more.
    pub brake_force_n: f64,
}

/// Motion of the body in the world.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct HandlingMotion {
    /// Centre of mass: ahead (station), left, up from its height at rest; m.
    pub position_m: [f64; 3],
    /// The point of the body that lies on the road below its centre of mass at rest: where the vehicle is, however the body
    /// rolls; ahead and left, m.
    pub foot_m: [f64; 2],
    /// Velocity of the centre of mass in the world, m/s.
    pub velocity_m_s: [f64; 3],
    /// Heading, left positive, rad.
    pub yaw_rad: f64,
    /// Nose down positive, rad.
    pub pitch_rad: f64,
    /// Left side up positive, rad, within +-pi.
    pub roll_rad: f64,
    /// Angular velocity about the body's x, y, z, rad/s.
    pub rates_rad_s: [f64; 3],
    /// Angular acceleration about the body's x, y, z, rad/s2.
    pub angular_acceleration_rad_s2: [f64; 3],
    /// Horizontal speed along the heading, m/s.
    pub speed_m_s: f64,
    /// Horizontal velocity of the foot to the left of the heading, m/s.
    pub foot_lateral_m_s: f64,
    /// Horizontal acceleration along the heading, m/s2.
    pub longitudinal_acceleration_m_s2: f64,
    /// Horizontal acceleration to the left of the heading, m/s2.
    pub lateral_acceleration_m_s2: f64,
    /// Vertical acceleration in the world, m/s2.
    pub vertical_acceleration_m_s2: f64,
    /// Angle between horizontal velocity and heading, left positive, rad.
    pub side_slip_rad: f64,
}
