//! The smoothed motion of a recorded displacement.

use std::sync::LazyLock;

use super::holds::hold_still;
use super::local_fit::{Bases, CUBIC, FEWEST_SAMPLES, Fit, QUINTIC};
use super::noise::Noise;
use super::samples::Samples;
use crate::strut::motion::{Motion, Segment};

/// Smooth an evenly sampled displacement (m, interval s) whose white noise has the standard deviation `noise_m` (m).
///
/// With `noise_m` 0 the samples stand nearly as they are. Works in O(samples x window); fewer than four samples give
/// the straight lines between them.
///
/// ```
/// use oleo_plant_sim::strut::smooth_displacement;
/// // 0.5 m/s from a standing start: the corner at the tenth of a hundred samples stays a corner.
/// let recorded: Vec<f64> = (0..100).map(|k| 0.5 * 0.002 * f64::from((k - 10).max(0))).collect();
/// let motion = smooth_displacement(&recorded, 0.002, 5.0e-6);
/// assert!(motion.segments[8].to_m_s.abs() < 0.01 && (motion.segments[12].from_m_s - 0.5).abs() < 0.01);
/// ```
#[must_use]
pub fn smooth_displacement(displacement_m: &[f64], interval_s: f64, noise_m: f64) -> Motion {
    smooth(displacement_m, interval_s, &Noise::even(noise_m))
}

/// The same where the samples have different noise, `noise_m` (m) one each: where the times of the samples jitter, it grows with the
/// speed. If there are not as many as samples, the displacement stands as it is.
#[must_use]
pub fn smooth_uneven_displacement(displacement_m: &[f64], interval_s: f64, noise_m: &[f64]) -> Motion {
    if noise_m.len() == displacement_m.len() {
        smooth(displacement_m, interval_s, &Noise::of_samples(noise_m))
    } else {
        as_recorded(displacement_m, interval_s)
    }
}

fn smooth(displacement_m: &[f64], interval_s: f64, noise: &Noise) -> Motion {
    let (x, n) = (displacement_m, displacement_m.len());
    if n < FEWEST_SAMPLES {
        return as_recorded(x, interval_s);
    }
    let mut samples = Samples {
        value: vec![0.0; n],
        before: vec![0.0; n],
        after: vec![0.0; n],
    };
    let mut hints = [[0; 2]; 2];
    let mut is_smooth = Vec::with_capacity(n);
    for i in 0..n {
        let neighbourhood = Neighbourhood::of(x, i, noise, &mut hints);
        is_smooth.push(neighbourhood.is_wide);
        (samples.value[i], samples.before[i], samples.after[i]) = match neighbourhood.fit {
            Some(fit) => (fit.value, fit.slope, fit.slope),
            None => corner(x, i, noise, neighbourhood.cubic_reach),
        };
    }
    for i in (0..n).filter(|i| !is_smooth[*i]) {
        keep_monotone(&mut samples, i);
    }
    hold_still(&mut samples, x, noise.at_rest);
    let segments = (1..n).map(|i| Segment {
        to_m: samples.value[i],
        from_m_s: samples.after[i - 1] / interval_s,
        to_m_s: samples.before[i] / interval_s,
    });
    Motion {
        start_m: samples.value[0],
        segments: segments.collect(),
    }
}

/// The polynomials of both degrees, made once.
static BASES: LazyLock<[Bases; 2]> = LazyLock::new(|| [Bases::new(CUBIC), Bases::new(QUINTIC)]);

/// What a sample's neighbourhood says of it.
struct Neighbourhood {
    /// The best fit that reaches to both sides; none at a corner.
    fit: Option<Fit>,
    /// Whether some fit had twice as many samples as its degree: the motion is smooth here.
    is_wide: bool,
    /// How far one cubic reaches behind and ahead, samples.
    cubic_reach: [usize; 2],
}

impl Neighbourhood {
    /// The neighbourhood of sample `i`. `hints` hold the reaches of the sample before, for both degrees and sides.
    fn of(x: &[f64], i: usize, noise: &Noise, hints: &mut [[usize; 2]; 2]) -> Self {
        let mut out = Self {
            fit: None,
            is_wide: false,
            cubic_reach: [0; 2],
        };
        for (bases, [hint_behind, hint_ahead]) in BASES.iter().zip(hints) {
            let behind = bases.reach(x, i, false, noise, hint_behind);
            let ahead = bases.reach(x, i, true, noise, hint_ahead);
            if bases.degree == CUBIC {
                out.cubic_reach = [behind, ahead];
            }
            let near = behind.min(ahead);
            let trials = [
                (behind, ahead),
                (near, near),
                (behind, ahead / 2),
                (behind / 2, ahead),
                (near / 2, near / 2),
            ];
            let found = trials
                .iter()
                .filter(|(b, a)| *b >= 2 && *a >= 2)
                .find(|(b, a)| bases.fit(x, i - b, i + a + 1, i, noise).is_some());
            // Three quarters of what just passes: there the bias is below the noise, not equal to it.
            let fit = found.and_then(|&(b, a)| {
                let (b, a) = ((3 * b).div_ceil(4), (3 * a).div_ceil(4));
                out.is_wide |= b + a >= 2 * bases.degree;
                bases.fit(x, i - b, i + a + 1, i, noise)
            });
            if let Some(fit) = fit
                && out.fit.is_none_or(|best| fit.slope_variance < best.slope_variance)
            {
                out.fit = Some(fit);
            }
        }
        out
    }
}

/// A corner: each side on its own. Displacement, and its change per interval before and after.
fn corner(x: &[f64], i: usize, noise: &Noise, [behind, ahead]: [usize; 2]) -> (f64, f64, f64) {
    let [cubic, _] = &*BASES;
    let from_left = (behind >= 3)
        .then(|| cubic.fit(x, i - behind, i + 1, i, noise))
        .flatten();
    let from_right = (ahead >= 3).then(|| cubic.fit(x, i, i + ahead + 1, i, noise)).flatten();
    let value = match (from_left, from_right) {
        (Some(a), Some(b)) => (behind as f64 * a.value + ahead as f64 * b.value) / (behind + ahead) as f64,
        (Some(f), None) | (None, Some(f)) => f.value,
        (None, None) => x[i],
    };
    let before = from_left.map_or_else(|| if i > 0 { x[i] - x[i - 1] } else { 0.0 }, |f| f.slope);
    let after = from_right.map_or_else(|| if i + 1 < x.len() { x[i + 1] - x[i] } else { 0.0 }, |f| f.slope);
    (value, before, after)
}

/// Keep the motion between two samples monotone (Fritsch & Carlson, SIAM J. Numer. Anal. 17(2), 1980). Where the
/// neighbourhood is short, a cubic through the speeds may overshoot and come back, which turns friction round that never
/// turned.
fn keep_monotone(samples: &mut Samples, i: usize) {
    let monotone = |speed: f64, chord: f64| {
        if speed * chord <= 0.0 {
            0.0
        } else {
            speed.abs().min(3.0 * chord.abs()).copysign(chord)
        }
    };
    let Samples { value, before, after } = samples;
    if i > 0 {
        before[i] = monotone(before[i], value[i] - value[i - 1]);
    }
    if i + 1 < value.len() {
        after[i] = monotone(after[i], value[i + 1] - value[i]);
    }
}

/// Straight lines between the samples.
fn as_recorded(x: &[f64], interval_s: f64) -> Motion {
    let segments = x.windows(2).map(|w| {
        let speed = (w[1] - w[0]) / interval_s;
        Segment {
            to_m: w[1],
            from_m_s: speed,
            to_m_s: speed,
        }
    });
    Motion {
        start_m: x.first().copied().unwrap_or(0.0),
        segments: segments.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::motion::Cubic;
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};

    const NOISE: f64 = 5e-6;

    fn noisy(truth: impl Fn(f64) -> f64, n: usize, dt: f64) -> Vec<f64> {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let noise = Normal::new(0.0, NOISE).unwrap();
        (0..n).map(|i| truth(i as f64 * dt) + noise.sample(&mut rng)).collect()
    }

    #[test]
    fn a_sine_loses_its_noise() {
        let (dt, w) = (0.002, 2.0 * std::f64::consts::PI * 3.0);
        let x = noisy(|t| 0.025 * libm::sin(w * t), 2000, dt);
        let motion = smooth_displacement(&x, dt, NOISE);
        let rms = |raw: bool| {
            let s: f64 = (100..1900)
                .map(|i| {
                    let truth = 0.025 * w * libm::cos(w * (i + 1) as f64 * dt);
                    let v = if raw {
                        (x[i + 2] - x[i]) / (2.0 * dt)
                    } else {
                        motion.segments[i].to_m_s
                    };
                    (v - truth) * (v - truth)
                })
                .sum();
            (s / 1800.0).sqrt()
        };
        assert!(rms(false) < 0.5 * rms(true), "{} {}", rms(false), rms(true));
    }

    #[test]
    fn a_hold_is_still() {
        let dt = 0.002;
        let x = noisy(|t| if t < 1.0 { 0.02 } else { 0.02 + 0.3 * (t - 1.0) }, 1000, dt);
        let motion = smooth_displacement(&x, dt, NOISE);
        let moved = motion.segments[..480]
            .iter()
            .filter(|s| s.from_m_s != 0.0 || s.to_m_s != 0.0)
            .count();
        assert!(moved < 30, "{moved}");
    }

    #[test]
    fn a_corner_stays_a_corner() {
        let dt = 0.002;
        let x = noisy(|t| if t < 1.0 { 0.0 } else { 0.5 * (t - 1.0) }, 1000, dt);
        let motion = smooth_displacement(&x, dt, NOISE);
        let at = 499; // the segment that ends at the corner
        assert!(motion.segments[at].to_m_s.abs() < 2e-3, "{:?}", motion.segments[at]);
        assert!(
            (motion.segments[at + 1].from_m_s - 0.5).abs() < 2e-3,
            "{:?}",
            motion.segments[at + 1]
        );
    }

    /// A move that stops and starts between two samples, as a machine with a limit to its acceleration does.
    #[test]
    fn a_move_ends_where_the_hold_is_and_never_turns_back() {
        let (dt, speed, rounding) = (0.02, 0.1, 0.01);
        // Ramp from rest at 0.507 s to rest at 1.013 s, rounded over 10 ms at either end.
        let truth = |t: f64| {
            let ramp = |since: f64| {
                let s = since.clamp(0.0, rounding);
                0.5 * speed * s * s / rounding + speed * (since - rounding).max(0.0)
            };
            ramp(t - 0.507) - ramp(t - 1.003)
        };
        let x = noisy(truth, 100, dt);
        let motion = smooth_displacement(&x, dt, NOISE);
        let (mut at, mut back, mut farthest) = (motion.start_m, 0.0, 0.0_f64);
        for s in &motion.segments {
            back += (at - s.to_m).max(0.0);
            let (begins, takes) = s.moves_within(at, dt);
            // The cubic of the part that moves, as the strut follows it.
            let cubic = Cubic::through(at, s, takes);
            for k in 1..=10 {
                farthest = farthest.max(cubic.at(f64::from(k) / 10.0).0);
            }
            assert!(begins >= 0.0 && begins + takes <= dt * (1.0 + 1e-12));
            at = s.to_m;
        }
        assert!(
            back < 1e-7 && farthest < at + 1e-7,
            "back {back}, beyond {}",
            farthest - at
        );
        assert!((at - truth(2.0)).abs() < 3.0 * NOISE / 45.0_f64.sqrt(), "{at}");
    }
}
