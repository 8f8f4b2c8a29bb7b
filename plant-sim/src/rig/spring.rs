//! Spring characteristics by the report's slow sawtooth: static, +40 mm, -100 mm, +40 mm, static in 300 s (3.5.1).
//!
//! The report takes force from the pressure, `p1 A`, because the load cell also feels the friction of a side-loaded strut
//! (figure 18); so does this.

use oleo_interface::StrutValves;

use crate::model_file::InvalidValue;
use crate::strut::{SideLoadFriction, StrutModel};
use crate::strut_first::Spring;

use super::isothermal::{Isothermal, Oil};
use super::programme::{Programme, Record, play};

/// The slow sawtooth with which a spring is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpringTest {
    /// Largest compression, m.
    pub bump_m: f64,
    /// Greatest extension, m (positive).
    pub rebound_m: f64,
    /// Duration of the whole cycle, s.
    pub duration_s: f64,
}

impl Default for SpringTest {
    /// The report's cycle: +40 and -100 mm in 300 s.
    fn default() -> Self {
        Self {
            bump_m: 0.040,
            rebound_m: 0.100,
            duration_s: 300.0,
        }
    }
}

/// Sampling of the slow cycle, s.
const INTERVAL_S: f64 = 0.05;
/// Displacements at which both directions are compared.
const GRID: usize = 281;

/// A measured characteristic and what it is held against.
#[derive(Debug, Clone)]
pub struct SpringCharacteristic {
    /// The spring that was measured, soft or stiff.
    pub spring: Spring,
    /// Everything the instruments read.
    pub record: Record,
    /// Force from pressure, `p1 A`, N.
    pub pressure_force_n: Vec<f64>,
    /// Ideal gas, incompressible oil: the usual prediction.
    pub isothermal: Isothermal,
    /// The same with the bulk modulus of the oil.
    pub corrected: Isothermal,
    /// The same with real nitrogen besides.
    pub real: Isothermal,
    /// Displacements of the comparison, m.
    pub grid_m: Vec<f64>,
    /// Force from pressure at them while extending (from bump to rebound) and while compressing, N.
    pub extending_n: Vec<f64>,
    /// Force while the strut is compressed, N, at each grid point.
    pub compressing_n: Vec<f64>,
}

/// Bulk modulus to correct with where the model's oil has none, Pa: the report's.
pub(crate) const REPORT_BULK_MODULUS_PA: f64 = 1.5e9;

/// Runs the sawtooth on one spring, both dampers bypassed.
///
/// # Errors
/// Impossible values in the model.
pub fn test_spring(model: &StrutModel, spring: Spring, test: SpringTest) -> Result<SpringCharacteristic, InvalidValue> {
    let corners = [0.0, test.bump_m, -test.rebound_m, test.bump_m, 0.0];
    let signals = StrutValves::new(true, true, spring == Spring::Soft);
    let programme = Programme::sawtooth(&corners, test.duration_s, INTERVAL_S, signals);
    let record = play(model, &programme)?;
    let area_m2 = model.piston_area_m2();
    let pressure_force_n: Vec<f64> = record.pressure_pa[0]
        .iter()
        .map(|pressure| pressure * area_m2)
        .collect();
    let bulk_pa = model
        .effects
        .oil_compressibility
        .as_ref()
        .map_or(REPORT_BULK_MODULUS_PA, |oil| oil.bulk_modulus_pa);
    let predict = |oil, real| Isothermal::predict(model, spring, oil, real, -test.rebound_m, test.bump_m);
    let grid_m: Vec<f64> = (0..GRID)
        .map(|i| -test.rebound_m + (test.bump_m + test.rebound_m) * (i as f64 / (GRID - 1) as f64))
        .collect();
    let [first, second] = legs(&record.displacement_m);
    let on_grid = |leg: (usize, usize)| {
        grid_m
            .iter()
            .map(|&x| {
                between(
                    &record.displacement_m[leg.0..=leg.1],
                    &pressure_force_n[leg.0..=leg.1],
                    x,
                )
            })
            .collect()
    };
    let (extending_n, compressing_n) = (on_grid(first), on_grid(second));
    Ok(SpringCharacteristic {
        spring,
        isothermal: predict(Oil::Incompressible, false),
        corrected: predict(Oil::BulkModulus(bulk_pa), false),
        real: predict(Oil::BulkModulus(bulk_pa), true),
        record,
        pressure_force_n,
        grid_m,
        extending_n,
        compressing_n,
    })
}

impl SpringCharacteristic {
    /// Mean force of both directions at each grid point, N, which contains no hysteresis.
    #[must_use]
    pub fn mean_n(&self) -> Vec<f64> {
        self.extending_n
            .iter()
            .zip(&self.compressing_n)
            .map(|(a, b)| 0.5 * (a + b))
            .collect()
    }

    /// Largest difference of the two directions at one displacement, N.
    #[must_use]
    pub fn hysteresis_n(&self) -> f64 {
        self.extending_n
            .iter()
            .zip(&self.compressing_n)
            .map(|(a, b)| (b - a).abs())
            .fold(0.0, f64::max)
    }

    /// Largest difference of the two directions of the load cell, N.
    #[must_use]
    pub fn load_cell_hysteresis_n(&self) -> f64 {
        let [first, second] = legs(&self.record.displacement_m);
        let at = |leg: (usize, usize), x: f64| {
            between(
                &self.record.displacement_m[leg.0..=leg.1],
                &self.record.force_n[leg.0..=leg.1],
                x,
            )
        };
        self.grid_m
            .iter()
            .map(|&x| (at(second, x) - at(first, x)).abs())
            .fold(0.0, f64::max)
    }

    /// Largest and root-mean-square deviation of the mean characteristic from a prediction, relative to the prediction.
    #[must_use]
    pub fn deviation(&self, prediction: &Isothermal) -> (f64, f64) {
        let relative: Vec<f64> = self
            .grid_m
            .iter()
            .zip(self.mean_n())
            .map(|(&x, measured)| measured / prediction.force_n(x) - 1.0)
            .collect();
        let largest = relative
            .iter()
            .fold(0.0, |most: f64, d| if d.abs() > most.abs() { *d } else { most });
        let mean_square = relative.iter().map(|d| d * d).sum::<f64>() / relative.len() as f64;
        (largest, mean_square.sqrt())
    }
}

/// The strut in a mounting that bends it (figure 18): friction `coefficient * strut force` besides what it has.
#[must_use]
pub fn side_loaded(model: &StrutModel, coefficient: f64) -> StrutModel {
    let mut bent = model.clone();
    bent.effects.side_load_friction = Some(SideLoadFriction {
        coefficient,
        overlap_growth_1_m: 0.0,
    });
    bent
}

/// First and last sample of the leg down and of the leg up between the extremes.
fn legs(displacement_m: &[f64]) -> [(usize, usize); 2] {
    let extreme = |range: std::ops::Range<usize>, sign: f64| {
        let mut best = range.start;
        for i in range {
            if sign * displacement_m[i] > sign * displacement_m[best] {
                best = i;
            }
        }
        best
    };
    let bottom = extreme(0..displacement_m.len(), -1.0);
    let before = extreme(0..bottom, 1.0);
    let after = extreme(bottom..displacement_m.len(), 1.0);
    [(before, bottom), (bottom, after)]
}

/// Linear interpolation in a leg, which goes up or down throughout.
fn between(x: &[f64], y: &[f64], at: f64) -> f64 {
    let rising = x[x.len() - 1] > x[0];
    let right = x
        .partition_point(|&point| if rising { point < at } else { point > at })
        .clamp(1, x.len() - 1);
    let share = (at - x[right - 1]) / (x[right] - x[right - 1]);
    y[right - 1] + share * (y[right] - y[right - 1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::{Effects, OilCompressibility, OilCount};

    const QUICK: SpringTest = SpringTest {
        bump_m: 0.040,
        rebound_m: 0.100,
        duration_s: 300.0,
    };

    fn bare() -> StrutModel {
        let mut model = StrutModel::defender110(8000.0);
        model.effects = Effects::default();
        model
    }

    #[test]
    fn without_effects_the_measurement_is_boyles_law() {
        for spring in [Spring::Soft, Spring::Stiff] {
            let test = test_spring(&bare(), spring, QUICK).expect("possible");
            let (largest, _) = test.deviation(&test.isothermal);
            // What is left is the drop of the open valves at 1.2 mm/s, which the mean of both directions cancels.
            assert!(largest.abs() < 1e-3, "{spring:?}: {largest}");
        }
    }

    #[test]
    fn the_corrected_prediction_meets_a_strut_with_compressible_oil() {
        let mut model = bare();
        // The prediction counts oil at the chamber's density, as the recordings' model does.
        model.effects.oil_compressibility = Some(OilCompressibility {
            bulk_modulus_pa: 1.5e9,
            counted_at: OilCount::Chamber,
        });
        let test = test_spring(&model, Spring::Stiff, QUICK).expect("possible");
        assert!(
            test.deviation(&test.corrected).0.abs() < 2e-3,
            "{:?}",
            test.deviation(&test.corrected)
        );
        assert!(
            test.deviation(&test.isothermal).0 < -0.10,
            "the report's significant discrepancy"
        );
    }

    #[test]
    fn hysteresis_of_the_pressure_is_heat_and_of_the_load_cell_friction() {
        let preset = StrutModel::defender110(8000.0);
        let mut cold = preset.clone();
        cold.effects.gas_heat_transfer = None;
        let loop_of = |model: &StrutModel| test_spring(model, Spring::Soft, QUICK).expect("possible");
        let (with, without) = (loop_of(&preset), loop_of(&cold));
        assert!(with.hysteresis_n() > 3.0 * without.hysteresis_n());
        // 2 mu F near the end of bump, where the loop is widest; at the very end the seal has not turned yet.
        let bent = loop_of(&side_loaded(&preset, 0.1));
        let most = bent.pressure_force_n.iter().copied().fold(0.0, f64::max);
        let added = bent.load_cell_hysteresis_n() - with.load_cell_hysteresis_n();
        assert!(
            (added / (2.0 * 0.1 * most) - 0.95).abs() < 0.05,
            "{added} N of {most} N"
        );
        assert!(
            (bent.hysteresis_n() - with.hysteresis_n()).abs() < 1.0,
            "the pressure does not feel it"
        );
    }
}
