//! What the sensors say of the true values: noise, and the steps of the CAN signals.

use oleo_controller::Inputs;
use oleo_interface::{Corners, Gauge, StrutPressures};
use oleo_plant_sim::strut::StrutOutput;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Standard deviation of the displacement sensors' noise, m, and of the pressure sensors', Pa: the strut preset's `[noise]`.
const NOISE: (f64, f64) = (5.0e-6, 4.0e3);
/// Steps of the signals in `oleo.dbc`, m and Pa.
const STEP: (f64, f64) = (1.0e-5, 5.0e3);

/// The twenty sensors.
pub struct Sensors {
    random: ChaCha8Rng,
}

impl Sensors {
    /// Noise from a seed.
    pub fn new(seed: u64) -> Self {
        Self {
            random: ChaCha8Rng::seed_from_u64(seed),
        }
    }

    /// The readings of one tick, from displacements (m, compression positive) and pressures.
    pub fn read(&mut self, displacement_m: Corners<f64>, struts: Corners<StrutOutput>) -> Inputs {
        let random = &mut self.random;
        let mut reading = |value: f64, noise: f64, step: f64| {
            let disturbance: f64 = StandardNormal.sample(random);
            (((value + noise * disturbance) / step).round() * step) as f32
        };
        let displacement_m = displacement_m.map(|x| reading(x, NOISE.0, STEP.0));
        let pressure = struts
            .map(|strut| StrutPressures::from_array(strut.pressure_pa.map(|p| Gauge(reading(p, NOISE.1, STEP.1)))));
        Inputs::from_values(displacement_m, pressure)
    }
}
