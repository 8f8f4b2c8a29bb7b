//! Which of two simulations with the believed models a recording follows, where both lack physics that matters more than their difference.
//!
//! Sums of squares would decide by chance then. The share of the difference between both that a recording contains is 0 if it follows
//! the first one and 1 if it follows the second, and what both lack moves it by as much as it resembles the difference.

/// A share above this decides for the second simulation.
pub const HALF: f64 = 0.5;

/// Share of the difference between two simulations that a part of a recording contains, and how much it weighs: up to 1, less where the difference is smaller
/// than what neither simulation explains.
#[derive(Debug, Clone, Copy)]
pub struct Share {
    value: f64,
    weight: f64,
}

impl Share {
    /// From the residuals of both, or what was made of them; `None` where they do not differ.
    pub fn of(residuals: impl IntoIterator<Item = [f64; 2]>) -> Option<Self> {
        let (mut product, mut square, mut recorded) = (0.0, 0.0, 0.0);
        for [first, second] in residuals {
            let difference = first - second;
            product += first * difference;
            square += difference * difference;
            recorded += first * first;
        }
        (square > 0.0).then(|| {
            let neither = recorded - product * product / square;
            Self {
                value: product / square,
                weight: square.sqrt() / (square.sqrt() + neither.max(0.0).sqrt()),
            }
        })
    }
}

/// The median of all shares, in which each counts by its weight; `None` without any.
pub fn median(mut shares: Vec<Share>) -> Option<f64> {
    shares.sort_by(|a, b| a.value.total_cmp(&b.value));
    let half = 0.5 * shares.iter().map(|share| share.weight).sum::<f64>();
    let mut below = 0.0;
    (shares.iter())
        .find(|share| {
            below += share.weight;
            below >= half
        })
        .map(|share| share.value)
}

/// The changes of both residuals from sample to sample, where both samples were recorded: what changes slowly does not count.
pub fn changes<'r>(first: &'r [f64], second: &'r [f64]) -> impl Iterator<Item = [f64; 2]> + 'r {
    (first.windows(2).zip(second.windows(2)))
        .filter(|(first, _)| first[0] != 0.0 && first[1] != 0.0)
        .map(|(first, second)| [first[1] - first[0], second[1] - second[0]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_is_that_of_the_difference() {
        // What was recorded is three tenths of the way from the first simulation to the second.
        let difference = [2.0, -1.0, 0.5];
        let share = Share::of(difference.map(|d| [0.3 * d, -0.7 * d])).expect("they differ");
        assert!((share.value - 0.3).abs() < 1e-12 && (share.weight - 1.0).abs() < 1e-6);
        assert!(Share::of([[1.0, 1.0], [2.0, 2.0]]).is_none());
    }

    #[test]
    fn a_difference_below_what_neither_explains_weighs_little() {
        let both_lack = |amount: f64| {
            let residuals = [[0.6, -1.4], [-0.3, 0.7]];
            let lacking = [amount, 2.0 * amount];
            let share = Share::of(std::array::from_fn::<_, 2, _>(|k| residuals[k].map(|r| r + lacking[k])));
            share.map(|share| (share.value, share.weight)).expect("they differ")
        };
        // It resembles nothing of the difference, and is as large as it and nine times as large.
        for (amount, weight) in [(1.0, 0.5), (9.0, 0.1)] {
            let (value, weighs) = both_lack(amount);
            assert!(
                (value - 0.3).abs() < 1e-12 && (weighs - weight).abs() < 1e-12,
                "{value} {weighs}"
            );
        }
    }

    #[test]
    fn what_changes_slowly_does_not_count() {
        // A step that comes at sample 3 in the recording and in one simulation, at 4 in the other; both lack a ramp.
        let ramp = |k: usize| 40.0 + 0.3 * k as f64;
        let right: Vec<f64> = (0..12).map(ramp).collect();
        let mut wrong = right.clone();
        wrong[3] += 20.0;
        let second = Share::of(changes(&wrong, &right)).expect("they differ");
        assert!((second.value - 1.0).abs() < 0.02, "{}", second.value);
        let first = Share::of(changes(&right, &wrong)).expect("they differ");
        assert!(first.value.abs() < 0.02, "{}", first.value);
        assert!(Share::of(changes(&right, &right)).is_none());
    }

    #[test]
    fn few_gross_shares_do_not_decide() {
        let share = |value, weight| Share { value, weight };
        let mut shares: Vec<Share> = (0..20).map(|k| share(0.02 * f64::from(k), 1.0)).collect();
        shares.extend([share(30.0, 4.0), share(9.0, 2.0)]);
        assert!(median(shares).is_some_and(|m| m > 0.0 && m < 0.4));
        assert_eq!(median(vec![]), None);
    }
}
