//! In which range a reading can be, and how fast it can change.

/// Range, and largest change within a tick, in the reading's unit.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    pub least: f32,
    pub most: f32,
    pub step: f32,
}

/// Struts have 120 mm of jounce and 180 mm of rebound travel; 6 m/s is three times the design speed (report: 2 m/s).
pub const DISPLACEMENT: Limits = Limits {
    least: -0.25,
    most: 0.25,
    step: 0.03,
};
/// To 1.75 times the pressure at full bump (report: 20 MPa). Downwards a fast rebound brings p1 to vacuum (-0.1 MPa gauge)
/// and a sensor's offset a little below; nothing is gained by a bound near that, so the limit is just above the dead
/// signal's -5 MPa. Wheel impacts through closed bypass valves change p1 by 10 MPa in a tick: only garbage is faster
/// than 20.
pub const PRESSURE: Limits = Limits {
    least: -4.9e6,
    most: 35.0e6,
    step: 20.0e6,
};
