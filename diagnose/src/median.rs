//! The median of a few numbers.

/// The middle one of numbers in order, the upper of two; 0 where there is none.
#[must_use]
pub fn median(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::median;

    #[test]
    fn half_of_the_numbers_are_on_either_side() {
        assert_eq!(median(vec![9.0, 1.0, 5.0]), 5.0);
        assert_eq!(median(vec![4.0, 3.0, 1.0, 2.0]), 3.0);
        assert_eq!(median(vec![]), 0.0);
    }
}
