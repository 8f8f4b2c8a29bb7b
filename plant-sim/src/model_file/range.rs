//! Ranges of the numbers in a model file.

use std::fmt;

/// The values that a number may have. No range contains infinity or NaN.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Range {
    /// Any finite number is permitted.
    Finite,
    /// From the first number to the second, both included.
    FromTo(f64, f64),
    /// From the first number, included, to the second, excluded.
    FromToBelow(f64, f64),
    /// One of these numbers.
    OneOf(&'static [f64]),
}

impl Range {
    /// Whether a number lies in the range.
    ///
    /// ```
    /// use oleo_plant_sim::model_file::Range;
    /// assert!(Range::FromTo(0.0, 1.0).contains(1.0));
    /// assert!(!Range::FromToBelow(0.0, 1.0).contains(1.0));
    /// assert!(!Range::Finite.contains(f64::NAN));
    /// ```
    #[must_use]
    pub fn contains(self, number: f64) -> bool {
        number.is_finite()
            && match self {
                Self::Finite => true,
                Self::FromTo(low, high) => low <= number && number <= high,
                Self::FromToBelow(low, high) => low <= number && number < high,
                Self::OneOf(numbers) => numbers.contains(&number),
            }
    }

    /// What is asked of a number in this unit, as the end of a sentence: `must be from 0 to 250 km/h`.
    #[must_use]
    pub fn demand(self, unit: &str) -> String {
        let space = if unit.is_empty() { "" } else { " " };
        match self {
            Self::Finite => format!(
                "must be a finite number{}{unit}",
                if unit.is_empty() { "" } else { " of " }
            ),
            Self::FromTo(low, high) => format!("must be from {} to {}{space}{unit}", Number(low), Number(high)),
            Self::FromToBelow(low, high) => {
                format!("must be from {} to below {}{space}{unit}", Number(low), Number(high))
            }
            Self::OneOf(numbers) => {
                let all: Vec<String> = numbers.iter().map(|number| Number(*number).to_string()).collect();
                format!("must be {}{space}{unit}", all.join(" or "))
            }
        }
    }
}

/// A number as people write it: with an exponent where it is very large or very small.
pub(super) struct Number(pub f64);

impl fmt::Display for Number {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size.is_finite() && size != 0.0 && !(1e-4..1e7).contains(&size) {
            write!(out, "{:e}", self.0)
        } else {
            write!(out, "{}", self.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn demands_are_ends_of_sentences() {
        assert_eq!(Range::FromTo(1e-7, 10.0).demand("m3"), "must be from 1e-7 to 10 m3");
        assert_eq!(Range::FromTo(0.0, 1.0).demand(""), "must be from 0 to 1");
        assert_eq!(Range::FromToBelow(0.0, 1.0).demand(""), "must be from 0 to below 1");
        assert_eq!(Range::OneOf(&[-1.0, 1.0]).demand(""), "must be -1 or 1");
        assert_eq!(Range::Finite.demand("N"), "must be a finite number of N");
        assert_eq!(Range::Finite.demand(""), "must be a finite number");
    }

    #[test]
    fn ends_belong_to_the_range_as_it_says() {
        for range in [Range::Finite, Range::FromTo(-1.0, 2.0), Range::FromToBelow(-1.0, 2.0)] {
            assert!(range.contains(-1.0) && range.contains(1.999));
            assert!(
                ![f64::NAN, f64::INFINITY, f64::NEG_INFINITY]
                    .iter()
                    .any(|v| range.contains(*v))
            );
        }
        assert!(Range::FromTo(-1.0, 2.0).contains(2.0) && !Range::FromToBelow(-1.0, 2.0).contains(2.0));
        assert!(!Range::FromTo(-1.0, 2.0).contains(2.001) && !Range::FromTo(-1.0, 2.0).contains(-1.001));
    }
}
