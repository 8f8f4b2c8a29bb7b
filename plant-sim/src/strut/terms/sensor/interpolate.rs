//! Interpolation of a nearly evenly sampled signal: linear, or with the curvature that the samples on both sides of an interval agree on.
//!
//! A straight line from sample to sample is off by up to an eighth of the second difference. This is as much as an instrument that is late by a part of the
//! sampling interval differs from one that lags by as much, so that the two could not be told apart.

/// A place between the samples of a signal over increasing `x`, which is constant beyond its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Place {
    /// At a sample, or beyond the first or last one.
    At(usize),
    /// At this part of the way from the sample before to this one.
    Before(usize, f64),
}

impl Place {
    /// Value of a signal there; 0 for an empty one.
    pub fn of(self, y: &[f64]) -> f64 {
        match self {
            Self::At(i) => y.get(i).copied().unwrap_or_default(),
            Self::Before(i, part) => y[i - 1] + (y[i] - y[i - 1]) * part,
        }
    }

    /// Value of a signal `y` over `x` there, curved between its samples by its curvatures.
    pub fn of_curved(self, x: &[f64], y: &[f64], curvatures: &[f64]) -> f64 {
        let line = self.of(y);
        match self {
            Self::At(_) => line,
            Self::Before(i, part) => line - part * (1.0 - part) * bend(&curvatures[i - 1..=i], x[i] - x[i - 1]),
        }
    }
}

/// Half the second derivative of a signal `y` over increasing `x` at each sample, by its neighbours; 0 at the ends, which have one.
pub(super) fn curvatures(x: &[f64], y: &[f64]) -> Vec<f64> {
    let mut all = vec![0.0; y.len()];
    let slope = |a: usize, b: usize| (y[b] - y[a]) / (x[b] - x[a]);
    let mut before = if y.len() > 1 { slope(0, 1) } else { 0.0 };
    for k in 1..y.len().saturating_sub(1) {
        let after = slope(k, k + 1);
        all[k] = (after - before) / (x[k + 1] - x[k - 1]);
        before = after;
    }
    all
}

/// What the curvature of a signal adds over an interval: half its second derivative times the interval squared. Of the curvatures at both ends the smaller one counts,
/// and none where they have different signs (minmod, Roe, Ann. Rev. Fluid Mech. 18, 1986), so that nothing overshoots where the signal jumps, nor where an end is
/// that of the signal.
pub(super) fn bend(at_ends: &[f64], interval: f64) -> f64 {
    let &[first, second] = at_ends else { return 0.0 };
    if first * second <= 0.0 {
        return 0.0;
    }
    let smaller = if first.abs() < second.abs() { first } else { second };
    smaller * interval * interval
}

/// Finds places over increasing `x` one after the other: from the place that was found last, the next one is usually a sample further.
pub(super) struct Places<'x> {
    x: &'x [f64],
    /// The first sample beyond the last place.
    beyond: usize,
}

impl<'x> Places<'x> {
    pub const fn over(x: &'x [f64]) -> Self {
        Self { x, beyond: 1 }
    }

    pub fn find(&mut self, at: f64) -> Place {
        let x = self.x;
        let last = x.len().saturating_sub(1);
        if x.is_empty() || at < x[0] {
            return Place::At(0);
        }
        if at >= x[last] {
            return Place::At(last);
        }
        while x[self.beyond] <= at {
            self.beyond += 1;
        }
        while x[self.beyond - 1] > at {
            self.beyond -= 1;
        }
        let i = self.beyond;
        Place::Before(i, (at - x[i - 1]) / (x[i] - x[i - 1]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    proptest::proptest! {
        #[test]
        fn a_straight_line_is_found_again_and_its_ends_go_on(ats in proptest::collection::vec(-1.0..5.0f64, 1..9), jitter in 0.0..0.9f64) {
            let x: Vec<f64> = (0..40).map(|i| 0.1 * f64::from(i) + if i % 3 == 1 { 0.1 * jitter } else { 0.0 }).collect();
            let y: Vec<f64> = x.iter().map(|x| 2.0 - 3.0 * x).collect();
            let mut places = Places::over(&x);
            for at in ats {
                let inside = at.clamp(x[0], x[39]);
                let exact = 2.0 - 3.0 * inside;
                let found = places.find(at);
                proptest::prop_assert!((found.of(&y) - exact).abs() < 1e-9);
                proptest::prop_assert!((found.of_curved(&x, &y, &curvatures(&x, &y)) - exact).abs() < 1e-9);
                // A parabola too, where there is a sample on either side of the interval.
                let parabola: Vec<f64> = x.iter().map(|x| x * x).collect();
                let curved = (found.of_curved(&x, &parabola, &curvatures(&x, &parabola)) - inside * inside).abs();
                proptest::prop_assert!(curved < 1e-9 || inside < x[1] || inside > x[38]);
                // To the bit, whatever was asked for before.
                proptest::prop_assert_eq!(found, Places::over(&x).find(at));
            }
        }
    }

    #[test]
    fn an_empty_signal_and_one_sample_have_a_value_everywhere() {
        assert_eq!(Places::over(&[]).find(1.0).of(&[]), 0.0);
        assert!(curvatures(&[], &[]).is_empty());
        assert_eq!(curvatures(&[0.0], &[7.0]), [0.0]);
        for at in [-1.0, 0.0, 1.0] {
            assert_eq!(Places::over(&[0.0]).find(at).of(&[7.0]), 7.0);
        }
    }
}
