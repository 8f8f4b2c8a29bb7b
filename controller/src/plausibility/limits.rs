//! The range of plausible readings, and the fastest plausible change.

/// Range of a reading, both ends included, with 0 in it, and its largest change within a tick, in the reading's unit.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    pub least: f32,
    pub most: f32,
    pub step: f32,
}

impl Limits {
    /// Whether a value is within the range. NaN is not.
    pub fn hold(&self, value: f32) -> bool {
        self.hold_positive(value) || (value >= self.least && value <= self.most)
    }

    /// Whether a value is within the upper part of the range, from 0 on. It is one comparison of integers, because positive numbers
    /// compare as their bits do; the bits of a negative number or of NaN are above those of all of them.
    pub fn hold_positive(&self, value: f32) -> bool {
        value.to_bits() <= self.most.to_bits()
    }
}

/// Limits of a displacement, m. Struts have 120 mm of jounce and 180 mm of rebound travel; 6 m/s is three times the design
/// speed (report: 2 m/s).
pub const DISPLACEMENT: Limits = Limits {
    least: -0.25,
    most: 0.25,
    step: 0.03,
};
/// Limits of a pressure, Pa gauge. The highest is 1.75 times the pressure at full bump (report: 20 MPa). A fast rebound brings
/// p1 down to vacuum (-0.1 MPa) and a sensor's offset a little below; a limit near that would find nothing more, so the
/// lowest is just above the -5 MPa of a dead signal. Wheel impacts through closed bypass valves change p1 by 10 MPa in a tick;
/// only a broken signal is faster than 20 MPa.
pub const PRESSURE: Limits = Limits {
    least: -4.9e6,
    most: 35.0e6,
    step: 20.0e6,
};
