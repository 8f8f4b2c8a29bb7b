//! Finds the stretches without motion, and how strokes begin and end at them.

use super::chi_square::largest_chi_square;
use super::samples::Samples;

/// Shortest stretch that is called a hold, samples.
const SHORTEST_HOLD: usize = 16;

/// Make every hold exactly still. What is left of the noise would creep presliding friction back to nothing.
pub(super) fn hold_still(samples: &mut Samples, recorded: &[f64], noise: f64) {
    let Samples { value, before, after } = samples;
    let n = recorded.len();
    for (from, to) in holds(recorded, noise) {
        let mean = recorded[from..to].iter().sum::<f64>() / (to - from) as f64;
        value[from..to].fill(mean);
        before[from + 1..to].fill(0.0);
        after[from..to - 1].fill(0.0);
        // A move whose speed would carry it farther than the hold ended, or began, between two samples.
        if from >= 1 && before[from - 1] / (mean - value[from - 1]) > 2.0 {
            (after[from - 1], before[from]) = (before[from - 1], 0.0);
        }
        if to < n && after[to] / (value[to] - mean) > 2.0 {
            (before[to], after[to - 1]) = (after[to], 0.0);
        }
        // A move ends where the hold is, not beyond it: coming back by the noise (10 um) would turn a seal's friction
        // by tens of newtons, and it would stay so for the whole hold.
        if from >= 2 && (value[from - 2] - mean) * (value[from - 1] - mean) < 0.0 {
            (value[from - 1], after[from - 1], before[from]) = (mean, 0.0, 0.0);
        }
        if to + 1 < n && (value[to + 1] - mean) * (value[to] - mean) < 0.0 {
            (value[to], before[to], after[to - 1]) = (mean, 0.0, 0.0);
        }
    }
}

/// Stretches `from..to` in which the displacement does not change but for its noise, in order, apart from each other.
fn holds(x: &[f64], noise: f64) -> Vec<(usize, usize)> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    let mut from = 0;
    while from + SHORTEST_HOLD <= x.len() {
        let to = still_until(x, from, noise);
        let (mean, quiet) = is_quiet(&x[from..to], noise);
        if to - from >= SHORTEST_HOLD && quiet {
            // The search goes in strides: the hold began where its first sample is.
            let earliest = found.last().map_or(0, |(_, to)| *to);
            while from > earliest && (x[from - 1] - mean).abs() <= 3.0 * noise {
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

/// The first sample from `from` on that no longer stands still.
fn still_until(x: &[f64], from: usize, noise: f64) -> usize {
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
    to
}

/// Mean of some samples, and whether they show neither more than noise nor a trend.
fn is_quiet(x: &[f64], noise: f64) -> (f64, bool) {
    let n = x.len() as f64;
    let (mean, middle) = (x.iter().sum::<f64>() / n, 0.5 * (n - 1.0));
    let (mut square, mut slope) = (0.0, 0.0);
    for (i, v) in x.iter().enumerate() {
        square += (v - mean) * (v - mean);
        slope += (v - mean) * (i as f64 - middle);
    }
    // Standard deviation of `slope` is noise * sqrt(sum of squares of the abscissa).
    let trend = noise * (n * (n * n - 1.0) / 12.0).sqrt();
    let quiet = square <= noise * noise * largest_chi_square(n - 1.0) && slope.abs() <= 3.0 * trend;
    (mean, quiet)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hold_is_found_from_its_first_sample_to_its_last() {
        let x: Vec<f64> = (0..300)
            .map(|i| match i {
                0..50 => 1e-3 * f64::from(i),
                50..200 => 0.05 + 1e-6 * f64::from(i % 3),
                _ => 0.05 - 1e-3 * f64::from(i - 200),
            })
            .collect();
        assert_eq!(holds(&x, 5e-6), [(50, 201)]);
        assert!(holds(&x[..60], 5e-6).is_empty(), "ten samples are no hold");
    }
}
