//! The predicted isothermal spring characteristic that the report draws beside its measurements, for an ideal or a real
//! gas, with the oil taken as incompressible or corrected with its bulk modulus.
//!
//! At rest the piston's volume is what the gas and the oil give way, `A dx = -dV_gas + (V_oil - A x) dp / beta`: with an
//! incompressible oil Boyle's law in closed form, else an ordinary differential equation in pressure, integrated with the classical
//! Runge-Kutta method in steps of 0.2 % of the pressure.

use oleo_interface::Absolute;

use crate::strut::{Gas, Nitrogen, StrutModel};
use crate::strut_first::Spring;

/// Whether the oil gives way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Oil {
    /// Not at all: the usual assumption.
    Incompressible,
    /// With this bulk modulus, Pa.
    BulkModulus(f64),
}

/// Force over displacement of a spring at ambient temperature.
#[derive(Debug, Clone, PartialEq)]
pub struct Isothermal {
    displacement_m: Vec<f64>,
    force_n: Vec<f64>,
}

/// Ratio of neighbouring pressures.
const STEP: f64 = 1.002;

impl Isothermal {
    /// Predicts from `from_m` (rebound, below 0) to `to_m` (above 0). `real_gas`: the reference equation of nitrogen instead of
    /// Boyle's law.
    #[must_use]
    pub fn predict(model: &StrutModel, spring: Spring, oil: Oil, real_gas: bool, from_m: f64, to_m: f64) -> Self {
        let at_rest = model.static_pressure().absolute();
        let area_m2 = model.piston_area_m2();
        let volume_m3 = model.accumulator[0].static_gas_volume_m3
            + if spring == Spring::Soft {
                model.accumulator[1].static_gas_volume_m3
            } else {
                0.0
            };
        let real = real_gas.then(Nitrogen::reference);
        let gas = Gas::charged(at_rest, volume_m3, model.gas.temperature_k, None, real);
        let oil_m3 = model.cylinder.oil_volume_m3;
        let per_bulk = match oil {
            Oil::Incompressible => 0.0,
            Oil::BulkModulus(bulk_pa) => 1.0 / bulk_pa,
        };
        // Volume the piston has displaced at an absolute pressure: by the gas in closed form, by the oil integrated.
        let by_gas = |pressure: f64| volume_m3 - gas.volume_at(Absolute(pressure));
        let force_n = |pressure: f64| Absolute(pressure).gauge().pa() * area_m2;
        let by_oil_rate = |pressure: f64, by_oil: f64| (oil_m3 - by_gas(pressure) - by_oil) * per_bulk;
        let walk = |ratio: f64, end_m: f64| {
            let (mut pressure, mut by_oil) = (at_rest.pa(), 0.0);
            let mut points = Vec::new();
            // Ends by displacement; the bound on pressure is for displacements no pressure reaches.
            while pressure > 1e3 && pressure < 1e9 {
                let next = pressure * ratio;
                let (step, middle) = (next - pressure, 0.5 * (pressure + next));
                let k1 = by_oil_rate(pressure, by_oil);
                let k2 = by_oil_rate(middle, by_oil + 0.5 * step * k1);
                let k3 = by_oil_rate(middle, by_oil + 0.5 * step * k2);
                let k4 = by_oil_rate(next, by_oil + step * k3);
                by_oil += step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
                pressure = next;
                let x = (by_gas(pressure) + by_oil) / area_m2;
                points.push((x, force_n(pressure)));
                if (x - end_m) * (ratio - 1.0) > 0.0 {
                    break;
                }
            }
            points
        };
        let mut points = walk(1.0 / STEP, from_m);
        points.reverse();
        points.push((0.0, force_n(at_rest.pa())));
        points.extend(walk(STEP, to_m));
        let (displacement_m, force_n) = points.into_iter().unzip();
        Self {
            displacement_m,
            force_n,
        }
    }

    /// Force at a displacement, N; linear between the computed points and beyond their ends.
    #[must_use]
    pub fn force_n(&self, displacement_m: f64) -> f64 {
        let (x, force) = (&self.displacement_m, &self.force_n);
        let right = x.partition_point(|&point| point < displacement_m).clamp(1, x.len() - 1);
        let share = (displacement_m - x[right - 1]) / (x[right] - x[right - 1]);
        force[right - 1] + share * (force[right] - force[right - 1])
    }

    /// Displacement at which a force is reached, m.
    #[must_use]
    pub fn displacement_m(&self, force_n: f64) -> f64 {
        let (x, force) = (&self.displacement_m, &self.force_n);
        let right = force.partition_point(|&point| point < force_n).clamp(1, x.len() - 1);
        let share = (force_n - force[right - 1]) / (force[right] - force[right - 1]);
        x[right - 1] + share * (x[right] - x[right - 1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut_first::isothermal_force_n;

    #[test]
    fn incompressible_and_ideal_is_boyles_law() {
        let model = StrutModel::defender110(8000.0);
        let (static_pa, area) = (model.cylinder.static_pressure_pa, model.piston_area_m2());
        for (spring, volume) in [(Spring::Soft, 5e-4), (Spring::Stiff, 1e-4)] {
            let curve = Isothermal::predict(&model, spring, Oil::Incompressible, false, -0.1, 0.04);
            for i in -100..=40 {
                let x = 1e-3 * f64::from(i);
                let boyle = isothermal_force_n(static_pa, volume, area, x);
                assert!((curve.force_n(x) / boyle - 1.0).abs() < 1e-5, "{spring:?} {x}");
            }
        }
    }

    #[test]
    fn oil_and_gas_are_springs_in_series() {
        // Rates at static: the gas's p A^2 / V, the oil's beta A^2 / V.
        let model = StrutModel::defender110(8000.0);
        let area = model.piston_area_m2();
        let gas = model.static_pressure().absolute().pa() * area * area / 1e-4;
        let oil = 1.5e9 * area * area / model.cylinder.oil_volume_m3;
        let curve = Isothermal::predict(&model, Spring::Stiff, Oil::BulkModulus(1.5e9), false, -0.01, 0.01);
        let rate = (curve.force_n(1e-3) - curve.force_n(-1e-3)) / 2e-3;
        assert!((rate / (gas * oil / (gas + oil)) - 1.0).abs() < 2e-3, "{rate} N/m");
    }

    #[test]
    fn displacement_is_the_inverse_of_force() {
        let model = StrutModel::defender110(8000.0);
        let curve = Isothermal::predict(&model, Spring::Soft, Oil::BulkModulus(1.5e9), true, -0.1, 0.1);
        assert!((curve.displacement_m(curve.force_n(0.037)) - 0.037).abs() < 1e-9);
    }
}
