//! Readings that are not in the unit of their column's title.
//!
//! A title in another unit is refused when the file is read, and so are times and displacements that no specimen has. Compared quantities in another unit are
//! seen here, beside the believed model: no missing physics puts both their mean and their changes off by the factor between two units.

use std::ops::RangeInclusive;

use oleo_plant_sim::rig::other_units;
use rayon::prelude::*;

use crate::error::DiagnoseError;
use crate::estimation::Point;
use crate::median::median;
use crate::specimen::Specimen;

/// A channel that correlates less with what the model predicts says nothing of its unit.
const LEAST_CORRELATION: f64 = 0.7;
/// Two units that are less apart, as a factor, are not told from a model that is as wrong: a bore of half the diameter has a quarter of the force.
const LEAST_APART: f64 = 30.0;
/// How far, as a factor, both the mean and the changes of a channel may be from a unit.
const ABOUT: RangeInclusive<f64> = 0.67..=1.5;

/// Refuses a compared quantity that is as far from the believed model as two units are apart.
///
/// # Errors
/// The recording, the column, and what to do.
pub fn check(specimen: &dyn Specimen) -> Result<(), DiagnoseError> {
    let believed = Point::nominal(specimen).hypothesis(specimen);
    let in_other_unit = |at: usize| {
        // What cannot be simulated says so itself, and later.
        let truth = specimen.simulate(&believed, at).ok()?;
        (specimen.channels().iter().enumerate()).find_map(|(c, channel)| {
            let name = channel.column.as_str();
            let unit = other_unit(name, specimen.measured(at, c), &truth[c])?;
            let own = name.rsplit_once('_').map_or("", |(_, own)| own);
            Some(format!(
                "recording {}: {name} is what the given model predicts if it is in {unit}; give it in {own}, state its unit in a map, or correct the \
                 model",
                specimen.recordings()[at].name
            ))
        })
    };
    let found = (0..specimen.recordings().len())
        .into_par_iter()
        .find_map_first(in_other_unit);
    found.map_or(Ok(()), |what| Err(DiagnoseError::Model(what)))
}

/// The unit in which readings of a column are what a model predicts.
fn other_unit(column: &str, measured: &[f64], predicted: &[f64]) -> Option<&'static str> {
    let both: Vec<(f64, f64)> = (measured.iter().zip(predicted))
        .map(|(m, p)| (*m, *p))
        .filter(|(m, p)| m.is_finite() && p.is_finite())
        .collect();
    let middle = [
        median(both.iter().map(|b| b.0).collect()),
        median(both.iter().map(|b| b.1).collect()),
    ];
    let samples = both.len() as f64;
    let (mut of_measured, mut of_predicted, mut product) = (0.0, 0.0, 0.0);
    for (m, p) in both {
        let (m, p) = (m - middle[0], p - middle[1]);
        of_measured += m * m;
        of_predicted += p * p;
        product += m * p;
    }
    if product <= LEAST_CORRELATION * (of_measured * of_predicted).sqrt() {
        return None;
    }
    let fits = |factor: f64| {
        let deviation = (of_predicted / samples).sqrt();
        let same_middle = middle[1].abs() < deviation || ABOUT.contains(&(middle[0] / middle[1] / factor));
        same_middle && ABOUT.contains(&(product / of_predicted / factor))
    };
    let far = |size: f64| size.max(1.0 / size) >= LEAST_APART;
    (other_units(column).filter(|&(_, size)| far(size)))
        .find(|(_, size)| fits(1.0 / size))
        .map(|(unit, _)| unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn swinging(middle: f64, size: f64) -> Vec<f64> {
        (0..400)
            .map(|k| middle + size * libm::sin(0.1 * f64::from(k)))
            .collect()
    }

    #[test]
    fn readings_in_another_unit_are_told_by_mean_and_changes() {
        let predicted = swinging(4e6, 8e5);
        let of = |factor: f64, gain: f64| {
            let measured: Vec<f64> = predicted.iter().map(|p| factor * (4e6 + gain * (p - 4e6))).collect();
            other_unit("p1_Pa", &measured, &predicted)
        };
        for (unit, size) in other_units("p1_Pa") {
            assert_eq!(of(1.0 / size, 1.2), Some(unit));
        }
        // As it should be; a gain that is far off; changes a thousandth as large about the right mean, as of a sensor that is nearly shut off.
        assert_eq!(of(1.0, 1.0), None);
        assert_eq!(of(0.1, 1.0), None);
        assert_eq!(of(1.0, 1e-3), None);
    }

    #[test]
    fn a_sensor_that_shows_only_noise_has_no_unit() {
        let predicted = swinging(4e6, 8e5);
        let noise: Vec<f64> = (0..400)
            .map(|k| 4e3 * libm::sin(13.7 * f64::from(k * k % 97)))
            .collect();
        assert_eq!(other_unit("p1_Pa", &noise, &predicted), None);
        assert_eq!(other_unit("p1_Pa", &[f64::NAN; 400], &predicted), None);
    }

    #[test]
    fn a_force_about_zero_is_told_by_its_changes() {
        let predicted = swinging(10.0, 1800.0);
        let scaled = |factor: f64| predicted.iter().map(|n| factor * n - 0.05).collect::<Vec<f64>>();
        assert_eq!(other_unit("force_N", &scaled(1e-3), &predicted), Some("kN"));
        // Pounds are as near as a cylinder of half the diameter.
        assert_eq!(other_unit("force_N", &scaled(0.25), &predicted), None);
        assert_eq!(other_unit("current_A", &scaled(1e-3), &predicted), None);
    }
}
