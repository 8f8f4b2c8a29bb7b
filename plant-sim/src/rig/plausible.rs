//! Times and displacements that no recording has: numbers in another unit below a right title.

/// No strut, damper or cylinder moves so far, m.
const LONGEST_STROKE_M: f64 = 3.0;
/// Parts of a displacement that are left out at either end: a spike of an instrument is no stroke.
const LEFT_OUT: f64 = 0.05;
/// From this mean interval on, s, ...
const SLOWEST_S: f64 = 0.5;
/// ... a recording of this length, s, is taken for one of times in milliseconds, which then has the usual rates.
const LONGEST_S: f64 = 3600.0;

/// What is wrong with the times or the displacements of a recording, and what to do; `None` if both are plausible. Simulated with them, a model would
/// answer with numbers that look like any others, or diverge.
///
/// ```
/// use oleo_plant_sim::rig::implausible;
/// let time_s: Vec<f64> = (0..1000).map(|k| 0.002 * f64::from(k)).collect();
/// let stroke_mm: Vec<f64> = time_s.iter().map(|t| 100.0 * t).collect();
/// assert!(implausible(&time_s, Some(&stroke_mm)).is_some_and(|what| what.contains("displacement_m")));
/// assert_eq!(implausible(&time_s, None), None);
/// ```
#[must_use]
pub fn implausible(time_s: &[f64], displacement_m: Option<&[f64]>) -> Option<String> {
    let lasts_s = time_s.last()? - time_s.first()?;
    let interval_s = lasts_s / (time_s.len() as f64 - 1.0).max(1.0);
    if interval_s >= SLOWEST_S && lasts_s >= LONGEST_S {
        return Some(format!(
            "time_s goes on by {interval_s:.3} from sample to sample and by {lasts_s:.0} in all, as it does in milliseconds; give it in s, or cut \
             the recording to less than an hour if it was sampled so slowly"
        ));
    }
    let stroke_m = displacement_m.map_or(0.0, stroke);
    (stroke_m > LONGEST_STROKE_M).then(|| {
        format!("displacement_m goes over {stroke_m:.3}, farther than any specimen moves in m, as it does in mm; give it in m, or state its unit in a map")
    })
}

/// Range of a displacement without its spikes.
fn stroke(displacement_m: &[f64]) -> f64 {
    let mut sorted: Vec<f64> = displacement_m.iter().copied().filter(|x| x.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let out = (LEFT_OUT * sorted.len() as f64) as usize;
    match (sorted.get(out), sorted.iter().rev().nth(out)) {
        (Some(low), Some(high)) => high - low,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn swinging(size: f64) -> Vec<f64> {
        (0..400).map(|k| size * libm::sin(0.1 * f64::from(k))).collect()
    }

    #[test]
    fn millimetres_and_milliseconds_are_seen_and_slow_or_long_recordings_are_not() {
        let of = |interval_s: f64, samples: u32, displacement_m: &[f64]| {
            let time_s: Vec<f64> = (0..samples).map(|k| interval_s * f64::from(k)).collect();
            implausible(&time_s, Some(displacement_m))
        };
        let usual = swinging(0.05);
        assert_eq!(of(0.002, 10_000, &usual), None);
        assert_eq!(of(1.0, 2000, &usual), None);
        assert_eq!(of(0.05, 200_000, &usual), None);
        assert_eq!(of(0.0, 0, &[]), None);
        assert!(of(2.0, 10_000, &usual).is_some_and(|what| what.contains("milliseconds")));
        assert!(of(0.002, 400, &swinging(50.0)).is_some_and(|what| what.contains("in mm")));
        let mut with_a_spike = usual;
        with_a_spike[7] = 327.68;
        assert_eq!(of(0.002, 400, &with_a_spike), None);
    }
}
