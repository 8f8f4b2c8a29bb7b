//! Motion of the body and the struts from displacements and pressures alone.

use crate::valves::CORNERS;

/// Estimated motion. Body quantities are about its centre of gravity, x forward, y left, z up; struts compression positive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// Strut speed, m/s, compression positive.
    pub strut_speed_m_s: [f32; CORNERS],
    /// Heave of the body relative to the axles, m, up positive.
    pub heave_m: f32,
    /// Roll of the body relative to the axles, rad, right side down positive.
    pub roll_rad: f32,
    /// Pitch of the body relative to the axles, rad, nose down positive.
    pub pitch_rad: f32,
    /// Rate of `roll_rad`, rad/s.
    pub roll_rate_rad_s: f32,
    /// Vertical acceleration of the body, m/s2, up positive.
    pub vertical_acceleration_m_s2: f32,
    /// Roll acceleration of the body, rad/s2.
    pub roll_acceleration_rad_s2: f32,
    /// Pitch acceleration of the body, rad/s2.
    pub pitch_acceleration_rad_s2: f32,
    /// Surrogate of the lateral acceleration, m/s2, to the left positive.
    pub lateral_acceleration_m_s2: f32,
    /// Running mean square of the lateral surrogate, m2/s4.
    pub lateral_mean_square: f32,
    /// Running mean square of the vertical acceleration, m2/s4.
    pub vertical_mean_square: f32,
}
