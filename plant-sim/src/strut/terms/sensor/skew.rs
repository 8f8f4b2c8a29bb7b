//! `sensor_skew`: an instrument whose clock is late, `y(t) = x(t - s)`.

use super::interpolate::{Place, Places, curvatures};
use crate::model_file::{Quantity, Range};
use crate::strut::motion::{Cubic, Motion, Segment};
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
    let curvatures = curvatures(times_s, &truth);
    let mut places = Places::over(times_s);
    for (shown, t) in signal.iter_mut().zip(times_s) {
        *shown = places.find(t - late_s).of_curved(times_s, &truth, &curvatures);
    }
}

/// The motion that the instrument showed late: `x(t) = y(t + s)`.
///
/// A straight line between two samples would have less noise than they have, so that a skew would explain noise. Where the speed does not jump, it is
/// that of a parabola through three samples.
pub fn undo(late_s: f64, times_s: &[f64], motion: &mut Motion) {
    if late_s == 0.0 {
        return;
    }
    let shown = Shown::of(motion, times_s);
    let mut places = Places::over(times_s);
    let mut at_samples = times_s.iter().map(|time| {
        let place = places.find(time + late_s);
        (place, shown.between_smooth_samples(place))
    });
    let Some((mut from, mut smooth_from)) = at_samples.next() else {
        return;
    };
    for (segment, (to, smooth_to)) in motion.segments.iter_mut().zip(at_samples) {
        segment.from_m_s = smooth_from.map_or_else(|| from.of(&shown.after_m_s), |(_, speed_m_s)| speed_m_s);
        (segment.to_m, segment.to_m_s) =
            smooth_to.unwrap_or_else(|| (to.of(&shown.displacement_m), to.of(&shown.before_m_s)));
        (from, smooth_from) = (to, smooth_to);
    }
}

/// A motion as the instrument showed it, sample by sample.
struct Shown<'t> {
    times_s: &'t [f64],
    displacement_m: Vec<f64>,
    before_m_s: Vec<f64>,
    after_m_s: Vec<f64>,
}

impl<'t> Shown<'t> {
    fn of(motion: &Motion, times_s: &'t [f64]) -> Self {
        let segments = &motion.segments;
        let at_rest = std::iter::once(0.0);
        Self {
            times_s,
            displacement_m: (std::iter::once(motion.start_m))
                .chain(segments.iter().map(|s| s.to_m))
                .collect(),
            before_m_s: at_rest.clone().chain(segments.iter().map(|s| s.to_m_s)).collect(),
            after_m_s: segments.iter().map(|s| s.from_m_s).chain(at_rest).collect(),
        }
    }

    /// Displacement, m, and speed, m/s, at a place between samples at which the speed does not jump; `None` at other places.
    fn between_smooth_samples(&self, place: Place) -> Option<(f64, f64)> {
        let Place::Before(end, part) = place else {
            return None;
        };
        let first = if part <= 0.5 { end.checked_sub(2)? } else { end - 1 };
        let speeds_m_s = self.after_m_s.get(first..first + 3)?;
        if speeds_m_s != &self.before_m_s[first..first + 3] {
            return None;
        }
        let begin = end - 1;
        let duration_s = self.times_s[end] - self.times_s[begin];
        let segment = Segment {
            to_m: self.displacement_m[end],
            from_m_s: self.after_m_s[begin],
            to_m_s: self.before_m_s[end],
        };
        let (displacement_m, _) = Cubic::through(self.displacement_m[begin], &segment, duration_s).at(part);
        let at_s = self.times_s[begin] + part * duration_s;
        Some((
            displacement_m,
            parabola(&self.times_s[first..first + 3], speeds_m_s, at_s),
        ))
    }
}

/// Value of the parabola through three points (Lagrange).
fn parabola(x: &[f64], y: &[f64], at: f64) -> f64 {
    let weight = |i: usize, j: usize, k: usize| (at - x[j]) * (at - x[k]) / ((x[i] - x[j]) * (x[i] - x[k]));
    y[0] * weight(0, 1, 2) + y[1] * weight(1, 0, 2) + y[2] * weight(2, 0, 1)
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

    #[test]
    fn a_curve_is_shifted_and_a_jump_does_not_overshoot() {
        let t: Vec<f64> = (0..400).map(|i| 0.002 * f64::from(i)).collect();
        let mut curve: Vec<f64> = t.iter().map(|t| 5.0 * t * t).collect();
        record(0.0007, &t, &mut curve);
        assert!((curve[300] - 5.0 * (t[300] - 0.0007) * (t[300] - 0.0007)).abs() < 1e-12);
        let mut jump: Vec<f64> = (0..400).map(|i| if i < 200 { 1.0 } else { 4.0 }).collect();
        record(0.0007, &t, &mut jump);
        assert!(jump.iter().all(|v| (1.0..=4.0).contains(v)));
    }

    /// A motion with these displacements, and speeds from three samples, that jumps at one of them.
    fn motion(displacement_m: &[f64], speed_m_s: &[f64], jump_m_s: (usize, f64)) -> Motion {
        let segments = (1..displacement_m.len()).map(|k| Segment {
            to_m: displacement_m[k],
            from_m_s: speed_m_s[k - 1] + if k - 1 == jump_m_s.0 { jump_m_s.1 } else { 0.0 },
            to_m_s: speed_m_s[k],
        });
        Motion {
            start_m: displacement_m[0],
            segments: segments.collect(),
        }
    }

    #[test]
    fn a_motion_is_shifted_and_keeps_its_noise_and_its_jumps() {
        let t: Vec<f64> = (0..2000).map(|k| 0.002 * f64::from(k)).collect();
        let (x, v): (Vec<f64>, Vec<f64>) = t
            .iter()
            .map(|t| (libm::sin(20.0 * t), 20.0 * libm::cos(20.0 * t)))
            .unzip();
        for late in [0.0003, -0.0009, 0.0053] {
            let mut shifted = motion(&x, &v, (0, 0.0));
            undo(late, &t, &mut shifted);
            for (segment, time) in shifted.segments.iter().zip(&t[1..]).skip(10).take(1900) {
                assert!((segment.to_m - libm::sin(20.0 * (time + late))).abs() < 1e-8);
                assert!((segment.to_m_s - 20.0 * libm::cos(20.0 * (time + late))).abs() < 1e-4);
            }
        }
        // At an eighth of the way a line keeps 0.78 of the square of white noise, and a parabola 0.98.
        let sign = |k: u64| {
            if ((k * 2_654_435_761) >> 31) & 1 == 0 {
                1.0
            } else {
                -1.0
            }
        };
        let noise: Vec<f64> = (0..2000).map(sign).collect();
        let square = |speeds: &mut dyn Iterator<Item = f64>| speeds.map(|v| v * v).sum::<f64>();
        let mut noisy = motion(&x, &noise, (0, 0.0));
        undo(0.000_25, &t, &mut noisy);
        let kept = square(&mut noisy.segments.iter().map(|s| s.to_m_s)) / square(&mut noise.iter().copied());
        assert!((0.92..1.04).contains(&kept), "{kept}");
        // At the jump the line stays.
        let mut jumps = motion(&vec![0.0; 2000], &vec![0.0; 2000], (1000, 1.0));
        undo(0.001, &t, &mut jumps);
        let after: Vec<f64> = jumps.segments[997..1002].iter().map(|s| s.from_m_s).collect();
        assert!(
            after
                .iter()
                .zip([0.0, 0.0, 0.5, 0.5, 0.0])
                .all(|(a, b)| (a - b).abs() < 1e-9),
            "{after:?}"
        );
    }
}
