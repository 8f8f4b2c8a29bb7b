//! A table read with linear interpolation, as SIMULINK's look-up block does, but going on straight beyond its ends: the
//! report's program stopped where its tables did.

/// Points `(x, y)` with `x` strictly increasing.
#[derive(Debug, Clone, PartialEq)]
pub struct LookUpTable {
    x: Vec<f64>,
    y: Vec<f64>,
}

impl LookUpTable {
    /// Tabulates `law` at `intervals + 1` evenly spaced arguments from `from` to `to` (`from < to`, at least one interval).
    #[must_use]
    pub fn tabulate(from: f64, to: f64, intervals: usize, law: impl Fn(f64) -> f64) -> Self {
        let intervals = intervals.max(1);
        let x: Vec<f64> = (0..=intervals)
            .map(|i| from + (to - from) * (i as f64 / intervals as f64))
            .collect();
        let y = x.iter().map(|&x| law(x)).collect();
        Self { x, y }
    }

    /// Value at `x`; linear between points and beyond the ends.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        // Of the segments the one whose right end is not below x; the outer ones serve beyond the ends.
        let last = self.x.len() - 1;
        let right = self.x.partition_point(|&point| point < x).clamp(1, last);
        let (x0, x1) = (self.x[right - 1], self.x[right]);
        let (y0, y1) = (self.y[right - 1], self.y[right]);
        y0 + (y1 - y0) * ((x - x0) / (x1 - x0))
    }

    /// The points, for a picture or a file.
    #[must_use]
    pub fn points(&self) -> (&[f64], &[f64]) {
        (&self.x, &self.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_on_points_linear_between_and_straight_beyond() {
        let table = LookUpTable::tabulate(0.0, 2.0, 2, |x| x * x);
        for (x, y) in [
            (0.0, 0.0),
            (1.0, 1.0),
            (2.0, 4.0),
            (0.5, 0.5),
            (1.5, 2.5),
            (3.0, 7.0),
            (-1.0, -1.0),
        ] {
            assert!((table.at(x) - y).abs() < 1e-12, "{x}");
        }
    }

    proptest::proptest! {
        #[test]
        fn reproduces_any_straight_line(a in -1e3..1e3f64, b in -1e3..1e3f64, x in -5.0..5.0f64) {
            let table = LookUpTable::tabulate(-1.0, 1.0, 7, |x| a + b * x);
            proptest::prop_assert!((table.at(x) - (a + b * x)).abs() < 1e-9);
        }
    }
}
