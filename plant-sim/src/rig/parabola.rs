//! The parabola the report fits to its measured response times (figure 25).

use nalgebra::{Matrix3, Vector3};

/// `y = c0 + c1 x + c2 x^2` by least squares.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parabola {
    /// Coefficients `c0`, `c1`, `c2` of the parabola `c0 + c1 x + c2 x^2`.
    pub coefficients: [f64; 3],
    /// Root mean square of the residuals, unit of y.
    pub residual: f64,
}

impl Parabola {
    /// Fits points `(x, y)`; none where fewer than three differ in x.
    #[must_use]
    pub fn fit(points: &[(f64, f64)]) -> Option<Self> {
        // With x scaled to about 1 the normal equations of three columns are well conditioned.
        let scale = points.iter().fold(0.0, |most: f64, point| most.max(point.0.abs()));
        let row = |x: f64| Vector3::new(1.0, x / scale, x / scale * (x / scale));
        let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for &(x, y) in points {
            normal += row(x) * row(x).transpose();
            right += row(x) * y;
        }
        let solved = nalgebra::linalg::Cholesky::new(normal)?.solve(&right);
        let coefficients = [solved[0], solved[1] / scale, solved[2] / (scale * scale)];
        let fit = Self {
            coefficients,
            residual: 0.0,
        };
        let square: f64 = points.iter().map(|&(x, y)| (y - fit.at(x)) * (y - fit.at(x))).sum();
        let residual = (square / points.len() as f64).sqrt();
        coefficients
            .iter()
            .all(|c| c.is_finite())
            .then_some(Self { residual, ..fit })
    }

    /// Value of the parabola at x.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        let [c0, c1, c2] = self.coefficients;
        c0 + x * (c1 + x * c2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recovers_the_parabola_it_was_given() {
        let points: Vec<(f64, f64)> = (1..=14)
            .map(|i| f64::from(i) * 1e6)
            .map(|x| (x, 0.04 + 2.2e-9 * x + 6e-17 * x * x))
            .collect();
        let fit = Parabola::fit(&points).expect("enough points");
        assert!((fit.coefficients[0] / 0.04 - 1.0).abs() < 1e-6, "{fit:?}");
        assert!(
            (fit.coefficients[2] / 6e-17 - 1.0).abs() < 1e-5 && fit.residual < 1e-9,
            "{fit:?}"
        );
    }

    #[test]
    fn two_places_are_no_parabola() {
        assert!(Parabola::fit(&[(1.0, 1.0), (2.0, 2.0), (2.0, 2.1)]).is_none());
        assert!(Parabola::fit(&[]).is_none());
    }
}
