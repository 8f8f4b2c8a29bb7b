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

    /// Value of a curved signal there.
    pub fn of_curved(self, y: &[f64]) -> f64 {
        let line = self.of(y);
        match self {
            Self::At(_) => line,
            Self::Before(i, part) => {
                let before = i.checked_sub(2).and_then(|before| y.get(before));
                let around = [before, y.get(i - 1), y.get(i), y.get(i + 1)];
                line - 0.5 * part * (1.0 - part) * curvature(around.map(Option::<&f64>::copied))
            }
        }
    }
}

/// Second difference of a signal over the interval from one sample to the next, `around` it the sample before, the two samples, and the one after: the smaller one of those
/// at its ends, and none where these have different signs (minmod, Roe, Ann. Rev. Fluid Mech. 18, 1986), so that nothing overshoots where the signal jumps.
pub(super) fn curvature(around: [Option<f64>; 4]) -> f64 {
    let [Some(before), Some(begin), Some(end), Some(after)] = around else {
        return 0.0;
    };
    let (a, b) = (before - 2.0 * begin + end, begin - 2.0 * end + after);
    if a * b <= 0.0 {
        0.0
    } else if a.abs() < b.abs() {
        a
    } else {
        b
    }
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
                let exact = 2.0 - 3.0 * at.clamp(x[0], x[39]);
                let found = places.find(at);
                proptest::prop_assert!((found.of(&y) - exact).abs() < 1e-9);
                // To the bit, whatever was asked for before.
                proptest::prop_assert_eq!(found, Places::over(&x).find(at));
            }
        }
    }

    #[test]
    fn an_empty_signal_and_one_sample_have_a_value_everywhere() {
        assert_eq!(Places::over(&[]).find(1.0).of(&[]), 0.0);
        for at in [-1.0, 0.0, 1.0] {
            assert_eq!(Places::over(&[0.0]).find(at).of(&[7.0]), 7.0);
        }
    }
}
