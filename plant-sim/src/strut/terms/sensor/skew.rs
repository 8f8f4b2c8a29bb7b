//! `sensor_skew`: an instrument whose clock is late, `y(t) = x(t - s)`.

use super::interpolate::Places;
use crate::model_file::{Quantity, Range};
use crate::strut::motion::Motion;
use crate::strut::terms::equation::Equation;

/// Time by which a column is late, `s`; negative if it is early.
pub const SIZE: Quantity = Quantity {
    key: "sensor_skew",
    range: Range::FromTo(-1e6, 1e6),
    unit: "s",
};

/// What the instrument shows, `y`, of the truth `x`.
pub const EQUATION: Equation = Equation {
    text: "y(t) = x(t - s)",
    source: "definition of the recordings",
};

/// What the instrument shows of a true signal.
pub fn record(late_s: f64, times_s: &[f64], signal: &mut [f64]) {
    let truth = signal.to_vec();
    let mut places = Places::over(times_s);
    for (shown, t) in signal.iter_mut().zip(times_s) {
        *shown = places.find(t - late_s).of(&truth);
    }
}

/// The motion that the instrument showed late: `x(t) = y(t + s)`.
pub fn undo(late_s: f64, times_s: &[f64], motion: &mut Motion) {
    if late_s == 0.0 {
        return;
    }
    let shown = motion.segments.clone();
    let at_rest = std::iter::once(0.0);
    let displacement: Vec<f64> = (std::iter::once(motion.start_m))
        .chain(shown.iter().map(|s| s.to_m))
        .collect();
    let before: Vec<f64> = at_rest.clone().chain(shown.iter().map(|s| s.to_m_s)).collect();
    let after: Vec<f64> = shown.iter().map(|s| s.from_m_s).chain(at_rest).collect();
    let mut places = Places::over(times_s);
    let mut times = times_s.iter().map(|time| time + late_s);
    let Some(mut from) = times.next().map(|time| places.find(time)) else {
        return;
    };
    for (segment, time) in motion.segments.iter_mut().zip(times) {
        let to = places.find(time);
        segment.to_m = to.of(&displacement);
        segment.to_m_s = to.of(&before);
        segment.from_m_s = from.of(&after);
        from = to;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shows_what_was_true_a_little_earlier() {
        let t: Vec<f64> = (0..400).map(|i| 0.002 * f64::from(i)).collect();
        for late in [0.013, -0.013] {
            let mut ramp: Vec<f64> = t.iter().map(|t| 3.0 + 5.0 * t).collect();
            record(late, &t, &mut ramp);
            assert!((ramp[300] - (3.0 + 5.0 * (t[300] - late))).abs() < 1e-12);
        }
    }
}
