//! How a cost grows with the work: the exponent of a power law, and what it means in words.

/// Cost in proportion to `work` to the power of `exponent`, with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    pub exponent: f64,
    pub low: f64,
    pub high: f64,
}

/// What an exponent means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, strum::Display, strum::VariantArray)]
#[strum(serialize_all = "snake_case")]
pub enum Kind {
    /// Hardly grows.
    Constant,
    /// Grows, but less than the work.
    SlowerThanLinear,
    /// Grows as the work.
    Linear,
    /// Grows more than the work.
    FasterThanLinear,
    /// The points do not tell.
    Undecided,
}

/// An exponent this near to 0 or 1 counts as 0 or 1: over a hundredfold of work it is a quarter more or less.
const NEAR: f64 = 0.05;
/// A wider half of an interval tells nothing.
const WIDEST: f64 = 0.25;
/// Fewest points of a fit: two have no interval.
const FEWEST: usize = 3;
/// Fewest points of the larger half: with three the interval is five times as wide.
const FEWEST_LARGE: usize = 4;

/// Student's t at 97.5 % for 1, 2, ... degrees of freedom; beyond the last the normal distribution's 1.96 is within 5 %.
const T_975: [f64; 20] = [
    12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160, 2.145, 2.131, 2.120,
    2.110, 2.101, 2.093, 2.086,
];

impl Growth {
    /// The least-squares line through the logarithms of work and cost; `None` for fewer than three points, or a cost of zero.
    pub fn of(work: &[f64], cost: &[f64]) -> Option<Self> {
        let points: Vec<(f64, f64)> = (work.iter().zip(cost))
            .map(|(work, cost)| (libm::log(*work), libm::log(*cost)))
            .collect();
        let n = points.len();
        if n < FEWEST || points.iter().any(|(x, y)| !(x.is_finite() && y.is_finite())) {
            return None;
        }
        let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n as f64;
        let (x0, y0) = (mean(|p| p.0), mean(|p| p.1));
        let sxx: f64 = points.iter().map(|(x, _)| (x - x0) * (x - x0)).sum();
        let sxy: f64 = points.iter().map(|(x, y)| (x - x0) * (y - y0)).sum();
        let exponent = sxy / sxx;
        let left: f64 = (points.iter())
            .map(|(x, y)| y - y0 - exponent * (x - x0))
            .map(|residual| residual * residual)
            .sum();
        let freedom = n - 2;
        let half = T_975.get(freedom - 1).copied().unwrap_or(1.96) * (left / freedom as f64 / sxx).sqrt();
        Some(Self {
            exponent,
            low: exponent - half,
            high: exponent + half,
        })
    }

    /// The growth over the larger half of the points, where what does not grow weighs little.
    pub fn of_large(work: &[f64], cost: &[f64]) -> Option<Self> {
        let first = (work.len() / 2).min(work.len().saturating_sub(FEWEST_LARGE));
        Self::of(&work[first..], &cost[first..])
    }

    /// What the exponent means.
    pub fn kind(&self) -> Kind {
        if 0.5 * (self.high - self.low) > WIDEST {
            Kind::Undecided
        } else if self.high < 2.0 * NEAR || self.exponent.abs() <= NEAR {
            Kind::Constant
        } else if self.low <= 1.0 + NEAR && self.high >= 1.0 - NEAR {
            Kind::Linear
        } else if self.exponent < 1.0 {
            Kind::SlowerThanLinear
        } else {
            Kind::FasterThanLinear
        }
    }
}

impl Kind {
    /// The kind as a predicate of a cost.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Constant => "is constant",
            Self::SlowerThanLinear => "grows more slowly than the work",
            Self::Linear => "is linear in the work",
            Self::FasterThanLinear => "grows faster than the work",
            Self::Undecided => "scatters too much to tell how it grows",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn power(exponent: f64, work: &[f64]) -> Vec<f64> {
        work.iter().map(|w| 3.0 * libm::pow(*w, exponent)).collect()
    }

    #[test]
    fn a_power_law_gives_its_exponent_and_its_kind() {
        let work = [1.0, 10.0, 100.0, 1000.0];
        for (exponent, kind) in [
            (0.0, Kind::Constant),
            (0.5, Kind::SlowerThanLinear),
            (1.0, Kind::Linear),
            (2.0, Kind::FasterThanLinear),
        ] {
            let growth = Growth::of(&work, &power(exponent, &work)).expect("a fit");
            assert!((growth.exponent - exponent).abs() < 1e-12 && growth.high - growth.low < 1e-6);
            assert_eq!(growth.kind(), kind);
        }
    }

    #[test]
    fn the_interval_is_that_of_the_textbook() {
        // Residuals -r, 2 r, -r at x = -1, 0, 1: s^2 = 6 r^2, standard error of the slope sqrt(3) r, t = 12.706.
        let (r, e) = (0.01, std::f64::consts::E);
        let work = [1.0 / e, 1.0, e];
        let cost = [libm::exp(-1.0 - r), libm::exp(2.0 * r), libm::exp(1.0 - r)];
        let growth = Growth::of(&work, &cost).expect("a fit");
        assert!((growth.exponent - 1.0).abs() < 1e-12);
        assert!((growth.high - 1.0 - 12.706 * 3.0_f64.sqrt() * r).abs() < 1e-9);
    }

    #[test]
    fn what_does_not_grow_weighs_little_in_the_larger_half() {
        let work = [1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6, 1e7];
        let cost: Vec<f64> = work.iter().map(|w| 500.0 + w).collect();
        let (all, large) = (Growth::of(&work, &cost), Growth::of_large(&work, &cost));
        assert!(all.expect("a fit").exponent < 0.8 && large.expect("a fit").exponent > 0.95);
    }

    #[test]
    fn too_little_is_no_fit_and_scatter_is_no_verdict() {
        assert_eq!(Growth::of(&[1.0, 2.0], &[1.0, 2.0]), None);
        assert_eq!(Growth::of(&[1.0, 2.0, 3.0], &[0.0, 1.0, 2.0]), None);
        let scattered = Growth::of(&[1.0, 2.0, 4.0], &[1.0, 8.0, 2.0]).expect("a fit");
        assert_eq!(scattered.kind(), Kind::Undecided);
    }
}
