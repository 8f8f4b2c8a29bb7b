//! A wheel between road and strut, as a strategy that predicts needs it: how fast it moves, and how far its tyre is compressed.
//!
//! ```text
//!   strut      x' = u,  u' = w' - a            x compression, m;  a  acceleration of the body over the strut, m/s2
//!   wheel      m w' = k d - F                  w  its speed upwards, m/s;  F  force of the strut beyond the static load, N
//!   tyre       d' = r' - w                     d  its compression beyond the static one, m;  r' speed of the road under it, m/s
//! ```
//!
//! `x`, `F` and `a` are known, so the wheel is found by an observer: the model goes on by a tick, and what it misses of the measured
//! displacement corrects it. The vertical speed of a road of ISO 8608's slope (`w = 2`) is white, so that no better forecast of it than zero is
//! possible for the front wheels; the rear ones meet later what the front ones have met.
//!
//! Source: quarter-car model; steady Kalman filter (R. E. Kalman, J. Basic Eng. 82 (1960), 35-45). Gains are those of a road speed of
//! 0.8 m/s a tick (class D at 60 km/h), forces that are wrong by 10 m/s2 of the wheel, and a displacement that is wrong by 0.1 mm;
//! a test computes them. Limits: the damping of the tyre and what a rigid axle carries over from the other wheel are left out. In
//! bounce a strut moves half the axle, 112 kg of the vehicle preset, and in roll its inertia, 170 kg at the strut; the mass here lies between.

use oleo_interface::tick::TICK_S_F32;

use crate::filter::at_least;

/// Mass that a strut moves at its wheel, kg (*assumed*; see above). Of 112, 130 and 150 kg the last two gave the better ride.
const MASS_KG: f32 = 130.0;
/// Stiffness of a tyre, N/m: preset.
const TYRE_N_M: f32 = 2.4e5;
/// Corrections of `x`, `u` and `d` for each metre of error.
const GAINS: [f32; 3] = [0.9522, 169.8, 7.795];

/// A wheel and its strut.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Wheel {
    /// Compression of the strut, m.
    pub strut_m: f32,
    /// Its rate, m/s.
    pub strut_m_s: f32,
    /// Compression of the tyre beyond the static one, m.
    pub tyre_m: f32,
}

/// What acts on a wheel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Acting {
    /// Force of the strut beyond its static load, N.
    pub strut_n: f32,
    /// Static load of the strut, N.
    pub load_n: f32,
    /// Acceleration of the body over the strut, m/s2, and its velocity, m/s.
    pub body_m_s2: f32,
    pub body_m_s: f32,
    /// Speed of the road under the wheel, m/s, up positive.
    pub road_m_s: f32,
}

impl Wheel {
    pub const INITIAL: Self = Self {
        strut_m: 0.0,
        strut_m_s: 0.0,
        tyre_m: 0.0,
    };

    /// Goes on by a time, s. A tyre can push and cannot pull.
    pub fn advance(&mut self, acting: &Acting, duration_s: f32) {
        let lifted_n = -(acting.load_n + MASS_KG * crate::estimate::GRAVITY_M_S2);
        let tyre_n = at_least(TYRE_N_M * self.tyre_m, lifted_n);
        let wheel_m_s2 = (tyre_n - acting.strut_n) * (1.0 / MASS_KG);
        self.strut_m_s += duration_s * (wheel_m_s2 - acting.body_m_s2);
        self.strut_m += duration_s * self.strut_m_s;
        self.tyre_m += duration_s * (acting.road_m_s - self.strut_m_s - acting.body_m_s);
    }

    /// One tick in which the strut's compression was measured, m; returns the speed of the road under the wheel that explains it, m/s.
    pub fn observe(&mut self, acting: &Acting, measured_m: f32) -> f32 {
        self.advance(acting, TICK_S_F32);
        let error_m = measured_m - self.strut_m;
        let [strut, rate, tyre] = GAINS;
        self.strut_m += strut * error_m;
        self.strut_m_s += rate * error_m;
        self.tyre_m += tyre * error_m;
        acting.road_m_s + tyre * error_m * (1.0 / TICK_S_F32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gains of the steady Kalman filter of the model, from the Riccati equation in f64.
    #[test]
    fn gains_are_those_of_the_riccati_equation() {
        let (t, stiffness, mass) = (f64::from(TICK_S_F32), f64::from(TYRE_N_M), f64::from(MASS_KG));
        let rate = [0.0, 1.0, t * stiffness / mass];
        let model = [
            [1.0 + t * rate[0], t * rate[1], t * rate[2]],
            rate,
            [-t * rate[0], -t * rate[1], 1.0 - t * rate[2]],
        ];
        let by_force = [t * t, t, -t * t];
        let product = |a: [[f64; 3]; 3], b: [[f64; 3]; 3]| {
            core::array::from_fn(|i| core::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum::<f64>()))
        };
        let transposed = core::array::from_fn(|i| core::array::from_fn(|j| model[j][i]));
        let (mut covariance, mut gains) = ([[0.0; 3]; 3], [0.0; 3]);
        for _ in 0..4_000 {
            covariance = product(product(model, covariance), transposed);
            for i in 0..3 {
                for j in 0..3 {
                    covariance[i][j] += by_force[i] * by_force[j] * 100.0;
                }
            }
            covariance[2][2] += (t * 0.8) * (t * 0.8);
            let first = covariance[0];
            gains = core::array::from_fn(|i| covariance[i][0] / (first[0] + 1.0e-8));
            for i in 0..3 {
                for j in 0..3 {
                    covariance[i][j] -= gains[i] * first[j];
                }
            }
        }
        for (gain, expected) in GAINS.into_iter().zip(gains) {
            assert!((f64::from(gain) / expected - 1.0).abs() < 1e-3, "{gain}, {expected}");
        }
    }

    const STILL: Acting = Acting {
        strut_n: 0.0,
        load_n: 4.0e3,
        body_m_s2: 0.0,
        body_m_s: 0.0,
        road_m_s: 0.0,
    };

    /// Without a strut's force the wheel swings on its tyre with `sqrt(k / m)`: 6.84 Hz.
    #[test]
    fn a_wheel_swings_on_its_tyre() {
        let mut wheel = Wheel {
            tyre_m: 0.01,
            ..Wheel::INITIAL
        };
        let (mut crossings, mut before) = (0, wheel.tyre_m);
        for _ in 0..20_000 {
            wheel.advance(&STILL, 0.000_5);
            crossings += u32::from(wheel.tyre_m > 0.0 && before <= 0.0);
            before = wheel.tyre_m;
        }
        let expected = 10.0 * libm::sqrtf(TYRE_N_M / MASS_KG) / (2.0 * core::f32::consts::PI);
        assert!(
            (crossings as f32 - expected).abs() <= 1.0,
            "{crossings}, expected {expected}"
        );
    }

    /// A body that is pulled up at 2 m/s2 extends its strut. The wheel stays where it is as long as the body has no speed, and is lifted off its
    /// tyre by one that has: by hand in 10 ms, at 1 m/s of both together, 10 mm.
    #[test]
    fn a_wheel_moves_with_strut_and_body() {
        let mut wheel = Wheel::INITIAL;
        let rising = Acting {
            body_m_s2: 2.0,
            ..STILL
        };
        wheel.advance(&rising, 0.01);
        assert!((wheel.strut_m_s + 0.02).abs() < 1e-6, "{wheel:?}");
        let mut wheel = Wheel::INITIAL;
        let lifted = Acting { body_m_s: 1.0, ..STILL };
        wheel.advance(&lifted, 0.01);
        assert_eq!((wheel.strut_m_s, wheel.strut_m), (0.0, 0.0));
        assert!((wheel.tyre_m + 0.01).abs() < 1e-6, "{wheel:?}");
    }

    /// A tyre off the ground pulls with nothing: what is left is the weight of the wheel and of what stands on it.
    #[test]
    fn a_lifted_wheel_falls() {
        let mut wheel = Wheel {
            tyre_m: -0.5,
            ..Wheel::INITIAL
        };
        wheel.advance(&STILL, 0.01);
        let falls_m_s2 = (STILL.load_n + MASS_KG * crate::estimate::GRAVITY_M_S2) / MASS_KG;
        assert!(
            (wheel.strut_m_s + 0.01 * falls_m_s2).abs() < 1e-4,
            "{} m/s",
            wheel.strut_m_s
        );
    }

    /// The speed of a road is found from the strut's compression alone: a wave of 3 Hz under a body that stands still and a strut without
    /// force, through a wheel that is integrated twenty times as finely.
    #[test]
    fn the_road_is_found_under_the_wheel() {
        let (mut truth, mut observed) = (Wheel::INITIAL, Wheel::INITIAL);
        let (mut error_2, mut road_2) = (0.0, 0.0);
        for tick in 0..2_000 {
            let mut strut_n = 0.0;
            let mut road_m_s = 0.0;
            for part in 0..20 {
                let time_s = TICK_S_F32 * (tick as f32 + part as f32 / 20.0);
                road_m_s = 0.4 * libm::sinf(2.0 * core::f32::consts::PI * 3.0 * time_s);
                // A strut's damper, so that the start is forgotten.
                strut_n = 1.0e3 * truth.strut_m_s;
                let acting = Acting {
                    strut_n,
                    road_m_s,
                    ..STILL
                };
                truth.advance(&acting, TICK_S_F32 / 20.0);
            }
            let found_m_s = observed.observe(&Acting { strut_n, ..STILL }, truth.strut_m);
            if tick > 1_000 {
                error_2 += (found_m_s - road_m_s) * (found_m_s - road_m_s);
                road_2 += road_m_s * road_m_s;
            }
        }
        let error = libm::sqrtf(error_2 / road_2);
        assert!(error < 0.35, "{error} of the road's RMS");
    }
}
