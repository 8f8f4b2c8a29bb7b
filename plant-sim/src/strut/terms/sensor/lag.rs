//! `sensor_lag`: an instrument that follows the truth by a first-order lag, `tau dy/dt + y = x`.

use super::interpolate::{bend, curvatures};
use crate::model_file::{Quantity, Range};
use crate::strut::motion::Motion;
use crate::strut::terms::equation::Equation;

/// Time constant of a column's instrument, `tau`.
pub const SIZE: Quantity = Quantity {
    key: "sensor_lag",
    range: Range::FromTo(0.0, 1e6),
    unit: "s",
};

/// What the instrument shows, `y`, of the truth `x`.
pub const EQUATION: Equation = Equation {
    text: "tau dy/dt + y = x",
    source: "first-order instrument",
};

/// What the instrument shows of a true signal. Exact for a signal that is a parabola between its samples.
pub fn record(tau_s: f64, times_s: &[f64], signal: &mut [f64]) {
    let mut state = signal.first().copied().unwrap_or(0.0);
    let mut last = state;
    let curvatures = curvatures(times_s, signal);
    let mut approach = Approach::of(tau_s);
    for i in 1..signal.len() {
        let dt = times_s[i] - times_s[i - 1];
        let now = signal[i];
        // What the rise over the interval would be at a constant speed, and what its curvature adds to it by the end.
        let bend = bend(&curvatures[i - 1..=i], dt);
        let rise = now - last - bend;
        let [of_difference, of_rise, of_bend] = approach.over(dt);
        state += of_difference * (last - state) + of_rise * rise + of_bend * bend;
        last = now;
        signal[i] = state;
    }
}

/// Parts that the instrument has followed by the end of an interval: of a difference at its beginning, of a rise at constant speed, and of one at constant
/// acceleration. Intervals of evenly sampled recordings differ in their last digit only, so that the last two are remembered.
struct Approach {
    tau_s: f64,
    known: [(f64, [f64; 3]); 2],
}

impl Approach {
    const fn of(tau_s: f64) -> Self {
        Self {
            tau_s,
            known: [(0.0, [0.0; 3]); 2],
        }
    }

    fn over(&mut self, dt_s: f64) -> [f64; 3] {
        if self.known[0].0 != dt_s {
            self.known.swap(0, 1);
        }
        let [(over_s, parts), _] = &mut self.known;
        if *over_s != dt_s {
            let intervals = dt_s / self.tau_s;
            let of_difference = -libm::expm1(-intervals);
            let of_rise = 1.0 - of_difference / intervals;
            (*over_s, *parts) = (dt_s, [of_difference, of_rise, 1.0 - 2.0 * of_rise / intervals]);
        }
        *parts
    }
}

/// The motion that the instrument followed: `x = y + tau dy/dt`.
///
/// Its speed needs the acceleration at the samples. The mean acceleration of an interval is that of its middle: behind a lag of 5 ms, samples of 5 ms would give a wheel that hops at
/// 12 Hz a speed that is wrong by 7 %.
pub fn undo(tau_s: f64, times_s: &[f64], motion: &mut Motion) {
    let beside = motion.accelerations_beside_samples_m_s2(times_s);
    for (k, segment) in motion.segments.iter_mut().enumerate() {
        let ([_, from_m_s2], [to_m_s2, _]) = (beside[k], beside[k + 1]);
        segment.to_m += tau_s * segment.to_m_s;
        segment.from_m_s += tau_s * from_m_s2;
        segment.to_m_s += tau_s * to_m_s2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_a_step_exponentially() {
        let t: Vec<f64> = (0..400).map(|i| 0.002 * f64::from(i)).collect();
        let mut step = vec![1.0; 400];
        step[0] = 0.0;
        record(0.02, &t, &mut step);
        // The signal is linear between samples, so the step is a ramp of one sample: about its middle.
        let exact = |t: f64| 1.0 - libm::exp(-(t - 0.001) / 0.02);
        assert!((step[30] - exact(t[30])).abs() < 1e-3, "{} {}", step[30], exact(t[30]));
    }

    #[test]
    fn what_is_followed_is_that_of_each_interval() {
        let mut approach = Approach::of(0.02);
        for dt in [0.005, 0.006, 0.005, 0.006, 0.004, 0.006, 0.005] {
            assert_eq!(approach.over(dt), Approach::of(0.02).over(dt));
            assert!((approach.over(dt)[0] - 1.0 + libm::exp(-dt / 0.02)).abs() < 1e-15);
        }
        assert_eq!(Approach::of(0.0).over(0.005), [1.0; 3], "it shows what is true");
    }

    #[test]
    fn a_time_constant_of_any_length_loses_no_digits() {
        let t: Vec<f64> = (0..400).map(|i| 0.002 * f64::from(i)).collect();
        for tau in [1e-9, 10.0, 1e6] {
            let mut curve: Vec<f64> = t.iter().map(|t| 1e9 * t * t).collect();
            record(tau, &t, &mut curve);
            // Of a rise that begins at rest a long lag shows the integral, a t^3 / 3 T, and a short one all.
            let exact = if tau < 1.0 {
                1e9 * t[399] * t[399]
            } else {
                1e9 * t[399] * t[399] * t[399] / (3.0 * tau)
            };
            // The integral leaves out the next term, of t / 4 T.
            let next = if tau < 1.0 { 0.0 } else { t[399] / (4.0 * tau) };
            assert!(
                (curve[399] / exact - 1.0 + next).abs() < 1e-3,
                "{tau}: {} {exact}",
                curve[399]
            );
        }
    }

    #[test]
    fn follows_a_ramp_by_the_time_constant_late() {
        let t: Vec<f64> = (0..400).map(|i| 0.002 * f64::from(i)).collect();
        let mut ramp: Vec<f64> = t.iter().map(|t| 5.0 * t).collect();
        record(0.02, &t, &mut ramp);
        assert!((ramp[399] - 5.0 * (t[399] - 0.02)).abs() < 1e-9);
    }

    #[test]
    fn follows_a_sine_as_the_closed_form_says_also_with_a_time_constant_below_the_sampling_interval() {
        let (dt, w) = (0.002, 60.0);
        let t: Vec<f64> = (0..2000).map(|i| dt * f64::from(i)).collect();
        for tau in [0.0002, 0.001, 0.02] {
            let mut y: Vec<f64> = t.iter().map(|t| libm::sin(w * t)).collect();
            record(tau, &t, &mut y);
            let exact = |t: f64| (libm::sin(w * t) - w * tau * libm::cos(w * t)) / (1.0 + w * w * tau * tau);
            let worst = (100..1900).map(|k| (y[k] - exact(t[k])).abs()).fold(0.0, f64::max);
            // Straight lines miss by up to 1.8e-3, an eighth of the second difference.
            assert!(worst < 1.5e-4, "{tau}: {worst}");
        }
    }

    #[test]
    fn the_motion_of_a_wheel_that_hops_is_found_again() {
        // 12 Hz at 200 Hz, behind a lag of 5 ms.
        let (w, tau) = (75.0, 0.005);
        let t: Vec<f64> = (0..400).map(|i| 0.005 * f64::from(i)).collect();
        let size = 1.0 / (1.0 + w * w * tau * tau);
        let shown = |t: f64| size * (libm::sin(w * t) - w * tau * libm::cos(w * t));
        let speed = |t: f64| size * w * (libm::cos(w * t) + w * tau * libm::sin(w * t));
        let mut motion = Motion::through(t.iter().map(|t| (shown(*t), speed(*t))));
        undo(tau, &t, &mut motion);
        for (segment, time) in motion.segments.iter().zip(t.windows(2)).skip(2).take(395) {
            assert!((segment.to_m - libm::sin(w * time[1])).abs() < 1e-9);
            // The mean acceleration of an interval would miss by 0.07 of the speed.
            for (found, at) in [(segment.from_m_s, time[0]), (segment.to_m_s, time[1])] {
                assert!((found / w - libm::cos(w * at)).abs() < 0.02, "{found} at {at}");
            }
        }
    }

    #[test]
    fn a_speed_that_jumps_at_a_sample_jumps_there_again() {
        // From 1 m/s to rest after 0.1 s, behind a lag of 20 ms.
        let (tau, stop) = (0.02, 0.1);
        let t: Vec<f64> = (0..100).map(|i| 0.002 * f64::from(i)).collect();
        let left = |t: f64| libm::exp(-(t - stop).max(0.0) / tau);
        let shown = |t: f64| t.min(stop) - tau * left(t);
        let mut motion = Motion::through(t.iter().map(|t| (shown(*t), left(*t))));
        undo(tau, &t, &mut motion);
        for (segment, time) in motion.segments.iter().zip(&t) {
            let exact = if *time < stop - 0.001 { 1.0 } else { 0.0 };
            for found in [segment.from_m_s, segment.to_m_s] {
                // A line through the means of two intervals misses an exponential by a third of (2 ms / 20 ms)^2.
                assert!((found - exact).abs() < 0.004, "{found} after {time}");
            }
        }
    }
}
