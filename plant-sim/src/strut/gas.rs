//! The gas of an accumulator: equation of state and energy equation, advanced implicitly with the flow.
//!
//! `dV/dt = -Q` with `p V = m R T` or the real gas's equation of state ([`Nitrogen`]). The temperature follows from the
//! energy equation with a thermal time constant (the term `gas_heat_transfer`); without one the gas stays at ambient
//! temperature.

use serde::{Deserialize, Serialize};

use oleo_interface::Absolute;

use super::nitrogen::Nitrogen;
use super::terms::EnergyStep;

/// Specific gas constant of nitrogen, J/kg/K (recordings README).
pub const NITROGEN_R_J_KG_K: f64 = 296.8;
/// Isochoric specific heat of nitrogen, J/kg/K (recordings README).
pub const NITROGEN_CV_J_KG_K: f64 = 743.0;

/// Volume and temperature of a gas charge.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GasState {
    /// Volume of the gas, m3.
    pub volume_m3: f64,
    /// Temperature of the gas, K.
    pub temperature_k: f64,
}

/// A gas charge: what does not change while the strut works.
///
/// ```
/// use oleo_interface::Absolute;
/// use oleo_plant_sim::strut::{Gas, GasState};
/// // 0.1 l of ideal nitrogen at 4 MPa and 20 degrees Celsius, without a thermal time constant: Boyle's law.
/// let gas = Gas::charged(Absolute(4.0e6), 1.0e-4, 293.15, None, None);
/// assert!((gas.volume_at(Absolute(8.0e6)) - 0.5e-4).abs() < 1e-18);
/// let half = GasState { volume_m3: 0.5e-4, temperature_k: 293.15 };
/// assert!((gas.pressure(half).pa() - 8.0e6).abs() < 1e-6);
/// ```
#[derive(Debug, Clone)]
pub struct Gas {
    mass_kg: f64,
    ambient_k: f64,
    /// Inverse of the thermal time constant, 1/s; none: isothermal.
    cooling_rate_1_s: Option<f64>,
    real: Option<Nitrogen>,
    gas_constant: f64,
    inverse_heat_capacity: f64,
    /// The volume below which a state makes no sense; the gas law is continued by its tangent there.
    least_volume_m3: f64,
}

impl Gas {
    /// The charge that has a volume (m3) at a pressure and the ambient temperature (K). Without a thermal time constant
    /// (s) it stays at that temperature; without an equation of state of the real gas it is ideal.
    #[must_use]
    pub fn charged(
        pressure: Absolute<f64>,
        volume_m3: f64,
        ambient_k: f64,
        time_constant_s: Option<f64>,
        real: Option<Nitrogen>,
    ) -> Self {
        let density = match &real {
            None => pressure.pa() / (NITROGEN_R_J_KG_K * ambient_k),
            Some(gas) => gas.density(pressure, ambient_k),
        };
        let mass_kg = density * volume_m3;
        Self {
            mass_kg,
            ambient_k,
            cooling_rate_1_s: time_constant_s.map(|tau| 1.0 / tau),
            gas_constant: real.as_ref().map_or(NITROGEN_R_J_KG_K, Nitrogen::gas_constant),
            inverse_heat_capacity: 1.0 / (mass_kg * NITROGEN_CV_J_KG_K),
            real,
            least_volume_m3: 0.02 * volume_m3,
        }
    }

    /// Mass of the charge, kg.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.mass_kg
    }

    /// Volume at a pressure and ambient temperature, m3.
    #[must_use]
    pub fn volume_at(&self, pressure: Absolute<f64>) -> f64 {
        let density = match &self.real {
            None => pressure.pa() / (NITROGEN_R_J_KG_K * self.ambient_k),
            Some(gas) => gas.density(pressure, self.ambient_k),
        };
        self.mass_kg / density
    }

    /// Pressure of a state.
    #[must_use]
    pub fn pressure(&self, state: GasState) -> Absolute<f64> {
        match &self.real {
            None => Absolute(self.mass_kg * NITROGEN_R_J_KG_K * state.temperature_k / state.volume_m3),
            Some(gas) => gas.state(self.mass_kg / state.volume_m3, state.temperature_k).pressure,
        }
    }

    /// Make `real` fit for a step of `duration_s` (s) from `base` with about `flow` (m3/s). It is looked up anew where the
    /// gas has moved by two per cent or four kelvin since the last time: within that, the real gas's curvature is below 1e-5
    /// of the pressure.
    #[inline(always)]
    pub fn refresh(&self, real: &mut Departure, base: GasState, duration_s: f64, flow: f64) {
        if self.real.is_some() {
            let free = base.volume_m3 - duration_s * flow;
            let volume = if free > self.least_volume_m3 {
                free
            } else {
                self.least_volume_m3
            };
            let density = self.mass_kg / volume;
            if (density - real.density).abs() > 2e-2 * density || (base.temperature_k - real.temperature_k).abs() > 4.0
            {
                *real = self.departure(density, base.temperature_k);
            }
        }
    }

    /// What the real gas adds to the ideal law around a density and a temperature.
    #[must_use]
    pub fn departure(&self, density: f64, temperature_k: f64) -> Departure {
        let Some(gas) = &self.real else {
            return Departure::default();
        };
        let (excess, by_density, by_temperature) = gas.excess(density, temperature_k);
        Departure {
            density,
            temperature_k,
            excess,
            by_density,
            by_temperature,
        }
    }

    /// One implicit step of `duration_s` with a flow of oil into the accumulator, `flow` (m3/s), from `base`.
    #[inline(always)]
    #[must_use]
    pub fn implicit(&self, base: GasState, duration_s: f64, flow: f64, real: &Departure) -> GasStep {
        let free = base.volume_m3 - duration_s * flow;
        // Below the least volume the pressure goes on rising linearly, so that a hopeless trial (more oil than the
        // accumulator holds) still has a solution instead of a division by zero. Comparisons, not `f64::max`, which costs four times
        // as much for its care of NaN.
        let volume_m3 = if free > self.least_volume_m3 {
            free
        } else {
            self.least_volume_m3
        };
        let excess_volume = volume_m3 - free;
        let inverse_volume = 1.0 / volume_m3;
        let density = self.mass_kg * inverse_volume;
        // (dp/dT) at constant volume, Pa/K.
        let heating = density * (self.gas_constant + density * real.by_temperature);
        let (temperature_k, temperature_by_flow) = match self.cooling_rate_1_s {
            None => (self.ambient_k, 0.0),
            Some(rate) => {
                let step = EnergyStep {
                    duration_s,
                    flow_m3_s: flow,
                    heating_pa_k: heating,
                    inverse_heat_capacity_k_j: self.inverse_heat_capacity,
                    volume_before_m3: base.volume_m3,
                    inverse_volume_1_m3: inverse_volume,
                    temperature_before_k: base.temperature_k,
                    ambient_k: self.ambient_k,
                };
                step.temperature(rate)
            }
        };
        let f = real.excess
            + real.by_density * (density - real.density)
            + real.by_temperature * (temperature_k - real.temperature_k);
        let rt = self.gas_constant * temperature_k;
        let p = density * (rt + density * f);
        let stiffening = rt + density * (2.0 * f + density * real.by_density);
        GasStep {
            state: GasState {
                volume_m3,
                temperature_k,
            },
            pressure: Absolute(p * (1.0 + excess_volume * inverse_volume)),
            pressure_by_flow: heating * temperature_by_flow + stiffening * density * duration_s * inverse_volume,
            temperature_by_flow,
        }
    }
}

/// Result of an implicit step.
#[derive(Debug, Clone, Copy)]
pub struct GasStep {
    /// State at its end.
    pub state: GasState,
    /// Pressure at its end.
    pub pressure: Absolute<f64>,
    /// Its derivative by the flow, Pa s/m3.
    pub pressure_by_flow: f64,
    /// Derivative of the temperature by the flow, K s/m3.
    pub temperature_by_flow: f64,
}

/// `p = rho R T + rho^2 f`, `f` linear around a state: exact for the ideal gas (`f = 0`), and for the real one to the square
/// of the change within a step, which the next step does not inherit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Departure {
    density: f64,
    temperature_k: f64,
    excess: f64,
    by_density: f64,
    by_temperature: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compression in many small implicit steps; the pressure at the end.
    fn compress(gas: &Gas, from: f64, to: f64, total_s: f64, steps: usize) -> f64 {
        let mut s = GasState {
            volume_m3: from,
            temperature_k: 293.15,
        };
        let h = total_s / steps as f64;
        let mut p = 0.0;
        for _ in 0..steps {
            let flow = (from - to) / total_s;
            let real = gas.departure(gas.mass_kg() / s.volume_m3, s.temperature_k);
            let step = gas.implicit(s, h, flow, &real);
            (s, p) = (step.state, step.pressure.pa());
        }
        p
    }

    #[test]
    fn isothermal_limit_is_boyle() {
        let gas = Gas::charged(Absolute(4e6), 1e-4, 293.15, None, None);
        assert!((compress(&gas, 1e-4, 5e-5, 1.0, 10) / 8e6 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn adiabatic_limit_is_poisson() {
        let gas = Gas::charged(Absolute(4e6), 1e-4, 293.15, Some(1e9), None);
        let kappa = 1.0 + NITROGEN_R_J_KG_K / NITROGEN_CV_J_KG_K;
        let exact = 4e6 * libm::pow(2.0, kappa);
        assert!((compress(&gas, 1e-4, 5e-5, 1.0, 40_000) / exact - 1.0).abs() < 1e-4);
    }

    #[test]
    fn relaxes_with_the_time_constant() {
        let gas = Gas::charged(Absolute(4e6), 1e-4, 293.15, Some(3.0), None);
        let mut s = GasState {
            volume_m3: 1e-4,
            temperature_k: 350.0,
        };
        for _ in 0..30_000 {
            s = gas.implicit(s, 1e-4, 0.0, &Departure::default()).state;
        }
        let left = (s.temperature_k - 293.15) / (350.0 - 293.15);
        assert!((left - libm::exp(-1.0)).abs() < 1e-4);
    }

    #[test]
    fn derivative_by_flow_is_the_difference_quotient() {
        for real in [None, Some(Nitrogen::reference())] {
            for tau in [None, Some(2.0)] {
                let gas = Gas::charged(Absolute(4e6), 1e-4, 293.15, tau, real.clone());
                let base = GasState {
                    volume_m3: 0.8e-4,
                    temperature_k: if tau.is_some() { 300.0 } else { 293.15 },
                };
                let at = |q: f64| gas.implicit(base, 1e-3, q, &gas.departure(gas.mass_kg() / base.volume_m3, 300.0));
                let slope = at(1e-3).pressure_by_flow;
                let quotient = (at(1.001e-3).pressure - at(0.999e-3).pressure) / 2e-6;
                assert!((slope / quotient - 1.0).abs() < 0.02, "{slope} {quotient}");
            }
        }
    }
}
