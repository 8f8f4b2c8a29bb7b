//! Heat between the gas and the wall of its accumulator: the gas is neither isothermal nor adiabatic.
//!
//! `m c_v dT/dt = -T (dp/dT)_V dV/dt - m c_v (T - T_ambient) / tau` (Els & Grobbelaar, "Investigation of the time- and
//! temperature dependency of hydropneumatic suspension systems", SAE 930265, 1993; Otis & Pourmovahed, J. Dyn. Sys. Meas.
//! Control 107, 1985, for the time constant). Without this term the gas stays at ambient temperature.

use super::equation::Equation;
use serde::{Deserialize, Serialize};

use crate::lanes::Number;
use crate::model_file::{Checked, Limit, Range};
use crate::strut::flow_path::FlowPath;

/// The gas exchanges heat with the wall.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GasHeatTransfer {
    /// Thermal time constant of accumulator 1, s; usually 0.5 to 20.
    pub time_constant_1_s: f64,
    /// Thermal time constant of accumulator 2, s; usually 0.5 to 20.
    pub time_constant_2_s: f64,
}

const TIME_CONSTANT_S: Range = Range::FromTo(1e-6, 1e9);

impl Checked for GasHeatTransfer {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("time_constant_1_s", TIME_CONSTANT_S, "s", |t| t.time_constant_1_s),
        Limit::one("time_constant_2_s", TIME_CONSTANT_S, "s", |t| t.time_constant_2_s),
    ];
}

impl GasHeatTransfer {
    /// Thermal time constant of the accumulator at the end of a path, s.
    #[must_use]
    pub fn time_constant_s(&self, path: FlowPath) -> f64 {
        path.pick(self.time_constant_1_s, self.time_constant_2_s)
    }
}

/// Energy of the gas.
pub const EQUATION: Equation = Equation {
    text: "m c_v dT/dt = -T (dp/dT)_V dV/dt - m c_v (T - T_ambient) / tau",
    source: "Els & Grobbelaar, SAE 930265, 1993; Otis & Pourmovahed, J. Dyn. Sys. Meas. Control 107, 1985",
};

/// One implicit step of the energy equation: everything but the wall.
pub(in crate::strut) struct EnergyStep<N> {
    /// Length of the step, s.
    pub duration_s: N,
    /// Flow of oil into the accumulator, m3/s.
    pub flow_m3_s: N,
    /// `(dp/dT)_V` of the gas, Pa/K.
    pub heating_pa_k: N,
    /// `1 / (m c_v)`, K/J.
    pub inverse_heat_capacity_k_j: N,
    /// Gas volume at the beginning of the step, m3.
    pub volume_before_m3: N,
    /// One over the gas volume at the end of the step, 1/m3.
    pub inverse_volume_1_m3: N,
    /// Gas temperature at the beginning of the step, K.
    pub temperature_before_k: N,
    /// Ambient temperature, K.
    pub ambient_k: N,
}

impl<N: Number> EnergyStep<N> {
    /// Temperature at the end of the step, K, and its derivative by the flow, K s/m3. `cooling_rate_1_s` is `1 / tau`.
    ///
    /// The implicit equation is linear in the new temperature, so this is its closed form. Its divisor is kept above 0.05:
    /// below, one step would heat the gas twentyfold, which only a hopeless trial of the solver asks for.
    #[inline(always)]
    pub fn temperature(&self, cooling_rate_1_s: N) -> (N, N) {
        let k = self.duration_s * self.heating_pa_k * self.inverse_heat_capacity_k_j;
        let s = self.duration_s * cooling_rate_1_s;
        let divisor = s + 1.0 - k * self.flow_m3_s;
        let least = divisor.of(0.05);
        let inverse = divisor.at_least(least).recip();
        let t = (self.temperature_before_k + s * self.ambient_k) * inverse;
        let by_flow = t * k * self.volume_before_m3 * self.inverse_volume_1_m3 * inverse;
        // Where the divisor is kept, the flow heats no further: with another slope Newton's method would not come back from such a trial.
        (t, N::choose(divisor.above(least), by_flow, divisor.of(0.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A gram of nitrogen in 0.1 l.
    fn step(flow_m3_s: f64, duration_s: f64, temperature_before_k: f64) -> EnergyStep<f64> {
        let (mass, volume) = (1e-3, 1e-4);
        EnergyStep {
            duration_s,
            flow_m3_s,
            heating_pa_k: mass * 296.8 / volume,
            inverse_heat_capacity_k_j: 1.0 / (mass * 743.0),
            volume_before_m3: volume,
            inverse_volume_1_m3: 1.0 / volume,
            temperature_before_k,
            ambient_k: 293.15,
        }
    }

    #[test]
    fn a_gas_at_rest_relaxes_to_ambient_with_the_time_constant() {
        let mut t = 350.0;
        for _ in 0..30_000 {
            t = step(0.0, 1e-4, t).temperature(1.0 / 3.0).0;
        }
        let left = (t - 293.15) / (350.0 - 293.15);
        assert!((left - libm::exp(-1.0)).abs() < 1e-4, "{left}");
    }

    #[test]
    fn without_a_wall_a_small_compression_heats_by_poissons_law() {
        // dT/T = (kappa - 1) dV/V with kappa - 1 = R / c_v.
        let (t, slope) = step(1e-4, 1e-4, 293.15).temperature(0.0);
        let exact = 293.15 * 296.8 / 743.0 * 1e-8 / 1e-4;
        assert!(((t - 293.15) / exact - 1.0).abs() < 1e-3);
        assert!((slope / (exact / 1e-4) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_trial_that_would_heat_the_gas_without_end_has_the_slope_of_what_is_kept() {
        let temperature = |flow_m3_s: f64| step(flow_m3_s, 1e-2, 293.15).temperature(1.0);
        let (hopeless, slope) = temperature(0.1);
        assert_eq!((hopeless, slope), (temperature(0.2).0, 0.0));
    }
}
