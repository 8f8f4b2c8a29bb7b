//! What the sensors say of the true values: noise, offsets, and the steps of the CAN signals.

use oleo_controller::Inputs;
use oleo_interface::{Corners, Gauge, StrutPressures};
use oleo_plant_sim::strut::StrutOutput;
use oleo_plant_sim::variation::SensorErrors;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::bench::Bench;

/// Steps of the signals in `oleo.dbc`, m and Pa.
const STEP: (f64, f64) = (1.0e-5, 5.0e3);

/// The twenty sensors.
pub struct Sensors {
    random: ChaCha8Rng,
    errors: SensorErrors,
    rest_displacement_m: Corners<f64>,
}

impl Sensors {
    /// A bench's sensors, with noise from a seed.
    pub fn new(bench: &Bench, seed: u64) -> Self {
        Self {
            random: ChaCha8Rng::seed_from_u64(seed),
            errors: bench.sensors,
            rest_displacement_m: bench.rest_displacement_m,
        }
    }

    /// The readings of one tick, from displacements (m, compression positive) and pressures.
    pub fn read(&mut self, displacement_m: Corners<f64>, struts: Corners<StrutOutput>) -> Inputs {
        let (random, errors) = (&mut self.random, &self.errors);
        let mut reading = |value: f64, noise: f64, step: f64| {
            let disturbance: f64 = StandardNormal.sample(random);
            (((value + noise * disturbance) / step).round() * step) as f32
        };
        let zero_m = self.rest_displacement_m.zip(errors.displacement_offset_m);
        let displacement_m = displacement_m
            .zip(zero_m)
            .map(|(x, (rest, offset))| reading(x + rest + offset, errors.displacement_noise_m, STEP.0));
        let pressure = struts.zip(errors.pressure_offset_pa).map(|(strut, offset)| {
            let pressure = |p| Gauge(reading(p + offset, errors.pressure_noise_pa, STEP.1));
            StrutPressures::from_array(strut.pressure_pa.map(pressure))
        });
        Inputs::from_values(displacement_m, pressure)
    }
}
