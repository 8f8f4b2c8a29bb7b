//! Instruments: what a faulty one makes of the truth, and how a faulty displacement sensor is undone.

use super::effects::Effects;
use super::input::Motion;

/// Columns of a strut's recording that an instrument stands behind.
pub const COLUMNS: [&str; 6] = ["displacement_m", "force_N", "p1_Pa", "p2_Pa", "p3_Pa", "p4_Pa"];

/// Make of a true signal what the column's instrument records: lag, skew, gain, drift, sign, offset, in this order.
///
/// `times_s` increase. The first-order lag is exact for a signal that is linear between samples.
pub fn record(effects: &Effects, column: &str, times_s: &[f64], signal: &mut [f64]) {
    let of = |map: &Option<super::effects::SensorEffect>| map.as_ref().and_then(|m| m.get(column).copied());
    if let Some(tau) = of(&effects.sensor_lag).filter(|t| *t > 0.0) {
        let mut state = signal.first().copied().unwrap_or(0.0);
        let mut before = state;
        for i in 1..signal.len() {
            let dt = times_s[i] - times_s[i - 1];
            let (decay, slope) = (libm::exp(-dt / tau), (signal[i] - before) / dt);
            // Response to a ramp from `before`: it follows tau late.
            state = (state - before + slope * tau) * decay + signal[i] - slope * tau;
            before = signal[i];
            signal[i] = state;
        }
    }
    if let Some(late) = of(&effects.sensor_skew) {
        let truth = signal.to_vec();
        for (i, to) in signal.iter_mut().enumerate() {
            *to = interpolate(times_s, &truth, times_s[i] - late);
        }
    }
    let gain = 1.0 + of(&effects.sensor_gain).unwrap_or(0.0);
    let sign = of(&effects.sensor_sign).unwrap_or(1.0);
    let (drift, offset) = (
        of(&effects.sensor_drift).unwrap_or(0.0),
        of(&effects.sensor_offset).unwrap_or(0.0),
    );
    if (gain, sign, drift, offset) != (1.0, 1.0, 0.0, 0.0) {
        let begin = times_s.first().copied().unwrap_or(0.0);
        for (to, t) in signal.iter_mut().zip(times_s) {
            *to = sign * gain * *to + drift * (t - begin) + offset;
        }
    }
}

/// The displacement that a faulty sensor's recording came from.
pub(super) fn undo(effects: &Effects, times_s: &[f64], motion: &Motion) -> Motion {
    let of = |map: &Option<super::effects::SensorEffect>| map.as_ref().and_then(|m| m.get("displacement_m").copied());
    let mut out = motion.clone();
    let offset = of(&effects.sensor_offset).unwrap_or(0.0);
    let (drift, begin) = (
        of(&effects.sensor_drift).unwrap_or(0.0),
        times_s.first().copied().unwrap_or(0.0),
    );
    let factor = 1.0 / (of(&effects.sensor_sign).unwrap_or(1.0) * (1.0 + of(&effects.sensor_gain).unwrap_or(0.0)));
    out.start_m = factor * (motion.start_m - offset);
    for (s, t) in out.segments.iter_mut().zip(times_s.iter().skip(1)) {
        s.to_m = factor * (s.to_m - offset - drift * (t - begin));
        s.from_m_s = factor * (s.from_m_s - drift);
        s.to_m_s = factor * (s.to_m_s - drift);
    }
    // A late or lagging sensor: the truth is what it will read; `x(t) = y(t + skew)`, `x = y + tau dy/dt`.
    let early = of(&effects.sensor_skew).unwrap_or(0.0);
    if early != 0.0 {
        let y: Vec<f64> = std::iter::once(out.start_m)
            .chain(out.segments.iter().map(|s| s.to_m))
            .collect();
        let left: Vec<f64> = std::iter::once(0.0)
            .chain(out.segments.iter().map(|s| s.to_m_s))
            .collect();
        let right: Vec<f64> = out
            .segments
            .iter()
            .map(|s| s.from_m_s)
            .chain(std::iter::once(0.0))
            .collect();
        for (i, s) in out.segments.iter_mut().enumerate() {
            s.to_m = interpolate(times_s, &y, times_s[i + 1] + early);
            s.to_m_s = interpolate(times_s, &left, times_s[i + 1] + early);
            s.from_m_s = interpolate(times_s, &right, times_s[i] + early);
        }
    }
    if let Some(tau) = of(&effects.sensor_lag).filter(|t| *t > 0.0) {
        let speeds: Vec<(f64, f64)> = out.segments.iter().map(|s| (s.from_m_s, s.to_m_s)).collect();
        for (i, s) in out.segments.iter_mut().enumerate() {
            let dt = times_s[i + 1] - times_s[i];
            let acceleration = (speeds[i].1 - speeds[i].0) / dt;
            s.to_m += tau * speeds[i].1;
            s.from_m_s += tau * acceleration;
            s.to_m_s += tau * acceleration;
        }
    }
    out
}

/// Linear interpolation, constant beyond the ends.
fn interpolate(x: &[f64], y: &[f64], at: f64) -> f64 {
    let i = x.partition_point(|v| *v <= at);
    if i == 0 {
        return y[0];
    }
    if i == x.len() {
        return y[x.len() - 1];
    }
    y[i - 1] + (y[i] - y[i - 1]) * ((at - x[i - 1]) / (x[i] - x[i - 1]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn a_lag_answers_a_step_exponentially_and_follows_a_ramp_late() {
        let t: Vec<f64> = (0..400).map(|i| 0.002 * f64::from(i)).collect();
        let mut ramp: Vec<f64> = t.iter().map(|t| 5.0 * t).collect();
        let effects = Effects {
            sensor_lag: Some(BTreeMap::from([("p2_Pa".into(), 0.02)])),
            ..Effects::default()
        };
        record(&effects, "p2_Pa", &t, &mut ramp);
        assert!((ramp[399] - 5.0 * (t[399] - 0.02)).abs() < 1e-9);
        let mut other = vec![1.0; 400];
        record(&effects, "p1_Pa", &t, &mut other);
        assert!(other.iter().all(|v| *v == 1.0));
    }
}
