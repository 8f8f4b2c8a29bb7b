//! A misfit that decays while nothing moves, which is typical of heat transfer, a leak or a slow sensor.

/// Shortest hold looked at, in samples.
const LEAST_SAMPLES: usize = 40;
/// Part of the variance in the hold that the exponential must explain.
const LEAST_EXPLAINED: f64 = 0.9;
/// Its size at the beginning of the hold, in units of noise.
const LEAST_SIZE: f64 = 10.0;
/// Part of the largest speed below which the specimen holds still.
const STILL: f64 = 0.01;

/// An exponential decay within one hold.
#[derive(Debug, Clone, Copy)]
pub struct Decay {
    /// First and last sample of the hold.
    pub samples: (usize, usize),
    /// Time constant of the decay, s.
    pub time_constant_s: f64,
    /// Size at the beginning, in units of noise.
    pub size: f64,
}

/// The largest decay of a residual within the holds of a recording.
#[must_use]
pub fn largest(time_s: &[f64], speed_m_s: &[f64], residual: &[f64]) -> Option<Decay> {
    let fastest = speed_m_s.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let mut best: Option<Decay> = None;
    let mut from = 0;
    for k in 0..=speed_m_s.len() {
        let still = k < speed_m_s.len() && speed_m_s[k].abs() < STILL * fastest;
        if !still {
            if k >= from + LEAST_SAMPLES
                && let Some(decay) = fitted(&time_s[from..k], &residual[from..k])
                && best.is_none_or(|b| decay.size > b.size)
            {
                best = Some(Decay {
                    samples: (from, k - 1),
                    ..decay
                });
            }
            from = k + 1;
        }
    }
    best
}

/// `c + a exp(-t/tau)` by linear least squares over a grid of time constants that the hold can show.
fn fitted(time_s: &[f64], residual: &[f64]) -> Option<Decay> {
    let n = residual.len() as f64;
    let length = time_s[time_s.len() - 1] - time_s[0];
    let interval = length / n;
    let mean = residual.iter().sum::<f64>() / n;
    let total: f64 = residual.iter().map(|r| (r - mean) * (r - mean)).sum();
    let mut best: Option<(f64, f64, f64)> = None;
    let mut tau = 5.0 * interval;
    while tau < length {
        let e: Vec<f64> = time_s.iter().map(|t| libm::exp(-(t - time_s[0]) / tau)).collect();
        let e_mean = e.iter().sum::<f64>() / n;
        let cross: f64 = e.iter().zip(residual).map(|(e, r)| (e - e_mean) * (r - mean)).sum();
        let square: f64 = e.iter().map(|e| (e - e_mean) * (e - e_mean)).sum();
        let explained = cross * cross / square / total.max(1e-300);
        if best.is_none_or(|b| explained > b.0) {
            best = Some((explained, cross / square, tau));
        }
        tau *= 1.05;
    }
    let (explained, size, tau) = best?;
    (explained > LEAST_EXPLAINED && size.abs() > LEAST_SIZE).then_some(Decay {
        samples: (0, 0),
        time_constant_s: tau,
        size: size.abs(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decay_after_a_step_is_measured() {
        let time: Vec<f64> = (0..3000).map(|k| 0.01 * f64::from(k)).collect();
        let speed: Vec<f64> = time.iter().map(|t| if *t < 2.0 { 0.1 } else { 0.0 }).collect();
        let residual: Vec<f64> = (time.iter())
            .map(|t| {
                if *t < 2.0 {
                    30.0
                } else {
                    -5.0 + 40.0 * libm::exp(-(t - 2.0) / 3.9)
                }
            })
            .collect();
        let decay = largest(&time, &speed, &residual).expect("found");
        assert!((decay.time_constant_s / 3.9 - 1.0).abs() < 0.04, "{decay:?}");
        assert!((time[decay.samples.0] - 2.0).abs() < 0.02);
        assert!(largest(&time, &speed, &vec![5.0; 3000]).is_none());
    }
}
