//! Which traces are drawn.

use super::differences::ComparedTrace;

/// Traces of a vehicle that are drawn unless others are asked for.
const USUAL: [&str; 20] = [
    "roll_rad",
    "lateral_acceleration_m_s2",
    "driver_acceleration_m_s2",
    "rear_left_acceleration_m_s2",
    "heave_m",
    "pitch_rad",
    "yaw_rate_rad_s",
    "steer_rad",
    "lateral_m",
    "speed_m_s",
    "displacement_front_left_m",
    "displacement_front_right_m",
    "displacement_rear_left_m",
    "displacement_rear_right_m",
    "force_front_left_N",
    "force_rear_left_N",
    "wheel_load_front_left_N",
    "wheel_load_rear_left_N",
    "front_valves_open",
    "rear_valves_open",
];

/// The traces that are drawn.
pub enum Drawn {
    /// Those of [`USUAL`] that there are, or all if there are none of these.
    Usual,
    /// The named ones.
    Named(Vec<String>),
}

impl Drawn {
    /// The named ones, if there are any.
    pub fn of(names: &[String]) -> Self {
        match names {
            [] => Self::Usual,
            names => Self::Named(names.to_vec()),
        }
    }

    /// The drawn ones of these.
    pub fn among<'a>(&self, traces: &'a [ComparedTrace]) -> Vec<&'a ComparedTrace> {
        let of = |names: &dyn Fn(&str) -> bool| traces.iter().filter(|trace| names(&trace.name)).collect::<Vec<_>>();
        match self {
            Self::Named(names) => of(&|name| names.iter().any(|named| named == name)),
            Self::Usual => {
                let usual: Vec<&ComparedTrace> = USUAL.iter().flat_map(|usual| of(&|name| name == *usual)).collect();
                if usual.is_empty() { of(&|_| true) } else { usual }
            }
        }
    }
}
