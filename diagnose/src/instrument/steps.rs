//! The step of a converter, from the differences between readings.

use crate::recording::Recording;

/// Readings whose values are looked at; more would tell no more.
const MOST_READINGS: usize = 20_000;
/// Distances between values that are a whole number of steps, of all distances.
const MOSTLY: f64 = 0.98;
/// How far a distance may be from a whole number of steps, in steps: what writing a file with few digits makes of it.
const NEARLY_WHOLE: f64 = 0.06;
/// Fewest values that a step is told from.
const FEWEST_VALUES: usize = 12;
/// Values must repeat: this many readings for each value at least.
const READINGS_PER_VALUE: f64 = 1.3;
/// Distances between values that are the same but for rounding, as a part of the largest value.
const ROUNDING: f64 = 1e-9;

/// Step between the values of a column; `None` where its values have none that can be seen.
pub fn step(recordings: &[Recording], column: usize) -> Option<f64> {
    let all = recordings.iter().flat_map(|r| &r.columns[column]).copied();
    let mut values: Vec<f64> = all.filter(|v| v.is_finite()).take(MOST_READINGS).collect();
    let readings = values.len() as f64;
    values.sort_by(f64::total_cmp);
    let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    values.dedup_by(|a, b| (*a - *b).abs() <= ROUNDING * largest);
    if values.len() < FEWEST_VALUES || readings < READINGS_PER_VALUE * values.len() as f64 {
        return None;
    }
    let distances: Vec<f64> = values.windows(2).map(|w| w[1] - w[0]).collect();
    let smallest = distances.iter().copied().fold(f64::INFINITY, f64::min);
    let whole = |d: &&f64| ((**d / smallest) - (**d / smallest).round()).abs() < NEARLY_WHOLE;
    let many = distances.iter().filter(whole).count() as f64;
    (many >= MOSTLY * distances.len() as f64).then_some(smallest)
}

/// So many equal readings in a row come about by chance, or by what moves fast.
const EQUAL_BY_CHANCE: usize = 3;

/// What equal readings in a row leave unknown beside their noise, as a standard deviation a sample. Their rounding, of this deviation, is one and the same
/// error: together they tell as much as one reading does.
pub fn unknown_of_still(series: &[f64], rounding: f64) -> Vec<f64> {
    let runs = series.chunk_by(|a, b| a.to_bits() == b.to_bits());
    runs.flat_map(|run| {
        let further = if run.len() > EQUAL_BY_CHANCE { run.len() - 1 } else { 0 };
        std::iter::repeat_n((further as f64).sqrt() * rounding, run.len())
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instrument::noise::tests::{noise, recording};

    #[test]
    fn the_step_is_found_and_readings_without_one_have_none() {
        let smooth: Vec<f64> = noise(1, 3000, 0.0).iter().map(|v| 4e6 + 4e3 * v).collect();
        let stepped: Vec<f64> = smooth.iter().map(|v| 6103.5 * (v / 6103.5).round()).collect();
        assert_eq!(step(&[recording(0.002, vec![smooth])], 0), None);
        // Two values a noise of two thirds of a step makes too few values, so the readings also move.
        let moving: Vec<f64> = (stepped.iter().enumerate())
            .map(|(k, v)| v + 6103.5 * (20.0 * libm::sin(0.01 * k as f64)).round())
            .collect();
        let found = step(&[recording(0.002, vec![moving])], 0).expect("a step");
        assert!((found - 6103.5).abs() < 1.0, "{found}");
    }

    #[test]
    fn readings_that_stand_still_tell_as_much_as_one() {
        let still = [2.0, 1.0, 1.0, 1.0, 1.0, 1.0, 3.0, 3.0];
        let unknown = unknown_of_still(&still, 0.5);
        assert_eq!(unknown, [0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0]);
        // Mean of five readings, each with its rounding and with what is unknown beside it.
        let of_mean = (0.25 + unknown[1] * unknown[1]) / 5.0;
        assert_eq!(of_mean, 0.25);
    }
}
