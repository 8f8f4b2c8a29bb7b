//! The gas of an accumulator: state equation and energy equation, advanced implicitly with the flow.
//!
//! `dV/dt = -Q`; `p V = m R T` or the real gas's equation of state;
//! `m c_v dT/dt = -T (dp/dT)_V dV/dt - m c_v (T - T_ambient) / tau`
//! (Els & Grobbelaar, "Investigation of the time- and temperature dependency of hydropneumatic suspension systems",
//! SAE 930265, 1993; Otis & Pourmovahed, J. Dyn. Sys. Meas. Control 107, 1985, for the time constant). Without the
//! thermal time constant the gas stays at ambient temperature.

use super::nitrogen::Nitrogen;

/// Specific gas constant of nitrogen, J/kg/K (recordings README).
pub const NITROGEN_R_J_KG_K: f64 = 296.8;
/// Isochoric specific heat of nitrogen, J/kg/K (recordings README).
pub const NITROGEN_CV_J_KG_K: f64 = 743.0;

/// Volume and temperature of a gas charge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GasState {
    /// Gas volume, m3.
    pub volume_m3: f64,
    /// Gas temperature, K.
    pub temperature_k: f64,
}

/// A gas charge: what does not change while the strut works.
#[derive(Debug, Clone)]
pub struct Gas {
    mass_kg: f64,
    ambient_k: f64,
    /// Thermal time constant, s; none: isothermal.
    time_constant_s: Option<f64>,
    real: Option<Nitrogen>,
    /// The volume below which a state makes no sense; the gas law is continued by its tangent there.
    least_volume_m3: f64,
}

impl Gas {
    /// The charge that has `volume_m3` at absolute pressure `pressure_pa` and temperature `ambient_k`.
    #[must_use]
    pub fn charged(
        pressure_pa: f64,
        volume_m3: f64,
        ambient_k: f64,
        time_constant_s: Option<f64>,
        real: Option<Nitrogen>,
    ) -> Self {
        let density = match &real {
            None => pressure_pa / (NITROGEN_R_J_KG_K * ambient_k),
            Some(gas) => gas.density(pressure_pa, ambient_k),
        };
        Self {
            mass_kg: density * volume_m3,
            ambient_k,
            time_constant_s,
            real,
            least_volume_m3: 0.02 * volume_m3,
        }
    }

    /// Mass of the charge, kg.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.mass_kg
    }

    /// Volume in equilibrium with ambient temperature at an absolute pressure, m3.
    #[must_use]
    pub fn volume_at(&self, pressure_pa: f64) -> f64 {
        let density = match &self.real {
            None => pressure_pa / (NITROGEN_R_J_KG_K * self.ambient_k),
            Some(gas) => gas.density(pressure_pa, self.ambient_k),
        };
        self.mass_kg / density
    }

    /// Absolute pressure of a state, Pa.
    #[must_use]
    pub fn pressure_pa(&self, state: GasState) -> f64 {
        match &self.real {
            None => self.mass_kg * NITROGEN_R_J_KG_K * state.temperature_k / state.volume_m3,
            Some(gas) => {
                gas.state(self.mass_kg / state.volume_m3, state.temperature_k)
                    .pressure_pa
            }
        }
    }

    /// One implicit step: the state after `duration_s` with flow `flow` (m3/s, into the accumulator) from `base`, its
    /// absolute pressure, and the derivative of that pressure by the flow.
    ///
    /// The energy equation is linear in the new temperature, so it is solved in closed form. `guess_k` is the
    /// temperature at which the real gas's `(dp/dT)_V` is taken (it hardly depends on it).
    #[inline]
    #[must_use]
    pub fn implicit(&self, base: GasState, duration_s: f64, flow: f64, guess_k: f64) -> (GasState, f64, f64) {
        let free = base.volume_m3 - duration_s * flow;
        let volume_m3 = free.max(self.least_volume_m3);
        // Beyond the least volume the pressure goes on rising with the tangent of the ideal law, so that a hopeless
        // state (everything squeezed out) still has a solution instead of a division by zero.
        let excess = volume_m3 - free;
        let inverse_volume = 1.0 / volume_m3;
        match &self.real {
            None => {
                let (temperature_k, dt_dq) = match self.time_constant_s {
                    None => (self.ambient_k, 0.0),
                    Some(tau) => {
                        let k = duration_s * (NITROGEN_R_J_KG_K / NITROGEN_CV_J_KG_K) * inverse_volume;
                        let s = duration_s / tau;
                        let inverse = 1.0 / (1.0 + s - k * flow).max(0.05);
                        let t = (base.temperature_k + s * self.ambient_k) * inverse;
                        (t, t * k * base.volume_m3 * inverse_volume * inverse)
                    }
                };
                let mr = self.mass_kg * NITROGEN_R_J_KG_K * inverse_volume;
                let p = mr * temperature_k;
                let dp = mr * dt_dq + p * duration_s * inverse_volume;
                (
                    GasState {
                        volume_m3,
                        temperature_k,
                    },
                    p * (1.0 + excess * inverse_volume),
                    dp,
                )
            }
            Some(gas) => {
                let density = self.mass_kg * inverse_volume;
                let temperature_k = match self.time_constant_s {
                    None => self.ambient_k,
                    Some(tau) => {
                        let beta = gas.state(density, guess_k).dp_dt_pa_k;
                        let k = duration_s * beta / (self.mass_kg * NITROGEN_CV_J_KG_K);
                        let s = duration_s / tau;
                        (base.temperature_k + s * self.ambient_k) / (1.0 + s - k * flow).max(0.05)
                    }
                };
                let at = gas.state(density, temperature_k);
                let isothermal = at.dp_drho_pa_m3_kg * density * duration_s * inverse_volume;
                let thermal = match self.time_constant_s {
                    None => 0.0,
                    Some(_) => {
                        at.dp_dt_pa_k * at.dp_dt_pa_k * temperature_k * duration_s / (self.mass_kg * NITROGEN_CV_J_KG_K)
                    }
                };
                (
                    GasState {
                        volume_m3,
                        temperature_k,
                    },
                    at.pressure_pa * (1.0 + excess * inverse_volume),
                    isothermal + thermal,
                )
            }
        }
    }
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
            (s, p, _) = gas.implicit(s, h, (from - to) / total_s, s.temperature_k);
        }
        p
    }

    #[test]
    fn isothermal_limit_is_boyle() {
        let gas = Gas::charged(4e6, 1e-4, 293.15, None, None);
        assert!((compress(&gas, 1e-4, 5e-5, 1.0, 10) / 8e6 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn adiabatic_limit_is_poisson() {
        let gas = Gas::charged(4e6, 1e-4, 293.15, Some(1e9), None);
        let kappa = 1.0 + NITROGEN_R_J_KG_K / NITROGEN_CV_J_KG_K;
        let exact = 4e6 * libm::pow(2.0, kappa);
        assert!((compress(&gas, 1e-4, 5e-5, 1.0, 40_000) / exact - 1.0).abs() < 1e-4);
    }

    #[test]
    fn relaxes_with_the_time_constant() {
        let gas = Gas::charged(4e6, 1e-4, 293.15, Some(3.0), None);
        let mut s = GasState {
            volume_m3: 1e-4,
            temperature_k: 350.0,
        };
        for _ in 0..30_000 {
            (s, _, _) = gas.implicit(s, 1e-4, 0.0, s.temperature_k);
        }
        let left = (s.temperature_k - 293.15) / (350.0 - 293.15);
        assert!((left - libm::exp(-1.0)).abs() < 1e-4);
    }

    #[test]
    fn derivative_by_flow_is_the_difference_quotient() {
        for real in [None, Some(Nitrogen::reference())] {
            for tau in [None, Some(2.0)] {
                let gas = Gas::charged(4e6, 1e-4, 293.15, tau, real.clone());
                let base = GasState {
                    volume_m3: 0.8e-4,
                    temperature_k: if tau.is_some() { 300.0 } else { 293.15 },
                };
                let at = |q: f64| gas.implicit(base, 1e-3, q, 300.0);
                let (_, _, slope) = at(1e-3);
                let quotient = (at(1.001e-3).1 - at(0.999e-3).1) / 2e-6;
                assert!((slope / quotient - 1.0).abs() < 0.02, "{slope} {quotient}");
            }
        }
    }
}
