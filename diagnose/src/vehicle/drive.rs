//! What a drive recorded.

use oleo_interface::{Corners, StrutPressures, StrutValves};

/// One drive: what was recorded of every strut, all at the same instants.
#[derive(Debug, Clone)]
pub struct Drive {
    /// Name of the drive, such as the name of its log without `.log`.
    pub name: String,
    /// Whether the drive is the first of its log. Such a drive begins at rest; that of a later one must be seen.
    pub is_first: bool,
    /// Time between two samples, s.
    pub period_s: f64,
    /// The four struts. All series have the same length.
    pub struts: Corners<StrutSamples>,
    /// The inertial unit; empty or NaN where there is none.
    pub inertial: InertialSamples,
}

impl Drive {
    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.struts.values().map(|s| s.displacement_m.len()).min().unwrap_or(0)
    }

    /// True without samples.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The samples of an inertial unit, in its own axes. What was not received is NaN.
#[derive(Debug, Clone, Default)]
pub struct InertialSamples {
    /// Specific force along x, y, z, m/s2.
    pub specific_force_m_s2: [Vec<f64>; 3],
    /// Angular velocity about x, y, z, rad/s.
    pub rate_rad_s: [Vec<f64>; 3],
}

impl InertialSamples {
    /// Whether the unit has said something.
    #[must_use]
    pub fn is_there(&self) -> bool {
        let all = self.specific_force_m_s2.iter().chain(&self.rate_rad_s);
        all.flatten().any(|value| value.is_finite())
    }
}

/// The samples of one strut. What was not received is NaN or `None`.
#[derive(Debug, Clone, Default)]
pub struct StrutSamples {
    /// Displacement, m, compression positive.
    pub displacement_m: Vec<f64>,
    /// Gauge pressures p1 to p4, Pa.
    pub pressure_pa: [Vec<f64>; 4],
    /// Switching signals that hold from this sample to the next.
    pub valves: Vec<Option<StrutValves<bool>>>,
}

/// Steps to which the readings of a strut are rounded on the bus; 0 where they are not rounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    /// Step of the displacement, m.
    pub displacement_m: f64,
    /// Steps of the pressures, Pa.
    pub pressure_pa: StrutPressures<f64>,
}
