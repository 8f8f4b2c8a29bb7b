//! Smoothing of the displacement of a strut in a vehicle.
//!
//! On a test rig an actuator makes corners, and samples are close together. In a vehicle masses move freely: nothing has a corner,
//! but a wheel moves up and down within a few samples, and what matters is how well the speed *between* them is known. The jerk is
//! taken for white noise of a slowly varying intensity *q*, which is a displacement whose spectrum falls with the sixth power of
//! the frequency, as that of a wheel on a road does above its natural frequency. The best estimate is then that of Kalman's filter
//! run forwards and of the smoother of Rauch, Tung & Striebel (AIAA J. 3(8), 1965) run backwards; for a constant *q* it is the
//! quintic smoothing spline (Wahba, J. R. Stat. Soc. B 40(3), 1978). *q* is twice the likeliest value over half a second about each sample.
//!
//! What the estimate does not know can be drawn: a motion of the same *q* with the same noise is smoothed too, and its error is one
//! that the estimate may have (Durbin & Koopman, Biometrika 89(3), 2002). A reading that is missing is missing there too.

use nalgebra::{Matrix3, Vector3};
use rand::{Rng as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::strut::motion::{Motion, Segment};

/// Intensities of the jerk that are tried, as powers of ten, m2/s5: from rest to a wheel on a stony track.
const EXPONENTS: std::ops::RangeInclusive<i32> = -8..=8;
/// Samples to either side over which the intensity is the same.
const HALF_WINDOW: usize = 50;
/// What the likeliest intensity is multiplied by. A wheel meets stones within that time and is left alone between them: an intensity that is too small would
/// hold the estimate back at each of them, where one that is too large only makes it less sure of itself.
const UNEVEN: f64 = 2.0;
/// Variance of displacement (m2), speed (m2/s2) and acceleration (m2/s4) at the first sample: it may be in motion.
const AT_BEGIN: [f64; 3] = [1e-2, 1e-1, 1e2];
/// The least noise, m; a perfect sensor has none, and the filter divides by it.
const LEAST_NOISE_M: f64 = 1e-7;
/// Fixed, so that a report is the same every time.
const SEED: u64 = 1;

/// Motions that are drawn. A gap in the readings is one error of each, and one alone may be small by chance.
const DRAWS: usize = 4;

/// A motion as it is best estimated, and others that it may as well have been.
#[derive(Debug, Clone)]
pub struct FreeMotion {
    /// The best estimate.
    pub best: Motion,
    /// The best estimate with an error drawn from what it does not know, several times.
    pub possible: [Motion; DRAWS],
}

/// Smooths an evenly sampled displacement (m, interval s) whose white noise has the standard deviation `noise_m` (m). What was not read is NaN.
///
/// ```
/// use oleo_plant_sim::strut::smooth_free_motion;
/// // Wheel hop of 12 Hz at 200 Hz: the speed at a sample follows from its neighbours.
/// let x: Vec<f64> = (0..400).map(|k| 0.01 * libm::sin(75.0 * 0.005 * f64::from(k))).collect();
/// let motion = smooth_free_motion(&x, 0.005, 5.0e-6).best;
/// let speed = 0.75 * libm::cos(75.0 * 0.005 * 200.0);
/// assert!((motion.segments[199].to_m_s - speed).abs() < 0.005);
/// ```
#[must_use]
pub fn smooth_free_motion(displacement_m: &[f64], interval_s: f64, noise_m: f64) -> FreeMotion {
    let Some(&start) = displacement_m.iter().find(|x| x.is_finite()) else {
        let nothing = Motion {
            start_m: 0.0,
            segments: vec![],
        };
        return FreeMotion {
            possible: std::array::from_fn(|_| nothing.clone()),
            best: nothing,
        };
    };
    let about: Vec<f64> = displacement_m.iter().map(|x| x - start).collect();
    let model = Model::new(interval_s, noise_m.max(LEAST_NOISE_M));
    let mut intensity = model.likeliest_intensity(&about);
    intensity.iter_mut().for_each(|q| *q *= UNEVEN);
    let best = model.smoothed(&about, &intensity);
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let possible = std::array::from_fn(|_| {
        let (truth, mut read) = model.drawn(&intensity, &mut random);
        for (read, x) in read.iter_mut().zip(displacement_m).filter(|(_, x)| x.is_nan()) {
            *read = *x;
        }
        let other = model.smoothed(&read, &intensity);
        let error = truth.iter().zip(&other).map(|(truth, other)| truth - other);
        best.iter()
            .zip(error)
            .map(|(best, error)| best + error)
            .collect::<Vec<_>>()
    });
    let motion = |states: &[Vector3<f64>]| Motion {
        start_m: start + states.first().map_or(0.0, |s| s.x),
        segments: (states.windows(2))
            .map(|w| Segment {
                to_m: start + w[1].x,
                from_m_s: w[0].y,
                to_m_s: w[1].y,
            })
            .collect(),
    };
    FreeMotion {
        best: motion(&best),
        possible: possible.map(|states| motion(&states)),
    }
}

/// Displacement, speed and acceleration driven by white jerk, and a noisy reading of the displacement.
struct Model {
    transition: Matrix3<f64>,
    /// Covariance that a jerk of intensity 1 adds in an interval.
    process: Matrix3<f64>,
    variance_m2: f64,
}

/// Where, in decades from the best power of ten, the log-likelihood is greatest that is this much greater (negative: less) a decade below and above. That of
/// the variance of *n* normal numbers whose squares have the sum *c* is *-n u - c exp(-u)* at the logarithm *u*: it falls much faster below its vertex than
/// above, so that a parabola over decades would find the vertex up to a third of a decade too high.
fn likeliest_beside(below: f64, above: f64) -> f64 {
    let decade = core::f64::consts::LN_10;
    // The sum of both differences is that of exp(u) and exp(-u) beyond 2; the other one then gives n.
    let squares = -(below + above) / (10.0 + 0.1 - 2.0);
    let number = (0.9 * squares - above) / decade;
    // Neither is negative, since both differences are not positive, unless rounding makes them so.
    if squares > 0.0 && number > 0.0 {
        libm::log10(squares / number)
    } else {
        0.0
    }
}

/// State and covariance before and after a reading.
struct Filtered {
    ahead: (Vector3<f64>, Matrix3<f64>),
    after: (Vector3<f64>, Matrix3<f64>),
}

impl Model {
    fn new(h: f64, noise_m: f64) -> Self {
        let (h2, h3) = (h * h, h * h * h);
        Self {
            transition: Matrix3::new(1.0, h, h2 / 2.0, 0.0, 1.0, h, 0.0, 0.0, 1.0),
            process: Matrix3::new(
                h3 * h2 / 20.0,
                h2 * h2 / 8.0,
                h3 / 6.0,
                h2 * h2 / 8.0,
                h3 / 3.0,
                h2 / 2.0,
                h3 / 6.0,
                h2 / 2.0,
                h,
            ),
            variance_m2: noise_m * noise_m,
        }
    }

    /// Kalman's filter. `step` gets the innovation of each reading and its variance; NaN is no reading.
    fn filter(
        &self,
        readings: &[f64],
        intensity: impl Fn(usize) -> f64,
        mut step: impl FnMut(usize, f64, f64),
    ) -> Vec<Filtered> {
        let mut ahead = (Vector3::zeros(), Matrix3::from_diagonal(&Vector3::from(AT_BEGIN)));
        let mut all = Vec::with_capacity(readings.len());
        for (k, reading) in readings.iter().enumerate() {
            let (state, covariance) = ahead;
            if reading.is_nan() {
                all.push(Filtered { ahead, after: ahead });
                ahead = self.ahead_of(ahead, intensity(k));
                continue;
            }
            let innovation = reading - state.x;
            let variance = covariance[(0, 0)] + self.variance_m2;
            step(k, innovation, variance);
            let gain: Vector3<f64> = covariance.column(0) / variance;
            let kept = covariance - gain * covariance.row(0);
            let after = (state + gain * innovation, 0.5 * (kept + kept.transpose()));
            all.push(Filtered { ahead, after });
            ahead = self.ahead_of(after, intensity(k));
        }
        all
    }

    /// State and covariance an interval later.
    fn ahead_of(
        &self,
        (state, covariance): (Vector3<f64>, Matrix3<f64>),
        intensity: f64,
    ) -> (Vector3<f64>, Matrix3<f64>) {
        (
            self.transition * state,
            self.transition * covariance * self.transition.transpose() + intensity * self.process,
        )
    }

    /// The likeliest intensity about each sample, between the best power of ten and its neighbours.
    fn likeliest_intensity(&self, readings: &[f64]) -> Vec<f64> {
        let n = readings.len();
        // Sums of the log-likelihood up to each sample, for each power.
        let sums = EXPONENTS.map(|exponent| {
            let intensity = libm::pow(10.0, f64::from(exponent));
            let mut each = vec![0.0; n];
            self.filter(
                readings,
                |_| intensity,
                |k, innovation, variance| {
                    each[k] = -libm::log(variance) - innovation * innovation / variance;
                },
            );
            let mut sums = vec![0.0; n + 1];
            for (k, of_sample) in each.iter().enumerate() {
                sums[k + 1] = sums[k] + of_sample;
            }
            sums
        });
        let sums: Vec<Vec<f64>> = sums.collect();
        let about = |k: usize| {
            let (from, to) = (k.saturating_sub(HALF_WINDOW), (k + HALF_WINDOW + 1).min(n));
            let likelihood: Vec<f64> = sums.iter().map(|sums| sums[to] - sums[from]).collect();
            let best = (0..likelihood.len())
                .max_by(|a, b| likelihood[*a].total_cmp(&likelihood[*b]))
                .unwrap_or(0);
            let beside = match likelihood.get(best.wrapping_sub(1)..best + 2) {
                Some(&[less, most, more]) => likeliest_beside(less - most, more - most).clamp(-0.5, 0.5),
                _ => 0.0,
            };
            libm::pow(10.0, f64::from(*EXPONENTS.start()) + best as f64 + beside)
        };
        (0..n).map(about).collect()
    }

    /// The smoother: the filter forwards, then back.
    fn smoothed(&self, readings: &[f64], intensity: &[f64]) -> Vec<Vector3<f64>> {
        let filtered = self.filter(readings, |k| intensity[k], |_, _, _| ());
        let mut states: Vec<Vector3<f64>> = filtered.iter().map(|f| f.after.0).collect();
        for k in (0..states.len().saturating_sub(1)).rev() {
            let next = &filtered[k + 1].ahead;
            // The covariance is positive definite; a solver that fails leaves the filter's estimate.
            if let Some(inverse) = next.1.try_inverse() {
                let gain = filtered[k].after.1 * self.transition.transpose() * inverse;
                let correction = states[k + 1] - next.0;
                states[k] += gain * correction;
            }
        }
        states
    }

    /// A motion of these intensities, and its readings.
    fn drawn(&self, intensity: &[f64], random: &mut ChaCha8Rng) -> (Vec<Vector3<f64>>, Vec<f64>) {
        // The sum of many signs is as good as a normal number.
        let mut sign = || if random.next_u32() & 1 == 0 { 1.0 } else { -1.0 };
        let root = self.process.cholesky().map_or_else(Matrix3::zeros, |c| c.l());
        let mut state = Vector3::zeros();
        let (mut states, mut readings) = (Vec::new(), Vec::new());
        for q in intensity {
            states.push(state);
            readings.push(state.x + self.variance_m2.sqrt() * sign());
            state = self.transition * state + q.sqrt() * root * Vector3::from_fn(|_, _| sign());
        }
        (states, readings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::{Distribution, Normal};

    /// A wheel on a road: two vibrations that come and go, after a second at rest.
    fn truth(t: f64) -> (f64, f64) {
        let (begin, rise) = (1.0, 2.0);
        let s = (t - begin).max(0.0);
        let (size, growth) = if s < rise { (s / rise, 1.0 / rise) } else { (1.0, 0.0) };
        let (a, b) = (libm::sin(75.0 * s), libm::sin(9.0 * s));
        let (da, db) = (75.0 * libm::cos(75.0 * s), 9.0 * libm::cos(9.0 * s));
        let (x, v) = (0.008 * a + 0.03 * b, 0.008 * da + 0.03 * db);
        (
            size * size * x,
            if s > 0.0 {
                size * size * v + 2.0 * size * growth * x
            } else {
                0.0
            },
        )
    }

    fn noisy(n: usize, noise: f64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let normal = Normal::new(0.0, noise).unwrap();
        (0..n)
            .map(|k| truth(0.005 * k as f64).0 + normal.sample(&mut random))
            .collect()
    }

    #[test]
    fn the_speed_of_a_wheel_is_found_and_its_error_is_not_understated() {
        let noise = 6e-6;
        let smooth = smooth_free_motion(&noisy(2000, noise), 0.005, noise);
        let rms = |from: usize, error: &dyn Fn(usize) -> f64| {
            ((from..1990).map(|k| error(k) * error(k)).sum::<f64>() / (1990 - from) as f64).sqrt()
        };
        let speed = |k: usize| smooth.best.segments[k].to_m_s;
        let error = rms(700, &|k| speed(k) - truth(0.005 * (k + 1) as f64).1);
        let said = rms(700, &|k| speed(k) - smooth.possible[0].segments[k].to_m_s);
        // Of 0.45 m/s. Two vibrations are easier to follow than a white jerk, so that the estimate says too much of its error.
        assert!(error < 3e-3, "{error}");
        assert!(error < said && said < 0.02, "{error} {said}");
    }

    /// A motion of white jerk (m2/s5), integrated in steps of a hundredth of the interval, and its speed at each sample.
    fn white_jerk(n: usize, intensity: f64, seed: u64) -> (Vec<f64>, Vec<f64>) {
        let (interval, fine) = (0.005, 100);
        let step = interval / f64::from(fine);
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let jerk = Normal::new(0.0, (intensity / step).sqrt()).unwrap();
        let (mut x, mut v, mut a) = (0.0, 0.0, 0.0);
        let (mut displacement, mut speed) = (Vec::new(), Vec::new());
        for _ in 0..n {
            displacement.push(x);
            speed.push(v);
            for _ in 0..fine {
                let j = jerk.sample(&mut random);
                x += step * (v + step * (a / 2.0 + step * j / 6.0));
                v += step * (a + step * j / 2.0);
                a += step * j;
            }
        }
        (displacement, speed)
    }

    #[test]
    fn the_error_that_is_drawn_is_not_smaller_than_the_true_one() {
        let (noise, from, to) = (6e-6, 200, 1800);
        for (seed, intensity) in [(11, 1e2), (12, 1e4), (13, 3e5)] {
            let (mut displacement, speed) = white_jerk(2000, intensity, seed);
            let mut random = ChaCha8Rng::seed_from_u64(100 + seed);
            let normal = Normal::new(0.0, noise).unwrap();
            displacement.iter_mut().for_each(|x| *x += normal.sample(&mut random));
            let smooth = smooth_free_motion(&displacement, 0.005, noise);
            let rms = |error: &dyn Fn(usize) -> f64| {
                ((from..to).map(|k| error(k) * error(k)).sum::<f64>() / f64::from(to as u32 - from as u32)).sqrt()
            };
            let of = |motion: &Motion, k: usize| motion.segments[k].to_m_s;
            let error = rms(&|k| of(&smooth.best, k) - speed[k + 1]);
            let said = rms(&|k| of(&smooth.best, k) - of(&smooth.possible[0], k));
            // Not less, and not more than the root of what the intensity is multiplied by; 1,600 correlated errors tell a spread to a few per cent.
            assert!(
                (0.9..1.1 * UNEVEN.sqrt()).contains(&(said / error)),
                "{intensity}: {said} for {error}"
            );
        }
    }

    #[test]
    fn where_readings_are_missing_the_error_is_larger_and_the_drawn_one_too() {
        let noise = 6e-6;
        let (displacement, _) = white_jerk(4000, 1e4, 14);
        let mut random = ChaCha8Rng::seed_from_u64(114);
        let normal = Normal::new(0.0, noise).unwrap();
        let is_missing = |k: usize| (40..48).contains(&(k % 80));
        let read: Vec<f64> = (displacement.iter().enumerate())
            .map(|(k, x)| {
                if is_missing(k) {
                    f64::NAN
                } else {
                    x + normal.sample(&mut random)
                }
            })
            .collect();
        let smooth = smooth_free_motion(&read, 0.005, noise);
        let rms = |missing: bool, error: &dyn Fn(usize) -> f64| {
            let samples: Vec<usize> = (80..3920).filter(|k| is_missing(*k) == missing).collect();
            (samples.iter().map(|&k| error(k) * error(k)).sum::<f64>() / samples.len() as f64).sqrt()
        };
        let of = |motion: &Motion, k: usize| motion.segments[k - 1].to_m;
        let error = |missing| rms(missing, &|k| of(&smooth.best, k) - displacement[k]);
        assert!(error(true) > 30.0 * error(false), "{} {}", error(true), error(false));
        let squares = (smooth.possible.iter())
            .map(|other| rms(true, &|k| of(&smooth.best, k) - of(other, k)))
            .fold(0.0, |sum, said| sum + said * said);
        let said = (squares / DRAWS as f64).sqrt() / error(true);
        // 48 gaps tell the true spread to a tenth, and what is said of it grows with the root of the intensity.
        let expected = UNEVEN.sqrt();
        assert!((0.8 * expected..1.25 * expected).contains(&said), "{said}");
    }

    #[test]
    fn the_intensity_that_is_found_is_the_true_one() {
        let noise = 6e-6;
        for (seed, intensity) in [(15, 1e2), (16, 3e2), (17, 1e4), (18, 5e4)] {
            let (mut displacement, _) = white_jerk(4000, intensity, seed);
            let mut random = ChaCha8Rng::seed_from_u64(100 + seed);
            let normal = Normal::new(0.0, noise).unwrap();
            displacement.iter_mut().for_each(|x| *x += normal.sample(&mut random));
            let found = Model::new(0.005, noise).likeliest_intensity(&displacement);
            let decades = found.iter().map(|q| libm::log10(q / intensity)).sum::<f64>() / found.len() as f64;
            assert!(decades.abs() < 0.15, "{intensity}: {decades} decades off");
        }
    }

    #[test]
    fn at_rest_nothing_moves() {
        let noise = 6e-6;
        let smooth = smooth_free_motion(&noisy(2000, noise), 0.005, noise);
        let fastest = smooth.best.segments[20..120]
            .iter()
            .map(|s| s.to_m_s.abs())
            .fold(0.0, f64::max);
        assert!(fastest < 1e-4, "{fastest}");
    }

    #[test]
    fn few_samples_missing_ones_and_no_noise_do_no_harm() {
        for (n, missing) in (0..6).flat_map(|n| [0, 1, n].map(|missing| (n, missing))) {
            let mut read = noisy(n, 1e-9);
            read.iter_mut().take(missing).for_each(|x| *x = f64::NAN);
            let motion = smooth_free_motion(&read, 0.005, 0.0).best;
            if missing == n {
                assert!(motion.segments.is_empty());
                continue;
            }
            assert_eq!(motion.segments.len(), n.saturating_sub(1));
            assert!(
                motion
                    .segments
                    .iter()
                    .all(|s| s.to_m.is_finite() && s.to_m_s.is_finite())
            );
        }
    }
}
