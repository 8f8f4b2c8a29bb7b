//! The chi-square limit: how large a residual of a fit can be because of noise alone.

/// A fit passes unless noise alone would do worse once in ten thousand times: this quantile of the normal distribution.
const TEST_QUANTILE: f64 = 3.7;

/// Largest sum of squares of `freedom` unit normals that passes.
///
/// The cube-root approximation of Wilson & Hilferty (Proc. Natl. Acad. Sci. 17, 1931): 7 % above the quantile for one degree
/// of freedom, 1.1 % for ten, 0.07 % for a hundred. `statrs` has the exact quantile, by a search; every published noise
/// ratio rests on the bits of this one.
pub(super) fn largest_chi_square(freedom: f64) -> f64 {
    let spread = 2.0 / (9.0 * freedom);
    let root = 1.0 - spread + TEST_QUANTILE * spread.sqrt();
    freedom * root * root * root
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles of the chi-square distribution at the same probability, from SciPy 1.16 (`chi2.isf(norm.sf(3.7), f)`).
    #[test]
    fn is_near_the_quantile_of_the_chi_square_distribution() {
        for (freedom, exact, within) in [
            (1.0, 14.994942, 0.07),
            (10.0, 35.373510, 0.012),
            (100.0, 160.951119, 0.001),
        ] {
            let found = largest_chi_square(freedom);
            assert!((found / exact - 1.0).abs() < within, "{freedom}: {found} {exact}");
        }
    }
}
