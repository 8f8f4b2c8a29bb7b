//! Rounds of a method that settles: once it has, no further round is computed.

/// What a number of rounds make of a start. Rounding lets Newton's method end in one value or in two that take turns; what the rounds that are left would give is
/// known then, to the bit.
pub(super) fn settled(start: f64, rounds: usize, next: impl Fn(f64) -> f64) -> f64 {
    let (mut before, mut now) = (f64::NAN, start);
    for done in 1..=rounds {
        let after = next(now);
        if after == now {
            return now;
        }
        if after == before {
            return if (rounds - done).is_multiple_of(2) { after } else { now };
        }
        (before, now) = (now, after);
    }
    now
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    /// All rounds, one after the other.
    fn plainly(start: f64, rounds: usize, next: impl Fn(f64) -> f64) -> f64 {
        (0..rounds).fold(start, |x, _| next(x))
    }

    #[test]
    fn rounds_that_settle_give_what_all_rounds_give() {
        // Heron's root, two values that take turns, one after two others, and a sum that never settles.
        let root = |x: f64| 0.5 * (x + 2.0 / x);
        let turns = |x: f64| -x;
        let joins_late = |x: f64| if x < 2.0 { x + 1.0 } else { 5.0 - x };
        let grows = |x: f64| x + 1.0;
        for rounds in 0..40 {
            for next in [&root as &dyn Fn(f64) -> f64, &turns, &joins_late, &grows] {
                let (quick, plain) = (settled(1.0, rounds, next), plainly(1.0, rounds, next));
                assert_eq!(quick.to_bits(), plain.to_bits(), "{rounds} rounds");
            }
        }
    }

    #[test]
    fn no_round_is_computed_once_it_has_settled() {
        let computed = Cell::new(0);
        let counted = |x: f64| {
            computed.set(computed.get() + 1);
            0.5 * (x + 2.0 / x)
        };
        settled(1.0, 1000, counted);
        assert!(computed.get() < 10);
    }

    #[test]
    fn what_is_no_number_stays_none() {
        assert!(settled(1.0, 20, |_| f64::NAN).is_nan());
    }
}
