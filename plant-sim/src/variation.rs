//! Random vehicles for a study of robustness: what a workshop, a load, a climate and age make of one vehicle.
//!
//! A case is drawn from a seed and its own number alone (ChaCha8, one stream a case), so that case 731 is the same vehicle
//! whether it is driven alone or as one of a thousand, on any number of threads. All distributions are even within their range
//! unless said otherwise, because nothing better than the range is known.
//!
//! | what | range |
//! |---|---|
//! | mass added to or taken from the body | -30 to +30 % of the sprung mass, at 0.9 to 2.3 m behind the front axle, 0.6 to 1.4 m high |
//! | moments of inertia of the body, each | 0.85 to 1.15 |
//! | tyres: friction; cornering stiffness; vertical rate | 0.6 to 1.1; 0.8 to 1.2; 0.85 to 1.15 |
//! | gas temperature, all struts | -20 to +60 degrees Celsius |
//! | gas volume of each accumulator | 0.9 to 1.1 |
//! | friction of each seal | 0.33 to 3, even in the logarithm |
//! | response of the valves, from the signal to 95 % of the opening | 40 to 90 ms, the same for all |
//! | one weak strut | packs at 0.4 to 0.8 of their pressure drop, leaking 0 to 1e-6 m3/s/sqrt(Pa) |
//! | displacement: noise; offset | 0 to 0.5 mm; -5 to +5 mm |
//! | pressure: noise; offset | 0 to 20 kPa; -100 to +100 kPa |

use oleo_interface::{Corner, Corners};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::handling::HandlingParameters;
use crate::strut::{DamperLeakage, StrutModel};
use crate::vehicle::{Cargo, TemperedStrut, VehicleParameters, put};

/// A random vehicle: factors and offsets on a nominal one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Variation {
    /// Mass added to the body over its sprung mass, -0.3 to 0.3.
    pub mass_change: f64,
    /// Place of that mass behind the front axle, m.
    pub mass_behind_front_axle_m: f64,
    /// Height of that mass above the ground, m.
    pub mass_above_ground_m: f64,
    /// Factors on the body's moments of inertia: roll, pitch, yaw.
    pub inertia: [f64; 3],
    /// Factor on the tyres' friction.
    pub tyre_friction: f64,
    /// Factor on the tyres' cornering stiffness.
    pub cornering_stiffness: f64,
    /// Factor on the tyres' vertical rate.
    pub tyre_rate: f64,
    /// Temperature of the gas, K. The struts were charged at 293.15 K.
    pub gas_temperature_k: f64,
    /// What differs from strut to strut.
    pub strut: Corners<StrutVariation>,
    /// Time from the signal to 95 % of the valves' opening, s.
    pub valve_response_s: f64,
    /// The strut that is weak.
    pub weak: Corner,
    /// Factor on the pressure drop of its packs.
    pub weak_damping: f64,
    /// Flow coefficient of the leak beside each of its packs, m3/s/sqrt(Pa).
    pub weak_leak: f64,
    /// Errors of the sensors.
    pub sensors: SensorErrors,
}

/// A strut's own variation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrutVariation {
    /// Factors on the gas volumes of accumulators 1 and 2.
    pub gas_volume: [f64; 2],
    /// Factor on the friction of the seal.
    pub friction: f64,
}

/// Errors of the sensors of all four corners. Whoever reads the sensors adds them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorErrors {
    /// Standard deviation of the displacement's white noise, m.
    pub displacement_noise_m: f64,
    /// Offset of each displacement, m.
    pub displacement_offset_m: Corners<f64>,
    /// Standard deviation of the pressures' white noise, Pa.
    pub pressure_noise_pa: f64,
    /// Offset of the pressures of each corner, Pa.
    pub pressure_offset_pa: Corners<f64>,
}

/// Struts of a random vehicle, and how much each raises it.
#[derive(Debug, Clone, PartialEq)]
pub struct VariedVehicle {
    /// The vehicle, at the ride height that its gas gives it.
    pub vehicle: VehicleParameters,
    /// Handling parameters of the vehicle.
    pub handling: HandlingParameters,
    /// Its struts, charged for their loads.
    pub struts: Corners<StrutModel>,
    /// Displacement at rest as a sensor says that was set to zero when the struts were charged, m, compression positive.
    pub rest_displacement_m: Corners<f64>,
}

impl Variation {
    /// Draws a case.
    ///
    /// ```
    /// use oleo_plant_sim::variation::Variation;
    /// assert_eq!(Variation::draw(1, 731), Variation::draw(1, 731));
    /// assert_ne!(Variation::draw(1, 731), Variation::draw(1, 732));
    /// ```
    #[must_use]
    pub fn draw(seed: u64, case: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(case);
        let mut within = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
        let mass_change = within(-0.3, 0.3);
        let mass_behind_front_axle_m = within(0.9, 2.3);
        let mass_above_ground_m = within(0.6, 1.4);
        let inertia = core::array::from_fn(|_| within(0.85, 1.15));
        let (tyre_friction, cornering_stiffness) = (within(0.6, 1.1), within(0.8, 1.2));
        let tyre_rate = within(0.85, 1.15);
        let gas_temperature_k = within(253.15, 333.15);
        let strut = Corners::from_fn(|_| StrutVariation {
            gas_volume: core::array::from_fn(|_| within(0.9, 1.1)),
            friction: libm::exp(within(-1.1, 1.1)),
        });
        let valve_response_s = within(0.040, 0.090);
        let weak = Corner::ALL[(within(0.0, 4.0) as usize).min(3)];
        Self {
            mass_change,
            mass_behind_front_axle_m,
            mass_above_ground_m,
            inertia,
            tyre_friction,
            cornering_stiffness,
            tyre_rate,
            gas_temperature_k,
            strut,
            valve_response_s,
            weak,
            weak_damping: within(0.4, 0.8),
            weak_leak: within(0.0, 1e-6),
            sensors: SensorErrors {
                displacement_noise_m: within(0.0, 0.5e-3),
                displacement_offset_m: Corners::from_fn(|_| within(-5e-3, 5e-3)),
                pressure_noise_pa: within(0.0, 20e3),
                pressure_offset_pa: Corners::from_fn(|_| within(-100e3, 100e3)),
            },
        }
    }

    /// This variation of a nominal vehicle on four nominal struts, whatever load those are charged for.
    #[must_use]
    pub fn of(
        &self,
        nominal: &VehicleParameters,
        nominal_handling: &HandlingParameters,
        nominal_strut: &StrutModel,
    ) -> VariedVehicle {
        let mut vehicle = nominal.clone();
        let mass_kg = self.mass_change * vehicle.body.sprung_mass_kg;
        // A point mass: the inertia of its own is in the factors.
        let cargo = Cargo {
            mass_kg,
            behind_front_axle_m: self.mass_behind_front_axle_m,
            above_ground_m: self.mass_above_ground_m,
            size_m: [0.0; 3],
        };
        put(&mut vehicle, &cargo);
        let [roll, pitch, yaw] = self.inertia;
        vehicle.body.roll_inertia_kg_m2 *= roll;
        vehicle.body.pitch_inertia_kg_m2 *= pitch;
        vehicle.body.yaw_inertia_kg_m2 *= yaw;
        vehicle.front_axle.tyre_stiffness_n_m *= self.tyre_rate;
        vehicle.rear_axle.tyre_stiffness_n_m *= self.tyre_rate;
        let mut handling = nominal_handling.clone();
        handling.tyre.friction_scale *= self.tyre_friction;
        handling.tyre.pky1 *= self.cornering_stiffness;
        let load_n = vehicle.static_strut_load_n();
        let tempered = Corners::from_fn(|corner| {
            let charged = nominal_strut.clone().charged_for(load_n[corner]);
            TemperedStrut::new(&self.strut_as_charged(corner, charged), self.gas_temperature_k)
        });
        let rise_m = tempered.each_ref().map(|strut| strut.rise_m);
        let vehicle = vehicle.raised(rise_m.by_axle().map(|(left, right)| 0.5 * (left + right)));
        VariedVehicle {
            vehicle,
            handling,
            struts: tempered.map(|strut| strut.model),
            rest_displacement_m: rise_m.map(|rise_m| -rise_m),
        }
    }

    fn strut_as_charged(&self, corner: Corner, mut model: StrutModel) -> StrutModel {
        let own = self.strut[corner];
        for (accumulator, factor) in model.accumulator.iter_mut().zip(own.gas_volume) {
            accumulator.static_gas_volume_m3 *= factor;
        }
        if let Some(seal) = &mut model.effects.seal_friction {
            seal.coulomb_force_n *= own.friction;
            seal.breakaway_force_n *= own.friction;
        }
        match &mut model.effects.valve_delay {
            Some(delay) => delay.response_polynomial_s = [self.valve_response_s, 0.0, 0.0],
            None => model.valve_timing.response_polynomial_s = vec![self.valve_response_s],
        }
        if corner == self.weak {
            model.damper = model.damper.map(|pack| pack.scaled(self.weak_damping));
            let [sound_1, sound_2] = match &model.effects.damper_leakage {
                Some(leakage) => [leakage.flow_coefficient_1, leakage.flow_coefficient_2],
                None => [0.0; 2],
            };
            model.effects.damper_leakage = Some(DamperLeakage {
                flow_coefficient_1: sound_1 + self.weak_leak,
                flow_coefficient_2: sound_2 + self.weak_leak,
            });
        }
        model
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::handling::HandlingModel;
    use crate::road::Flat;
    use crate::strut::Strut;
    use crate::vehicle::StrutElement;
    use oleo_interface::StrutValves;
    use std::sync::Arc;

    fn varied(case: u64) -> VariedVehicle {
        Variation::draw(5, case).of(
            &VehicleParameters::defender110(),
            &HandlingParameters::defender110(),
            &StrutModel::defender110(1.0),
        )
    }

    /// Every case is a vehicle: its files would be read, its struts carry it, its mass is what was drawn.
    #[test]
    fn every_case_is_a_vehicle() {
        for case in 0..300 {
            let v = varied(case);
            let again = VehicleParameters::from_toml(&v.vehicle.to_toml(), "vehicle").unwrap();
            assert_eq!(again, v.vehicle, "case {case}");
            HandlingParameters::from_toml(&v.handling.to_toml(), "handling").unwrap();
            let mass_change = (v.vehicle.body.sprung_mass_kg / 1600.0 - 1.0).abs();
            assert!(mass_change <= 0.3 + 1e-12, "case {case}: {mass_change}");
            let elements = v
                .struts
                .map(|model| StrutElement::new(Strut::at_rest(&model, StrutValves::default()).unwrap()));
            HandlingModel::with_elements(&v.vehicle, &v.handling, elements, Arc::new(Flat), 10.0).unwrap();
        }
    }

    /// The draws fill their ranges evenly: mean and deviation of a thousand.
    #[test]
    fn draws_fill_their_ranges() {
        let cases: Vec<Variation> = (0..1000).map(|case| Variation::draw(9, case)).collect();
        for (of, low, high) in [
            ((|v| v.mass_change) as fn(&Variation) -> f64, -0.3, 0.3),
            (|v| v.gas_temperature_k, 253.15, 333.15),
            (|v| v.valve_response_s, 0.040, 0.090),
            (|v| v.sensors.displacement_offset_m[Corner::RearRight], -5e-3, 5e-3),
        ] {
            let values: Vec<f64> = cases.iter().map(of).collect();
            assert!(values.iter().all(|x| (low..=high).contains(x)));
            let mean = values.iter().sum::<f64>() / 1000.0;
            let variance = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 999.0;
            let width = high - low;
            // Standard errors of an even distribution: width / sqrt(12 n), and 5 % of the variance.
            assert!((mean - 0.5 * (low + high)).abs() < 4.0 * width / (12.0f64 * 1000.0).sqrt());
            assert!((variance / (width * width / 12.0) - 1.0).abs() < 0.15, "{variance}");
        }
        for corner in Corner::ALL {
            let weak = cases.iter().filter(|v| v.weak == corner).count();
            assert!((200..300).contains(&weak), "{corner:?}: {weak}");
        }
    }
}
