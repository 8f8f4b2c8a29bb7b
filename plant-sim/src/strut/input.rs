//! The displacement of a recording as an input: its noise taken off, its corners kept.
//!
//! Displacement is measured too. Differentiated as it is, 5 um of noise at 500 Hz is 3.5 mm/s, which a damper turns into
//! 10 to 25 kPa: three to six times the pressure sensors' noise. A low-pass would round the corners of sawtooth and
//! trapezoid moves, where the speed jumps. So each sample gets a cubic through the widest neighbourhood that the stated
//! noise can explain (local polynomial regression, Fan & Gijbels 1996; width by a chi-square test of the fit). Where no
//! neighbourhood that reaches to both sides passes, the speed jumps: the sample keeps one speed from its left and one
//! from its right.

use std::sync::LazyLock;

/// One sampling interval of a motion: where it ends, and the speeds at its two ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Displacement at the end, m.
    pub to_m: f64,
    /// Speed just after the beginning, m/s.
    pub from_m_s: f64,
    /// Speed just before the end, m/s.
    pub to_m_s: f64,
}

impl Segment {
    /// The part of an interval of `duration_s` in which the motion from `from_m` happens: when it begins and how long it takes.
    ///
    /// Where the motion begins or ends at rest and its other speed would carry it farther than it goes, it has begun or
    /// ended within the interval: at constant acceleration, which takes twice the way over the speed. (A cubic over the
    /// whole interval would overshoot and come back, and a seal's friction with it.)
    #[must_use]
    pub fn moves_within(&self, from_m: f64, duration_s: f64) -> (f64, f64) {
        let rise = self.to_m - from_m;
        let takes = |speed: f64| {
            let time = 2.0 * rise / speed;
            (time > 0.0 && time < duration_s).then_some(time)
        };
        if self.to_m_s == 0.0 {
            takes(self.from_m_s).map_or((0.0, duration_s), |time| (0.0, time))
        } else if self.from_m_s == 0.0 {
            takes(self.to_m_s).map_or((0.0, duration_s), |time| (duration_s - time, time))
        } else {
            (0.0, duration_s)
        }
    }
}

/// A displacement history that a strut can be driven with.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Displacement at the first sample, m.
    pub start_m: f64,
    /// One segment per sampling interval.
    pub segments: Vec<Segment>,
}

/// Window lengths that are tried to one side, samples.
const LENGTHS: [usize; 13] = [4, 5, 6, 8, 11, 15, 20, 27, 36, 48, 64, 86, 114];
/// Degrees of the local polynomials: cubic next to corners, quintic where the motion is smooth.
const CUBIC: usize = 3;
const QUINTIC: usize = 5;
/// A fit passes unless noise alone would do worse once in ten thousand times: this quantile of the normal distribution.
const TEST_QUANTILE: f64 = 3.7;

/// Largest sum of squares of `freedom` unit normals that passes (Wilson & Hilferty 1931).
fn largest_chi_square(freedom: f64) -> f64 {
    let spread = 2.0 / (9.0 * freedom);
    let root = 1.0 - spread + TEST_QUANTILE * spread.sqrt();
    freedom * root * root * root
}

/// Orthonormal polynomials on an even grid, by Gram-Schmidt.
struct Basis {
    columns: Vec<Vec<f64>>,
    /// Derivative of the columns at each point, per sample spacing.
    slopes: Vec<Vec<f64>>,
}

/// Value and slope (per sample) of a fit, and the variance of the slope for unit noise.
#[derive(Clone, Copy)]
struct Fit {
    value: f64,
    slope: f64,
    slope_variance: f64,
}

impl Basis {
    fn new(length: usize, degree: usize) -> Self {
        let t: Vec<f64> = (0..length)
            .map(|i| (2 * i) as f64 / (length - 1) as f64 - 1.0)
            .collect();
        let scale = 2.0 / (length - 1) as f64;
        let (mut columns, mut slopes): (Vec<Vec<f64>>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
        for k in 0..=degree {
            // t * previous column, made orthogonal to all before; the derivative follows the same recurrence.
            let (mut v, mut d): (Vec<f64>, Vec<f64>) = if k == 0 {
                (vec![1.0; length], vec![0.0; length])
            } else {
                let (c, s) = (&columns[k - 1], &slopes[k - 1]);
                (
                    t.iter().zip(c).map(|(t, c)| t * c).collect(),
                    t.iter()
                        .zip(c.iter().zip(s))
                        .map(|(t, (c, s))| scale * c + t * s)
                        .collect(),
                )
            };
            for _ in 0..2 {
                for j in 0..k {
                    let dot: f64 = v.iter().zip(&columns[j]).map(|(a, b)| a * b).sum();
                    v.iter_mut().zip(&columns[j]).for_each(|(a, b)| *a -= dot * b);
                    d.iter_mut().zip(&slopes[j]).for_each(|(a, b)| *a -= dot * b);
                }
            }
            let norm = v.iter().map(|a| a * a).sum::<f64>().sqrt();
            columns.push(v.iter().map(|a| a / norm).collect());
            slopes.push(d.iter().map(|a| a / norm).collect());
        }
        Self { columns, slopes }
    }

    /// Fit `x` around point `at`, if the noise explains the residual.
    fn fit(&self, x: &[f64], at: usize, noise: f64) -> Option<Fit> {
        let origin = x[at];
        // The residual's square is that of the data less that of its projections (Bessel).
        let mut residual: f64 = x.iter().map(|x| (x - origin) * (x - origin)).sum();
        let total = residual;
        let mut out = Fit {
            value: origin,
            slope: 0.0,
            slope_variance: 0.0,
        };
        for (column, slope) in self.columns.iter().zip(&self.slopes) {
            let c: f64 = x.iter().zip(column).map(|(x, b)| (x - origin) * b).sum();
            residual -= c * c;
            out.value += c * column[at];
            out.slope += c * slope[at];
            out.slope_variance += slope[at] * slope[at];
        }
        let freedom = (x.len() - self.columns.len()) as f64;
        let rounding = 1e-13 * total;
        let limit = noise * noise * largest_chi_square(freedom.max(1.0)) + rounding;
        (freedom == 0.0 || residual <= limit).then_some(out)
    }
}

/// All bases a recording may need, by degree and length.
struct Bases {
    degree: usize,
    by_length: Vec<Option<Basis>>,
}

impl Bases {
    fn new(degree: usize) -> Self {
        let most = 2 * LENGTHS[LENGTHS.len() - 1];
        let by_length = (0..=most)
            .map(|l| (l > degree).then(|| Basis::new(l, degree)))
            .collect();
        Self { degree, by_length }
    }

    /// The fit over samples `from..to` around `at`.
    fn fit(&self, x: &[f64], from: usize, to: usize, at: usize, noise: f64) -> Option<Fit> {
        self.by_length
            .get(to - from)?
            .as_ref()?
            .fit(x.get(from..to)?, at - from, noise)
    }

    /// Samples to one side of `at` that one polynomial explains, at most; the search starts at the neighbour's answer.
    fn reach(&self, x: &[f64], at: usize, ahead: bool, noise: f64, hint: &mut usize) -> usize {
        let passes = |k: usize| {
            let l = LENGTHS[k];
            let range = if ahead {
                Some((at, at + l))
            } else {
                (at + 1).checked_sub(l).map(|from| (from, at + 1))
            };
            l > self.degree && range.is_some_and(|(from, to)| self.fit(x, from, to, at, noise).is_some())
        };
        // A degree needs more points than it has coefficients.
        let least = LENGTHS.iter().position(|l| *l > self.degree).unwrap_or(0);
        let mut k = (*hint).max(least);
        if passes(k) {
            while k + 1 < LENGTHS.len() && passes(k + 1) {
                k += 1;
            }
        } else {
            while k > least && !passes(k) {
                k -= 1;
            }
        }
        *hint = k;
        if passes(k) { LENGTHS[k] - 1 } else { 0 }
    }
}

/// Smooth an evenly sampled displacement (m, interval s) whose white noise has standard deviation `noise_m`.
///
/// With `noise_m` 0 the samples stand nearly as they are. Works in O(samples x window); fewer than four samples give
/// the straight lines between them.
#[must_use]
pub fn smooth_displacement(displacement_m: &[f64], interval_s: f64, noise_m: f64) -> Motion {
    static BASES: LazyLock<[Bases; 2]> = LazyLock::new(|| [Bases::new(CUBIC), Bases::new(QUINTIC)]);
    let (x, n) = (displacement_m, displacement_m.len());
    if n < LENGTHS[0] {
        return as_recorded(x, interval_s);
    }
    let mut value = vec![0.0; n];
    let mut left = vec![0.0; n];
    let mut right = vec![0.0; n];
    let mut smooth = vec![false; n];
    let mut hints = [[0; 2]; 2];
    for i in 0..n {
        let mut best: Option<Fit> = None;
        let mut cubic_reach = [0; 2];
        for (bases, hint) in BASES.iter().zip(&mut hints) {
            let behind = bases.reach(x, i, false, noise_m, &mut hint[0]);
            let ahead = bases.reach(x, i, true, noise_m, &mut hint[1]);
            if bases.degree == CUBIC {
                cubic_reach = [behind, ahead];
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
                .find(|(b, a)| bases.fit(x, i - b, i + a + 1, i, noise_m).is_some());
            // Three quarters of what just passes: there the bias is below the noise, not equal to it.
            let fit = found.and_then(|&(b, a)| {
                let (b, a) = ((3 * b).div_ceil(4), (3 * a).div_ceil(4));
                smooth[i] |= b + a >= 2 * bases.degree;
                bases.fit(x, i - b, i + a + 1, i, noise_m)
            });
            if let Some(f) = fit {
                best = Some(best.map_or(f, |o| if f.slope_variance < o.slope_variance { f } else { o }));
            }
        }
        if let Some(f) = best {
            (value[i], left[i], right[i]) = (f.value, f.slope, f.slope);
            continue;
        }
        // A corner: each side on its own.
        let [behind, ahead] = cubic_reach;
        let cubic = &BASES[0];
        let from_left = (behind >= 3)
            .then(|| cubic.fit(x, i - behind, i + 1, i, noise_m))
            .flatten();
        let from_right = (ahead >= 3)
            .then(|| cubic.fit(x, i, i + ahead + 1, i, noise_m))
            .flatten();
        value[i] = match (from_left, from_right) {
            (Some(a), Some(b)) => (behind as f64 * a.value + ahead as f64 * b.value) / (behind + ahead) as f64,
            (Some(f), None) | (None, Some(f)) => f.value,
            (None, None) => x[i],
        };
        left[i] = from_left.map_or_else(|| if i > 0 { x[i] - x[i - 1] } else { 0.0 }, |f| f.slope);
        right[i] = from_right.map_or_else(|| if i + 1 < n { x[i + 1] - x[i] } else { 0.0 }, |f| f.slope);
    }
    // Where the neighbourhood is short, a cubic through the speeds may overshoot and come back, which turns friction
    // round that never turned: there the motion between two samples is kept monotone (Fritsch & Carlson 1980).
    let monotone = |speed: f64, chord: f64| {
        if speed * chord <= 0.0 {
            0.0
        } else {
            speed.abs().min(3.0 * chord.abs()).copysign(chord)
        }
    };
    for i in (0..n).filter(|i| !smooth[*i]) {
        if i > 0 {
            left[i] = monotone(left[i], value[i] - value[i - 1]);
        }
        if i + 1 < n {
            right[i] = monotone(right[i], value[i + 1] - value[i]);
        }
    }
    // Held still: exactly still. What is left of the noise would creep presliding friction back to nothing.
    for (from, to) in holds(x, noise_m) {
        let mean = x[from..to].iter().sum::<f64>() / (to - from) as f64;
        value[from..to].fill(mean);
        left[from + 1..to].fill(0.0);
        right[from..to - 1].fill(0.0);
        // A move whose speed would carry it farther than the hold ended, or began, between two samples.
        if from >= 1 && left[from - 1] / (mean - value[from - 1]) > 2.0 {
            (right[from - 1], left[from]) = (left[from - 1], 0.0);
        }
        if to < n && right[to] / (value[to] - mean) > 2.0 {
            (left[to], right[to - 1]) = (right[to], 0.0);
        }
        // A move ends where the hold is, not beyond it: coming back by the noise (10 um) would turn a seal's friction
        // by tens of newtons, and it would stay so for the whole hold.
        if from >= 2 && (value[from - 2] - mean) * (value[from - 1] - mean) < 0.0 {
            (value[from - 1], right[from - 1], left[from]) = (mean, 0.0, 0.0);
        }
        if to + 1 < n && (value[to + 1] - mean) * (value[to] - mean) < 0.0 {
            (value[to], left[to], right[to - 1]) = (mean, 0.0, 0.0);
        }
    }
    let segments = (1..n)
        .map(|i| Segment {
            to_m: value[i],
            from_m_s: right[i - 1] / interval_s,
            to_m_s: left[i] / interval_s,
        })
        .collect();
    Motion {
        start_m: value[0],
        segments,
    }
}

/// Shortest stretch that is called a hold, samples.
const SHORTEST_HOLD: usize = 16;

/// Stretches `from..to` in which the displacement does not change but for its noise, in order, apart from each other.
fn holds(x: &[f64], noise: f64) -> Vec<(usize, usize)> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    let mut from = 0;
    while from + SHORTEST_HOLD <= x.len() {
        let mut sum = 0.0;
        let mut to = from;
        while to < x.len() {
            let mean = sum / (to - from) as f64;
            let still = |k: usize, quantile: f64| x.get(k).is_some_and(|v| (v - mean).abs() <= quantile * noise);
            // One sample far off between two that are not is noise, once in sixteen thousand.
            if to >= from + 4 && !still(to, 4.0) && !still(to + 1, 3.0) {
                break;
            }
            sum += x[to];
            to += 1;
        }
        let n = (to - from) as f64;
        let (mean, middle) = (sum / n, 0.5 * (n - 1.0));
        let (mut square, mut slope) = (0.0, 0.0);
        for (i, v) in x[from..to].iter().enumerate() {
            square += (v - mean) * (v - mean);
            slope += (v - mean) * (i as f64 - middle);
        }
        // Standard deviation of `slope` is noise * sqrt(sum of squares of the abscissa).
        let trend = noise * (n * (n * n - 1.0) / 12.0).sqrt();
        let quiet = square <= noise * noise * largest_chi_square(n - 1.0) && slope.abs() <= 3.0 * trend;
        if to - from >= SHORTEST_HOLD && quiet {
            // The search goes in strides: the hold began where its first sample is.
            let before = found.last().map_or(0, |(_, to)| *to);
            while from > before && (x[from - 1] - mean).abs() <= 3.0 * noise {
                from -= 1;
            }
            found.push((from, to));
            from = to;
        } else {
            from += SHORTEST_HOLD / 4;
        }
    }
    found
}

fn as_recorded(x: &[f64], interval_s: f64) -> Motion {
    let segments = x.windows(2).map(|w| {
        let v = (w[1] - w[0]) / interval_s;
        Segment {
            to_m: w[1],
            from_m_s: v,
            to_m_s: v,
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
    use rand::{Rng, SeedableRng};

    const NOISE: f64 = 5e-6;

    /// Standard normal by the sum of twelve uniform numbers: enough for a test.
    fn noisy(truth: impl Fn(f64) -> f64, n: usize, dt: f64) -> Vec<f64> {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        (0..n)
            .map(|i| {
                let sum: f64 = (0..12).map(|_| f64::from(rng.next_u32()) / 4_294_967_296.0).sum();
                truth(i as f64 * dt) + NOISE * (sum - 6.0)
            })
            .collect()
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
        assert_eq!(holds(&x, NOISE).iter().filter(|(from, _)| *from > 505).count(), 0);
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
            let (a, b, rise) = (s.from_m_s * takes, s.to_m_s * takes, s.to_m - at);
            for k in 1..=10 {
                let u = f64::from(k) / 10.0;
                farthest = farthest.max(at + u * (a + u * (3.0 * rise - 2.0 * a - b + u * (a + b - 2.0 * rise))));
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

    #[test]
    fn a_segment_from_or_to_rest_moves_at_constant_acceleration_within_its_interval() {
        let s = |from_m_s, to_m_s| Segment {
            to_m: 1e-3,
            from_m_s,
            to_m_s,
        };
        assert_eq!(s(0.2, 0.0).moves_within(0.0, 0.02), (0.0, 0.01));
        assert_eq!(s(0.0, 0.2).moves_within(0.0, 0.02), (0.01, 0.01));
        for whole in [s(0.08, 0.0), s(0.0, 0.08), s(-0.2, 0.0), s(0.2, 0.2), s(0.0, 0.0)] {
            assert_eq!(whole.moves_within(0.0, 0.02), (0.0, 0.02), "{whole:?}");
        }
    }
}
