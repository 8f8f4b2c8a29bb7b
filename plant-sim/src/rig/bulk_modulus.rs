//! Figure 21: the strut full of oil, both accumulators against their end stops, compressed slowly. What gives way is the
//! oil, so force over displacement gives its bulk modulus.
//!
//! Closed form: `dp = beta A dx / (V_oil - A x)`, thus `p - p0 = beta ln(V_oil / (V_oil - A x))`, nearly a straight line of
//! slope `beta A^2 / V_oil` in force.

use oleo_interface::StrutValves;

use crate::model_file::InvalidValue;
use crate::strut::{OilCompressibility, OilCount, StrutModel};

use super::programme::{Programme, Record, play};
use super::spring::REPORT_BULK_MODULUS_PA;

/// Gas left behind a floating piston at its stop, m3: one part in a thousand of what the oil gives way, and enough for the
/// strut's solver, which stands on the gas.
const NO_GAS_M3: f64 = 1e-8;
/// Pressure the oil is filled at, Pa gauge.
const FILLING_PA: f64 = 0.5e6;
/// Part of the pressure range that the bulk modulus is taken from: above, air is dissolved.
const FIT_FROM: f64 = 0.5;

/// Oil-only compression and the bulk modulus found from it.
#[derive(Debug, Clone)]
pub struct OilCompression {
    /// Everything the instruments read.
    pub record: Record,
    /// Force from pressure less that at filling, N.
    pub force_n: Vec<f64>,
    /// The closed form at each sample with the model's bulk modulus, N.
    pub closed_form_n: Vec<f64>,
    /// The straight line `beta A^2 / V_oil x`, N: what the report drew.
    pub straight_n: Vec<f64>,
    /// Bulk modulus of the model, Pa.
    pub bulk_modulus_pa: f64,
    /// Bulk modulus found by least squares of pressure over `ln(V_oil / (V_oil - A x))`, upper half of the range, Pa.
    pub found_pa: f64,
    /// Largest deviation from the closed form, relative to the largest force.
    pub deviation: f64,
}

/// Compresses the oil from filling pressure to `highest_pa` (gauge) and back, at the speed of the slow sawtooth.
///
/// # Errors
/// Impossible values in the model.
pub fn compress_oil(model: &StrutModel, highest_pa: f64) -> Result<OilCompression, InvalidValue> {
    let mut solid = model.clone();
    solid
        .accumulator
        .iter_mut()
        .for_each(|accumulator| accumulator.static_gas_volume_m3 = NO_GAS_M3);
    solid.cylinder.static_pressure_pa = FILLING_PA;
    // The gas is not there: its heat, its departure from the ideal and its pistons' friction neither. The bump stops are
    // farther than the oil gives way.
    let effects = &mut solid.effects;
    (effects.gas_heat_transfer, effects.real_gas, effects.gas_charge_error) = (None, None, None);
    effects.accumulator_piston_friction = None;
    let bulk_modulus_pa = effects
        .oil_compressibility
        .get_or_insert(OilCompressibility {
            bulk_modulus_pa: REPORT_BULK_MODULUS_PA,
            counted_at: OilCount::default(),
        })
        .bulk_modulus_pa;
    let (area, oil) = (solid.piston_area_m2(), solid.cylinder.oil_volume_m3);
    // All valves closed: the packs keep what gas there is out of the oil's reckoning.
    let stroke_m = oil / area * (1.0 - libm::exp(-(highest_pa - FILLING_PA) / bulk_modulus_pa));
    let programme = Programme::sawtooth(
        &[0.0, stroke_m, 0.0],
        2.0 * stroke_m / 1.2e-3,
        0.01,
        StrutValves::default(),
    );
    let record = play(&solid, &programme)?;

    let strain = |x: f64| libm::log(oil / (oil - area * x));
    let force_n: Vec<f64> = record.pressure_pa[0]
        .iter()
        .map(|pressure| (pressure - FILLING_PA) * area)
        .collect();
    let closed_form_n: Vec<f64> = record
        .displacement_m
        .iter()
        .map(|&x| bulk_modulus_pa * strain(x) * area)
        .collect();
    let straight_n = record
        .displacement_m
        .iter()
        .map(|&x| bulk_modulus_pa * area * area / oil * x)
        .collect();
    let largest = closed_form_n.iter().copied().fold(0.0, f64::max);
    let deviation = force_n
        .iter()
        .zip(&closed_form_n)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
        / largest;
    let upper: Vec<(f64, f64)> = record
        .displacement_m
        .iter()
        .zip(&force_n)
        .filter(|(_, force)| **force > FIT_FROM * largest)
        .map(|(&x, &force)| (strain(x), force / area))
        .collect();
    Ok(OilCompression {
        found_pa: slope(&upper),
        record,
        force_n,
        closed_form_n,
        straight_n,
        bulk_modulus_pa,
        deviation,
    })
}

/// Least-squares slope through `(x, y)`, about their means.
fn slope(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let (sum_x, sum_y) = points
        .iter()
        .fold((0.0, 0.0), |sum, point| (sum.0 + point.0, sum.1 + point.1));
    let (mean_x, mean_y) = (sum_x / count, sum_y / count);
    let (xy, xx) = points.iter().fold((0.0, 0.0), |sum, point| {
        let dx = point.0 - mean_x;
        (sum.0 + dx * (point.1 - mean_y), sum.1 + dx * dx)
    });
    xy / xx
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::EntrainedAir;

    #[test]
    fn the_simulated_oil_is_the_closed_form() {
        let mut model = StrutModel::defender110(8000.0);
        model.effects.entrained_air = None;
        let test = compress_oil(&model, 20e6).expect("possible");
        assert!(test.deviation < 2e-3, "{}", test.deviation);
        assert!((test.found_pa / 1.5e9 - 1.0).abs() < 1e-3, "{} Pa", test.found_pa);
        // 1.5 GPa, 0.9 l, 19.5 MPa: 5.92 mm.
        let stroke = test.record.displacement_m.iter().copied().fold(0.0, f64::max);
        assert!((stroke - 5.92e-3).abs() < 2e-5, "{stroke} m");
    }

    #[test]
    fn air_softens_the_beginning_and_hardly_the_end() {
        let mut model = StrutModel::defender110(8000.0);
        model.effects.entrained_air = Some(EntrainedAir {
            volume_fraction: 0.005,
            polytropic_exponent: 1.0,
        });
        let test = compress_oil(&model, 20e6).expect("possible");
        assert!(test.deviation > 0.01);
        assert!((test.found_pa / 1.5e9 - 1.0).abs() < 0.02, "{} Pa", test.found_pa);
    }
}
