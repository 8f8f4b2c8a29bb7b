//! The suspension of the design study: a gas spring defined by its static volume, and the damper as sold times a factor.
//!
//! Report 3.2: "The coil springs on the baseline suspension were replaced with hydro-pneumatic springs where the spring
//! stiffness is determined by the gas volume in the static position ... the baseline damper force was scaled with a constant
//! factor". With piston area A, static absolute pressure p0 and static volume V0 the gas gives, compression x positive,
//!
//! ```text
//! F = A (p0 (V0 / (V0 - A x))^n - p_atm)          k(0) = n A^2 p0 / V0
//! ```
//!
//! n = 1.4 (nitrogen, adiabatic: the accumulators' time constants of 1.5 to 6 s are long against the body's motions). Below a
//! sixth of the static volume the gas line goes on straight along its tangent: defined for every displacement. Stops
//! are those of the vehicle as sold.

use oleo_interface::Corners;

use crate::strut::ATMOSPHERE_PA;
use crate::vehicle::BaselineParameters;
use crate::vehicle::suspension::{Motion, SuspensionElement};

/// Share of the static gas volume below which the tangent takes over.
const LEAST_VOLUME: f64 = 1.0 / 6.0;

/// Gas spring, scaled damper and stops of one corner.
#[derive(Debug, Clone, Copy)]
pub struct GasElement {
    baseline: BaselineParameters,
    damper_factor: f64,
    area_m2: f64,
    static_pa: f64,
    volume_m3: f64,
    exponent: f64,
    force_n: f64,
}

impl GasElement {
    /// At rest under `static_load_n`.
    pub fn new(
        baseline: &BaselineParameters,
        static_load_n: f64,
        area_m2: f64,
        volume_m3: f64,
        exponent: f64,
        damper_factor: f64,
    ) -> Self {
        Self {
            baseline: *baseline,
            damper_factor,
            area_m2,
            static_pa: static_load_n / area_m2 + ATMOSPHERE_PA,
            volume_m3,
            exponent,
            force_n: static_load_n,
        }
    }

    /// Force of the gas at a compression, N.
    pub fn gas_force_n(&self, compression_m: f64) -> f64 {
        let share = 1.0 - self.area_m2 * compression_m / self.volume_m3;
        let pressure = if share >= LEAST_VOLUME {
            self.static_pa * libm::pow(share, -self.exponent)
        } else {
            let end = self.static_pa * libm::pow(LEAST_VOLUME, -self.exponent);
            end * (1.0 + self.exponent * (LEAST_VOLUME - share) / LEAST_VOLUME)
        };
        self.area_m2 * (pressure - ATMOSPHERE_PA)
    }
}

impl SuspensionElement for GasElement {
    type Signal = ();
    type Four = Corners<Self>;

    fn advance(&mut self, motion: Motion, (): ()) -> f64 {
        let p = &self.baseline;
        let (x, v) = (motion.compression_m, motion.compression_rate_m_s);
        let damping = if v > 0.0 {
            p.bump_damping_n_s_m
        } else {
            p.rebound_damping_n_s_m
        };
        let stops = (x - p.bump_clearance_m).max(0.0) - (-x - p.rebound_clearance_m).max(0.0);
        self.force_n = self.gas_force_n(x) + self.damper_factor * damping * v + p.stop_stiffness_n_m * stops;
        self.force_n
    }

    fn force_n(&self) -> f64 {
        self.force_n
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicle::VehicleParameters;

    fn element(volume_m3: f64) -> GasElement {
        let baseline = VehicleParameters::defender110().front_baseline;
        GasElement::new(&baseline, 3923.0, 1.9635e-3, volume_m3, 1.4, 1.0)
    }

    #[test]
    fn force_and_rate_at_rest_are_the_closed_forms() {
        // n p A2 / V: 22.7 kN/m at 0.5 l.
        let stiffness = |volume| 1.4 * (3923.0 / 1.9635e-3 + ATMOSPHERE_PA) * 1.9635e-3 * 1.9635e-3 / volume;
        assert!((stiffness(5e-4) - 22_660.0_f64).abs() < 20.0, "{}", stiffness(5e-4));
        for volume in [1e-5, 1e-4, 5e-4, 3e-3] {
            let e = element(volume);
            assert!((e.gas_force_n(0.0) - 3923.0).abs() < 1e-9);
            let d = 1e-6;
            let rate = (e.gas_force_n(d) - e.gas_force_n(-d)) / (2.0 * d);
            assert!((rate / stiffness(volume) - 1.0).abs() < 1e-3);
        }
    }

    #[test]
    fn defined_smooth_and_rising_everywhere() {
        let e = element(1e-5);
        let mut last = e.gas_force_n(-0.3);
        for i in 1..6000 {
            let x = -0.3 + 1e-4 * f64::from(i);
            let force = e.gas_force_n(x);
            assert!(force.is_finite() && force > last, "{x}");
            last = force;
        }
        let end = (1.0 - LEAST_VOLUME) * 1e-5 / 1.9635e-3;
        let (below, above) = (e.gas_force_n(end - 1e-9), e.gas_force_n(end + 1e-9));
        assert!((above / below - 1.0).abs() < 1e-5);
    }
}
