//! How often something was so, with its interval, and the middle of figures.

use serde::Serialize;

/// A part of a number of trials.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Rate {
    /// Number of campaigns in which it was so.
    pub hits: usize,
    /// Times it could have been.
    pub of: usize,
}

impl Rate {
    pub(super) fn count(&mut self, hit: bool) {
        self.of += 1;
        self.hits += usize::from(hit);
    }

    /// The part, not a number where nothing was tried.
    #[must_use]
    pub fn part(self) -> f64 {
        self.hits as f64 / self.of as f64
    }

    /// 95 % score interval (Wilson, J. Amer. Statist. Assoc. 22, 1927).
    #[must_use]
    pub fn interval(self) -> [f64; 2] {
        const Z: f64 = 1.959_964;
        let (n, p) = (self.of as f64, self.part());
        if self.of == 0 {
            return [0.0, 1.0];
        }
        let middle = p + Z * Z / (2.0 * n);
        let half = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
        let below = 1.0 + Z * Z / n;
        // Exact at the ends, where rounding would leave a trace.
        let low = if self.hits == 0 { 0.0 } else { (middle - half) / below };
        let high = if self.hits == self.of {
            1.0
        } else {
            (middle + half) / below
        };
        [low, high]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wilson_intervals_are_those_of_the_books() {
        // Newcombe, Statist. Med. 17, 1998, table I: 81 of 263, and 0 of 20.
        let [low, high] = Rate { hits: 81, of: 263 }.interval();
        assert!(
            (low - 0.2553).abs() < 1e-4 && (high - 0.3662).abs() < 1e-4,
            "{low} {high}"
        );
        let [low, high] = Rate { hits: 0, of: 20 }.interval();
        assert!(low == 0.0 && (high - 0.1611).abs() < 1e-4, "{high}");
    }
}
