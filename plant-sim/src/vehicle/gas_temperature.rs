//! A vehicle whose gas is warmer or colder than when its struts were charged.
//!
//! The mass of each charge stays, and the load, so that the pressure at rest stays too. At that pressure the gas takes another
//! volume, `V = m / rho(p, T)` (of an ideal gas `V0 T / T0`), and the oil that it pushes out or lets in raises or lowers the
//! vehicle by `sum (V - V0) / A`. About its new rest the strut is one with other gas volumes (a rate that falls as `1 / V`), with
//! its stops as much nearer or further away. The oil's own expansion (about 0.7e-3 a kelvin) is left out: its temperature is not
//! the gas's.

use oleo_interface::{Axle, Axles};

use super::parameters::{SeatParameters, VehicleParameters};
use crate::strut::StrutModel;

/// A strut with its gas at another temperature.
#[derive(Debug, Clone, PartialEq)]
pub struct TemperedStrut {
    /// The strut about its new rest: displacement 0 is where it carries the load that it was charged for.
    pub model: StrutModel,
    /// How much longer it is at rest than when it was charged, m; negative where it is shorter.
    pub rise_m: f64,
}

impl TemperedStrut {
    /// The strut `charged` at `[gas] temperature_K`, with its gas at `temperature_k`. Both accumulators are connected while the
    /// temperature changes.
    ///
    /// ```
    /// use oleo_plant_sim::strut::StrutModel;
    /// use oleo_plant_sim::vehicle::TemperedStrut;
    /// let cold = TemperedStrut::new(&StrutModel::defender110(4000.0), 253.15);
    /// assert!(cold.rise_m < -0.03, "0.5 l of gas at -20 degrees Celsius");
    /// ```
    pub fn new(charged: &StrutModel, temperature_k: f64) -> Self {
        let mut model = charged.clone();
        let ratio = density(charged, charged.gas.temperature_k) / density(charged, temperature_k);
        let error =
            |of: fn(&crate::strut::GasChargeError) -> f64| charged.effects.gas_charge_error.as_ref().map_or(0.0, of);
        let errors = [error(|e| e.relative_error_1), error(|e| e.relative_error_2)];
        let mut grown_m3 = 0.0;
        for (accumulator, error) in model.accumulator.iter_mut().zip(errors) {
            grown_m3 += accumulator.static_gas_volume_m3 * (1.0 + error) * (ratio - 1.0);
            accumulator.static_gas_volume_m3 *= ratio;
        }
        let rise_m = grown_m3 / charged.piston_area_m2();
        model.gas.temperature_k = temperature_k;
        // What left the accumulators is in the cylinder now.
        model.cylinder.oil_volume_m3 += grown_m3;
        if let Some(stops) = &mut model.effects.bump_stop {
            stops.bump_clearance_m += rise_m;
            stops.rebound_clearance_m -= rise_m;
        }
        Self { model, rise_m }
    }
}

/// Density of the gas at the static pressure and a temperature, kg/m3, but for a constant factor of the ideal gas.
fn density(model: &StrutModel, temperature_k: f64) -> f64 {
    let pressure = model.static_pressure().absolute();
    match &model.effects.real_gas {
        Some(real) => real.nitrogen().density(pressure, temperature_k),
        None => pressure.pa() / temperature_k,
    }
}

impl VehicleParameters {
    /// The vehicle with its body raised at each axle, m: the centre of mass and the seats are higher. The pitch of some
    /// thousandths that unlike rises make is left out.
    #[must_use]
    pub fn raised(&self, rise_m: Axles<f64>) -> Self {
        let mut raised = self.clone();
        let wheelbase_m = self.layout.wheelbase_m;
        let at =
            |behind_m: f64| rise_m[Axle::Front] + (rise_m[Axle::Rear] - rise_m[Axle::Front]) * behind_m / wheelbase_m;
        let body_share = self.body.sprung_mass_kg / self.total_mass_kg();
        raised.body.vehicle_cg_height_m += at(self.body_cg_behind_front_axle_m()) * body_share;
        let raise = |seat: &mut SeatParameters| seat.above_ground_m += at(seat.behind_front_axle_m);
        raise(&mut raised.driver_seat);
        raise(&mut raised.passenger_seat);
        raised
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::{ATMOSPHERE_PA, Strut};
    use oleo_interface::StrutValves;

    /// The preset without what is not gas: no oil that gives way, no friction, no stops.
    fn gas_alone(load_n: f64) -> StrutModel {
        let mut model = StrutModel::defender110(load_n);
        model.effects.oil_compressibility = None;
        model.effects.entrained_air = None;
        model.effects.seal_friction = None;
        model.effects.bump_stop = None;
        model
    }

    /// Pushed back to where it was charged, the gas has its old volume again: Gay-Lussac's law, `p / p0 = T / T0`.
    #[test]
    fn at_the_old_volume_the_pressure_goes_with_the_temperature() {
        let mut charged = gas_alone(5000.0);
        charged.effects.real_gas = None;
        for temperature_k in [253.15, 293.15, 333.15] {
            let tempered = TemperedStrut::new(&charged, temperature_k);
            let strut = Strut::at_rest_at(&tempered.model, StrutValves::splat(true), tempered.rise_m).unwrap();
            let [p1, ..] = strut.output().pressure_pa;
            let ratio = (p1 + ATMOSPHERE_PA) / charged.static_pressure().absolute().pa();
            assert!(
                (ratio / (temperature_k / 293.15) - 1.0).abs() < 1e-6,
                "{temperature_k} K: {ratio}"
            );
        }
    }

    /// About the new rest the soft rate is that of the gas law, `p A^2 / V` (isothermal), so it falls with the temperature.
    #[test]
    fn the_rate_at_rest_falls_with_the_temperature() {
        let mut charged = gas_alone(5000.0);
        charged.effects.real_gas = None;
        let area_m2 = charged.piston_area_m2();
        for temperature_k in [253.15, 333.15] {
            let tempered = TemperedStrut::new(&charged, temperature_k);
            let force = |x: f64| {
                let strut = Strut::at_rest_at(&tempered.model, StrutValves::splat(true), x).unwrap();
                strut.output().force_n
            };
            let rate = (force(1e-4) - force(-1e-4)) / 2e-4;
            let volume_m3 = 5e-4 * temperature_k / 293.15;
            let expected = charged.static_pressure().absolute().pa() * area_m2 * area_m2 / volume_m3;
            assert!(
                (rate / expected - 1.0).abs() < 1e-4,
                "{temperature_k} K: {rate} {expected}"
            );
            assert!((tempered.rise_m - 5e-4 * (temperature_k / 293.15 - 1.0) / area_m2).abs() < 1e-9);
        }
    }

    /// Real nitrogen at 2.6 MPa expands more than an ideal gas does: its second virial coefficient goes from -15.5 cm3/mol at 253 K
    /// through -5.5 at 293 K to +1.5 at 333 K (recalled), which makes 9 % and 6 % of the rise.
    #[test]
    fn the_presets_real_gas_is_near_the_ideal_one() {
        let charged = StrutModel::defender110(5000.0);
        for (temperature_k, more) in [(253.15, 1.09), (333.15, 1.06)] {
            let rise_m = TemperedStrut::new(&charged, temperature_k).rise_m;
            let ideal_m = 5e-4 * (temperature_k / 293.15 - 1.0) / charged.piston_area_m2();
            assert!((rise_m / ideal_m - more).abs() < 0.02, "{rise_m} {ideal_m}");
        }
        assert_eq!(TemperedStrut::new(&charged, 293.15).rise_m, 0.0);
    }
}
