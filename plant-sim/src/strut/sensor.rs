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
    let (Some(first), Some(last)) = (x.first(), x.last()) else {
        return 0.0;
    };
    if at < *first {
        return y[0];
    }
    if at >= *last {
        return y[x.len() - 1];
    }
    // Sampling is nearly even: the place is known to a sample or two, without a search.
    let guess = (at - first) / (last - first) * (x.len() - 1) as f64;
    let mut i = (guess as usize).clamp(1, x.len() - 1);
    while x[i] <= at {
        i += 1;
    }
    while x[i - 1] > at {
        i -= 1;
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

    fn only(fault: &str, value: f64) -> Effects {
        let mut effects = Effects::default();
        let map = Some(BTreeMap::from([
            ("displacement_m".to_owned(), value),
            ("p1_Pa".to_owned(), value),
        ]));
        match fault {
            "lag" => effects.sensor_lag = map,
            "skew" => effects.sensor_skew = map,
            "gain" => effects.sensor_gain = map,
            "drift" => effects.sensor_drift = map,
            "sign" => effects.sensor_sign = map,
            _ => effects.sensor_offset = map,
        }
        effects
    }

    #[test]
    fn gain_drift_sign_offset_and_skew_are_what_they_say() {
        let t: Vec<f64> = (0..400).map(|i| 0.002 * f64::from(i)).collect();
        let truth = |t: f64| 3.0 + 5.0 * t;
        for (fault, value, shown) in [
            ("gain", 0.1, 1.1 * truth(t[300])),
            ("drift", 2.0, truth(t[300]) + 2.0 * t[300]),
            ("sign", -1.0, -truth(t[300])),
            ("offset", 0.5, truth(t[300]) + 0.5),
            ("skew", 0.013, truth(t[300] - 0.013)),
            ("skew", -0.013, truth(t[300] + 0.013)),
        ] {
            let mut y: Vec<f64> = t.iter().map(|t| truth(*t)).collect();
            record(&only(fault, value), "p1_Pa", &t, &mut y);
            assert!((y[300] - shown).abs() < 1e-12, "{fault} {value}: {} {shown}", y[300]);
        }
    }

    #[test]
    fn a_faulty_displacement_is_undone() {
        // A motion of constant acceleration, which segments hold exactly, as the faulty sensor records it.
        let t: Vec<f64> = (0..400).map(|i| 0.002 * f64::from(i)).collect();
        let (a, faults) = (
            0.8,
            [
                ("lag", 0.01),
                ("skew", 0.006),
                ("gain", 0.03),
                ("drift", 1e-3),
                ("sign", -1.0),
                ("offset", 2e-4),
            ],
        );
        for (fault, value) in faults {
            let effects = only(fault, value);
            let mut shown: Vec<f64> = t.iter().map(|t| 0.5 * a * t * t).collect();
            record(&effects, "displacement_m", &t, &mut shown);
            let motion = super::super::input::smooth_displacement(&shown, 0.002, 0.0);
            let found = undo(&effects, &t, &motion);
            let (k, truth) = (250, 0.5 * a * t[251] * t[251]);
            // The lag's answer to a ramp from sample to sample is its answer to the parabola to (a/2) dt tau.
            assert!(
                (found.segments[k].to_m - truth).abs() < 2e-5,
                "{fault}: {} {truth}",
                found.segments[k].to_m
            );
            assert!(
                (found.segments[k].to_m_s - a * t[251]).abs() < 5e-3,
                "{fault}: {}",
                found.segments[k].to_m_s
            );
        }
    }
}
