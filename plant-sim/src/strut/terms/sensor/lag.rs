//! `sensor_lag`: an instrument that follows the truth by a first-order lag, `tau dy/dt + y = x`.

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

/// What the instrument shows of a true signal. Exact for a signal that is linear between its samples.
pub fn record(tau_s: f64, times_s: &[f64], signal: &mut [f64]) {
    let mut state = signal.first().copied().unwrap_or(0.0);
    let mut before = state;
    let mut decays = Decays::of(tau_s);
    for i in 1..signal.len() {
        let dt = times_s[i] - times_s[i - 1];
        let (decay, slope) = (decays.over(dt), (signal[i] - before) / dt);
        // Response to a ramp from `before`: it follows tau late.
        state = (state - before + slope * tau_s) * decay + signal[i] - slope * tau_s;
        before = signal[i];
        signal[i] = state;
    }
}

/// What is left of a difference after an interval. Those of evenly sampled recordings differ in their last digit only, so that the last two are remembered.
struct Decays {
    tau_s: f64,
    known: [(f64, f64); 2],
}

impl Decays {
    const fn of(tau_s: f64) -> Self {
        Self {
            tau_s,
            known: [(0.0, 1.0); 2],
        }
    }

    fn over(&mut self, dt_s: f64) -> f64 {
        if self.known[0].0 != dt_s {
            self.known.swap(0, 1);
        }
        let [(over_s, decay), _] = &mut self.known;
        if *over_s != dt_s {
            (*over_s, *decay) = (dt_s, libm::exp(-dt_s / self.tau_s));
        }
        *decay
    }
}

/// The motion that the instrument followed: `x = y + tau dy/dt`.
pub fn undo(tau_s: f64, times_s: &[f64], motion: &mut Motion) {
    for (segment, time) in motion.segments.iter_mut().zip(times_s.windows(2)) {
        let (from_m_s, to_m_s) = (segment.from_m_s, segment.to_m_s);
        let acceleration = (to_m_s - from_m_s) / (time[1] - time[0]);
        segment.to_m += tau_s * to_m_s;
        segment.from_m_s += tau_s * acceleration;
        segment.to_m_s += tau_s * acceleration;
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
    fn what_is_left_is_that_of_each_interval() {
        let mut decays = Decays::of(0.02);
        for dt in [0.005, 0.006, 0.005, 0.006, 0.004, 0.006, 0.005] {
            assert_eq!(decays.over(dt), libm::exp(-dt / 0.02));
        }
    }

    #[test]
    fn follows_a_ramp_by_the_time_constant_late() {
        let t: Vec<f64> = (0..400).map(|i| 0.002 * f64::from(i)).collect();
        let mut ramp: Vec<f64> = t.iter().map(|t| 5.0 * t).collect();
        record(0.02, &t, &mut ramp);
        assert!((ramp[399] - 5.0 * (t[399] - 0.02)).abs() < 1e-9);
    }
}
