//! Linear interpolation of a nearly evenly sampled signal.

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
