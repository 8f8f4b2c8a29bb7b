//! Linear interpolation of a nearly evenly sampled signal.

/// Value of a signal `y` over increasing `x` at `at`, constant beyond the ends; 0 for an empty signal.
pub(super) fn interpolate(x: &[f64], y: &[f64], at: f64) -> f64 {
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

    proptest::proptest! {
        #[test]
        fn a_straight_line_is_found_again_and_its_ends_go_on(at in -1.0..5.0f64, jitter in 0.0..0.9f64) {
            let x: Vec<f64> = (0..40).map(|i| 0.1 * f64::from(i) + if i % 3 == 1 { 0.1 * jitter } else { 0.0 }).collect();
            let y: Vec<f64> = x.iter().map(|x| 2.0 - 3.0 * x).collect();
            let exact = 2.0 - 3.0 * at.clamp(x[0], x[39]);
            proptest::prop_assert!((interpolate(&x, &y, at) - exact).abs() < 1e-9);
        }
    }
}
