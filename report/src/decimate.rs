//! A page draws some 1500 pixels across, a run has a million samples: what is not visible is not sent, but no peak
//! may vanish. Plain thinning loses peaks, so each bucket keeps its extremes.

use std::borrow::Cow;

/// Reduces a polyline to about `6 * buckets` points at most, in their order: of every bucket of consecutive samples the first, the last
/// and those with extreme x and y. Works on loops (force over displacement) as on time histories; a NaN sample, which is
/// a gap in the line, stays one. Returned unchanged where that would not make it shorter.
///
/// `x` and `y` pair up; surplus samples of the longer are ignored.
///
/// ```
/// use oleo_report::extrema_by_bucket;
/// let time: Vec<f64> = (0..10_000).map(f64::from).collect();
/// let mut force = vec![0.0; 10_000];
/// force[4321] = 900.0;
/// let (shown, peak) = extrema_by_bucket(&time, &force, 100);
/// assert!(shown.len() <= 600 && peak.contains(&900.0));
/// ```
pub fn extrema_by_bucket<'a>(x: &'a [f64], y: &'a [f64], buckets: usize) -> (Cow<'a, [f64]>, Cow<'a, [f64]>) {
    let count = x.len().min(y.len());
    let (x, y) = (&x[..count], &y[..count]);
    if buckets == 0 || count <= 6 * buckets {
        return (x.into(), y.into());
    }
    let mut kept: Vec<usize> = Vec::with_capacity(7 * buckets);
    for bucket in 0..buckets {
        let (from, to) = (bucket * count / buckets, (bucket + 1) * count / buckets);
        let mut candidates = vec![from, to - 1];
        let finite = || (from..to).filter(|&i| x[i].is_finite() && y[i].is_finite());
        for values in [x, y] {
            candidates.extend(finite().min_by(|&a, &b| values[a].total_cmp(&values[b])));
            candidates.extend(finite().max_by(|&a, &b| values[a].total_cmp(&values[b])));
        }
        candidates.extend((from..to).find(|&i| y[i].is_nan()));
        candidates.sort_unstable();
        candidates.dedup();
        kept.extend(candidates);
    }
    (
        kept.iter().map(|&i| x[i]).collect(),
        kept.iter().map(|&i| y[i]).collect(),
    )
}

/// Nine significant digits: finer than any screen, and half the size of the page's data.
pub(crate) fn rounded(values: &[f64]) -> Vec<f64> {
    values.iter().map(|&value| to_digits(value, 9)).collect()
}

/// Six significant digits, for what is drawn and not placed: a thousandth of a pixel before anything is zoomed.
pub(crate) fn drawn(values: &[f64]) -> Vec<f64> {
    values.iter().map(|&value| to_digits(value, 6)).collect()
}

fn to_digits(value: f64, digits: usize) -> f64 {
    if value.is_finite() {
        format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
    } else {
        f64::NAN
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_series_pass_unchanged() {
        let x = [0.0, 1.0];
        let (kept, _) = extrema_by_bucket(&x, &x, 10);
        assert_eq!(kept.as_ref(), &x);
    }

    #[test]
    fn a_single_sample_peak_survives() {
        let x: Vec<f64> = (0..100_000).map(f64::from).collect();
        let mut y = vec![0.0; x.len()];
        y[43_210] = 7.0;
        y[43_300] = -9.0;
        let (kept_x, kept_y) = extrema_by_bucket(&x, &y, 100);
        assert!(kept_x.len() <= 600 && kept_x.len() == kept_y.len());
        assert!(kept_x.iter().zip(kept_y.iter()).any(|point| point == (&43_210.0, &7.0)));
        assert!(kept_y.contains(&-9.0));
        assert_eq!((kept_x[0], kept_x[kept_x.len() - 1]), (0.0, 99_999.0));
        assert!(kept_x.windows(2).all(|pair| pair[0] < pair[1]), "order is kept");
    }

    #[test]
    fn a_gap_stays_a_gap() {
        let x: Vec<f64> = (0..10_000).map(f64::from).collect();
        let mut y = x.clone();
        y[5_005] = f64::NAN;
        let (_, kept) = extrema_by_bucket(&x, &y, 50);
        assert_eq!(kept.iter().filter(|value| value.is_nan()).count(), 1);
    }

    #[test]
    fn a_loop_keeps_its_turning_points() {
        let angle: Vec<f64> = (0..50_000).map(|i| f64::from(i) * 1e-3).collect();
        let x: Vec<f64> = angle.iter().map(|&a| libm::cos(a)).collect();
        let y: Vec<f64> = angle.iter().map(|&a| libm::sin(a)).collect();
        let (kept_x, kept_y) = extrema_by_bucket(&x, &y, 200);
        let largest = |values: &[f64]| values.iter().copied().fold(f64::MIN, f64::max);
        assert_eq!(largest(&kept_x), largest(&x));
        assert_eq!(largest(&kept_y), largest(&y));
    }

    #[test]
    fn fewer_digits_are_enough_and_shorter() {
        assert_eq!(to_digits(0.1 + 0.2, 9), 0.3);
        assert_eq!(to_digits(12_345.678_901_234, 9), 12_345.678_9);
        assert_eq!(drawn(&[12_345.678_901_234]), [12_345.7]);
        assert!(to_digits(f64::INFINITY, 9).is_nan());
    }
}
