//! The unit itself: what it would read without error in its own axes, and the two frames that it sends.

use oleo_controller::can::Protector;
use oleo_plant_sim::vehicle::InertialReading;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use super::contract::MESSAGES;
use super::message::{RATE_STEP_RAD_S, SPECIFIC_FORCE_STEP_M_S2, encode_axes};
use super::settings::ImuSettings;
use crate::Frame;
use crate::frame::standard;

/// Random stream of the unit's noise. Those of disturbed frames are counted from 0, those of sensor faults from 2^32.
const STREAM: u64 = 1 << 33;

/// An inertial unit that is switched on.
#[derive(Clone, Debug)]
pub struct Unit {
    settings: ImuSettings,
    random: ChaCha8Rng,
    protectors: [Protector; 2],
}

impl Unit {
    /// A unit that has sent nothing; `seed` fixes its noise.
    pub fn new(settings: &ImuSettings, seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(STREAM);
        Self {
            settings: settings.clone(),
            random,
            protectors: MESSAGES.map(|contract| Protector::new(&contract)),
        }
    }

    /// What it would read without noise, in its own axes, where the body at its place does this.
    pub fn without_noise(&self, body: &InertialReading) -> InertialReading {
        InertialReading {
            specific_force_m_s2: self.in_own_axes(body.specific_force_m_s2),
            rate_rad_s: self.in_own_axes(body.rate_rad_s),
        }
    }

    fn in_own_axes(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let angle = |degrees: f64| libm::sincos(degrees.to_radians());
        let (sin, cos) = angle(self.settings.yaw_deg);
        let (x, y) = (cos * x + sin * y, cos * y - sin * x);
        let (sin, cos) = angle(self.settings.pitch_deg);
        let (x, z) = (cos * x - sin * z, cos * z + sin * x);
        let (sin, cos) = angle(self.settings.roll_deg);
        [x, cos * y + sin * z, cos * z - sin * y]
    }

    /// The frames of a tick in which it reads this without noise, in its own axes.
    pub fn frames(&mut self, without_noise: &InertialReading) -> [Frame; 2] {
        let parts = [
            (
                without_noise.specific_force_m_s2,
                self.settings.specific_force_noise_m_s2,
                SPECIFIC_FORCE_STEP_M_S2,
            ),
            (
                without_noise.rate_rad_s,
                self.settings.rate_noise_rad_s,
                RATE_STEP_RAD_S,
            ),
        ];
        std::array::from_fn(|message| {
            let (values, noise, step) = parts[message];
            let read = values.map(|value| {
                let standard: f64 = StandardNormal.sample(&mut self.random);
                value + noise * standard
            });
            let mut data = encode_axes(read, step);
            self.protectors[message].protect(&mut data);
            Frame::whole(standard(MESSAGES[message].id), data)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::message::decode_axes;
    use super::*;

    const LEVEL: InertialReading = InertialReading {
        specific_force_m_s2: [0.0, 0.0, 9.81],
        rate_rad_s: [0.1, 0.2, 0.3],
    };

    fn turned(roll_deg: f64, pitch_deg: f64, yaw_deg: f64) -> [f64; 3] {
        let settings = ImuSettings {
            roll_deg,
            pitch_deg,
            yaw_deg,
            ..ImuSettings::default()
        };
        Unit::new(&settings, 1).without_noise(&LEVEL).specific_force_m_s2
    }

    /// Turned as the body would be turned: nose down, x reads minus the share of gravity; left side up, y reads plus it.
    #[test]
    fn a_unit_that_is_askew_reads_gravity_on_its_other_axes() {
        let near = |found: [f64; 3], expected: [f64; 3]| found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12);
        let (half, rest) = (0.5 * 9.81, 0.75f64.sqrt() * 9.81);
        assert!(near(turned(30.0, 0.0, 0.0), [0.0, half, rest]));
        assert!(near(turned(0.0, 30.0, 0.0), [-half, 0.0, rest]));
        assert!(near(turned(0.0, 0.0, 30.0), [0.0, 0.0, 9.81]));
        assert_eq!(turned(0.0, 0.0, 0.0), LEVEL.specific_force_m_s2);
        let left = ImuSettings {
            yaw_deg: 90.0,
            ..ImuSettings::default()
        };
        let rates = Unit::new(&left, 1).without_noise(&LEVEL).rate_rad_s;
        assert!(near(rates, [0.2, -0.1, 0.3]), "{rates:?}");
    }

    #[test]
    fn noise_has_its_standard_deviation_and_the_seed_fixes_it() {
        let settings = ImuSettings::default();
        let said = |seed: u64| -> Vec<[f32; 6]> {
            let mut unit = Unit::new(&settings, seed);
            let mut say = || {
                let [force, rate] = unit
                    .frames(&LEVEL)
                    .map(|frame| frame.data().try_into().expect("eight bytes"));
                let force = decode_axes(&force, SPECIFIC_FORCE_STEP_M_S2);
                let rate = decode_axes(&rate, RATE_STEP_RAD_S);
                std::array::from_fn(|k| if k < 3 { force[k] } else { rate[k - 3] }.value().expect("in range"))
            };
            (0..20_000).map(|_| say()).collect()
        };
        let (one, other) = (said(1), said(2));
        assert!(one == said(1) && one != other);
        let expected = LEVEL
            .specific_force_m_s2
            .into_iter()
            .chain(LEVEL.rate_rad_s)
            .enumerate();
        for (axis, true_value) in expected {
            let deviation = if axis < 3 { 0.017 } else { 0.0024 };
            let errors = one.iter().map(|read| f64::from(read[axis]) - true_value);
            let rms = (errors.clone().map(|e| e * e).sum::<f64>() / 20_000.0).sqrt();
            let mean = errors.sum::<f64>() / 20_000.0;
            assert!(
                (rms / deviation - 1.0).abs() < 0.02 && mean.abs() < 0.03 * deviation,
                "{axis} {rms} {mean}"
            );
        }
    }
}
