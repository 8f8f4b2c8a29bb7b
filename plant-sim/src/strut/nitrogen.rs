//! Real nitrogen: the reference equation of state, and Benedict-Webb-Rubin for comparison.
//!
//! Reference: Span, Lemmon, Jacobsen, Wagner & Yokozeki, "A reference equation of state for the thermodynamic
//! properties of nitrogen ...", J. Phys. Chem. Ref. Data 29(6), 2000, table 17 (constants), eq. (53): the residual
//! Helmholtz energy `alpha(delta, tau)`, from which `p = rho R T (1 + delta alpha_delta)`. Its four critical-region terms are
//! left out: they vanish below 1e-30 of the rest at the temperatures of a gas spring (above 1.5 critical temperatures).
//! BWR constants as in the project's vehicle notes (van der Westhuizen & Els use this equation for suspensions).
//!
//! Both cost a microsecond to evaluate, the solver asks four times a step, so `(p - rho R T) / rho^2`, which is smooth and
//! nearly constant, is tabulated once on a grid and read by cubic interpolation, to 1e-6 of the pressure.

use std::sync::{Arc, LazyLock};

use oleo_interface::Absolute;

use super::settled::settled;

/// Gas constant of the reference equation, J/kg/K.
const R: f64 = 8.31451 / 0.028_013_48;
const CRITICAL_K: f64 = 126.192;
const CRITICAL_KG_M3: f64 = 313.3;

/// `(i, j, l, N)` of the terms `N delta^i tau^j exp(-delta^l)` (no exponential for `l = 0`).
const TERMS: [(usize, f64, usize, f64); 32] = [
    (1, 0.25, 0, 0.924803575275),
    (1, 0.875, 0, -0.492448489428),
    (2, 0.5, 0, 0.661883336938),
    (2, 0.875, 0, -1.92902649201),
    (3, 0.375, 0, -0.0622469309629),
    (3, 0.75, 0, 0.349943957581),
    (1, 0.5, 1, 0.564857472498),
    (1, 0.75, 1, -1.61720005987),
    (1, 2.0, 1, -0.481395031883),
    (3, 1.25, 1, 0.421150636384),
    (3, 3.5, 1, -0.0161962230825),
    (4, 1.0, 1, 0.172100994165),
    (6, 0.5, 1, 0.00735448924933),
    (6, 3.0, 1, 0.0168077305479),
    (7, 0.0, 1, -0.00107626664179),
    (7, 2.75, 1, -0.0137318088513),
    (8, 0.75, 1, 0.000635466899859),
    (8, 2.5, 1, 0.00304432279419),
    (1, 4.0, 2, -0.0435762336045),
    (2, 6.0, 2, -0.0723174889316),
    (3, 6.0, 2, 0.0389644315272),
    (4, 3.0, 2, -0.021220136391),
    (5, 3.0, 2, 0.00408822981509),
    (8, 6.0, 2, -5.51990017984e-05),
    (4, 16.0, 3, -0.0462016716479),
    (5, 11.0, 3, -0.00300311716011),
    (5, 15.0, 3, 0.0368825891208),
    (8, 12.0, 3, -0.0025585684622),
    (3, 12.0, 4, 0.00896915264558),
    (5, 7.0, 4, -0.0044151337035),
    (6, 4.0, 4, 0.00133722924858),
    (9, 16.0, 4, 0.000264832491957),
];

/// Pressure over density at one temperature, the powers of the temperature taken once.
fn reference_isotherm(temperature: f64) -> impl Fn(f64) -> f64 {
    let tau = CRITICAL_K / temperature;
    let weighted = TERMS.map(|(_, j, _, n)| n * libm::pow(tau, j));
    move |density| {
        let delta = density / CRITICAL_KG_M3;
        let mut powers = [1.0; 10];
        for i in 1..10 {
            powers[i] = powers[i - 1] * delta;
        }
        let decay = [0, 1, 2, 3, 4].map(|l| if l == 0 { 1.0 } else { libm::exp(-powers[l]) });
        let slope: f64 = TERMS
            .iter()
            .zip(&weighted)
            .map(|(&(i, _, l, _), n)| {
                let order = i as f64 - if l == 0 { 0.0 } else { l as f64 * powers[l] };
                n * powers[i] * decay[l] * order
            })
            .sum();
        density * R * temperature * (1.0 + slope)
    }
}

fn bwr_isotherm(temperature: f64) -> impl Fn(f64) -> f64 {
    // kPa, m3/kmol, K, Ru 8.314 (project notes).
    let (a, a0, b, b0, c, c0, alpha, gamma) = (2.54, 106.73, 0.002_328, 0.040_74, 7.379e4, 8.164e5, 1.272e-4, 0.0053);
    let (ru, t) = (8.314, temperature);
    let t2 = t * t;
    move |density| {
        let x = density / 28.013_48;
        let x2 = x * x;
        let x3 = x2 * x;
        1e3 * (ru * t * x
            + (b0 * ru * t - a0 - c0 / t2) * x2
            + (b * ru * t - a) * x3
            + a * alpha * x3 * x3
            + c * x3 / t2 * (1.0 + gamma * x2) * libm::exp(-gamma * x2))
    }
}

const DENSITY_STEP: f64 = 8.0;
const DENSITY_NODES: usize = 76;
const TEMPERATURE_FROM: f64 = 190.0;
const TEMPERATURE_STEP: f64 = 8.0;
const TEMPERATURE_NODES: usize = 54;

/// A state of the real gas and its derivatives.
#[derive(Debug, Clone, Copy)]
pub struct State {
    /// Absolute pressure of the gas.
    pub pressure: Absolute<f64>,
    /// Isothermal derivative by density, Pa m3/kg.
    pub dp_drho_pa_m3_kg: f64,
    /// Isochoric derivative by temperature, Pa/K.
    pub dp_dt_pa_k: f64,
}

/// An equation of state on its grid; cheap to clone. Valid for 190 to 610 K and densities to 600 kg/m3 (about 70 MPa).
///
/// ```
/// use oleo_interface::Absolute;
/// use oleo_plant_sim::strut::Nitrogen;
/// let gas = Nitrogen::reference();
/// // At 10 MPa and 300 K nitrogen is a little less dense than an ideal gas.
/// let (density, ideal) = (gas.density(Absolute(10.0e6), 300.0), 10.0e6 / (gas.gas_constant() * 300.0));
/// assert!(density < ideal && density > 0.99 * ideal);
/// assert!((gas.state(density, 300.0).pressure.pa() / 10.0e6 - 1.0).abs() < 1e-9);
/// ```
#[derive(Debug, Clone)]
pub struct Nitrogen {
    gas_constant: f64,
    /// `(p - rho R T) / rho^2` at node `density * TEMPERATURE_NODES + temperature`.
    excess: Arc<[f64]>,
}

impl Nitrogen {
    /// The reference equation of Span et al.
    #[must_use]
    pub fn reference() -> Self {
        static GRID: LazyLock<Nitrogen> = LazyLock::new(|| Nitrogen::tabulate(R, reference_isotherm));
        GRID.clone()
    }

    /// Nitrogen by the Benedict-Webb-Rubin equation.
    #[must_use]
    pub fn bwr() -> Self {
        static GRID: LazyLock<Nitrogen> = LazyLock::new(|| Nitrogen::tabulate(8314.0 / 28.013_48, bwr_isotherm));
        GRID.clone()
    }

    fn tabulate<F: Fn(f64) -> f64>(gas_constant: f64, isotherm: impl Fn(f64) -> F) -> Self {
        let mut excess = vec![0.0; DENSITY_NODES * TEMPERATURE_NODES];
        for j in 0..TEMPERATURE_NODES {
            let t = TEMPERATURE_FROM + TEMPERATURE_STEP * j as f64;
            let pressure = isotherm(t);
            for i in 0..DENSITY_NODES {
                // At density zero the quotient's limit, the second virial coefficient times R T, is taken nearby.
                let density = (DENSITY_STEP * i as f64).max(0.05);
                excess[i * TEMPERATURE_NODES + j] =
                    (pressure(density) - density * gas_constant * t) / (density * density);
            }
        }
        Self {
            gas_constant,
            excess: excess.into(),
        }
    }

    /// Gas constant of the equation, J/kg/K.
    #[must_use]
    pub fn gas_constant(&self) -> f64 {
        self.gas_constant
    }

    /// `f = (p - rho R T) / rho^2`, Pa m6/kg2, and its derivatives by density (kg/m3) and temperature (K).
    #[must_use]
    pub fn excess(&self, density: f64, temperature: f64) -> (f64, f64, f64) {
        let (i, wd, wd1) = weights(density / DENSITY_STEP, DENSITY_NODES);
        let (j, wt, wt1) = weights((temperature - TEMPERATURE_FROM) / TEMPERATURE_STEP, TEMPERATURE_NODES);
        let (mut f, mut f_density, mut f_temperature) = (0.0, 0.0, 0.0);
        for a in 0..4 {
            let row = &self.excess[(i + a) * TEMPERATURE_NODES + j..][..4];
            let value = wt[0] * row[0] + wt[1] * row[1] + wt[2] * row[2] + wt[3] * row[3];
            let slope = wt1[0] * row[0] + wt1[1] * row[1] + wt1[2] * row[2] + wt1[3] * row[3];
            f += wd[a] * value;
            f_density += wd1[a] * value;
            f_temperature += wd[a] * slope;
        }
        (f, f_density / DENSITY_STEP, f_temperature / TEMPERATURE_STEP)
    }

    /// Pressure and derivatives at a density (kg/m3) and temperature (K).
    #[must_use]
    pub fn state(&self, density: f64, temperature: f64) -> State {
        let (f, f_density, f_temperature) = self.excess(density, temperature);
        let (rt, rho2) = (self.gas_constant * temperature, density * density);
        State {
            pressure: Absolute(density * rt + rho2 * f),
            dp_drho_pa_m3_kg: rt + 2.0 * density * f + rho2 * f_density,
            dp_dt_pa_k: density * self.gas_constant + rho2 * f_temperature,
        }
    }

    /// Density at a pressure (up to 60 MPa) and a temperature (K), kg/m3, by Newton's method.
    #[must_use]
    pub fn density(&self, pressure: Absolute<f64>, temperature: f64) -> f64 {
        let ideal = pressure.pa() / (self.gas_constant * temperature);
        settled(ideal, 20, |density| {
            let at = self.state(density, temperature);
            density - (at.pressure - pressure) / at.dp_drho_pa_m3_kg
        })
    }
}

/// First node, weights and weights of the derivative (per node spacing) of cubic Lagrange interpolation at `s`.
#[inline]
fn weights(s: f64, nodes: usize) -> (usize, [f64; 4], [f64; 4]) {
    let first = (s - 1.0).clamp(0.0, (nodes - 4) as f64) as usize;
    let u = s - first as f64; // between 1 and 2 except at the rims
    let (a, b, c, d) = (u, u - 1.0, u - 2.0, u - 3.0);
    let values = [-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0];
    let slopes = [
        -(c * d + b * d + b * c) / 6.0,
        (c * d + a * d + a * c) / 2.0,
        -(b * d + a * d + a * b) / 2.0,
        (b * c + a * c + a * b) / 6.0,
    ];
    (first, values, slopes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Single-phase table of Span et al. (2000) as reprinted by NIST: 10 MPa at 300 K has 110.6 kg/m3 (111.9 for ideal gas
    /// would be 112.3); second virial coefficient at 300 K is -4.5 cm3/mol (Dymond & Smith).
    #[test]
    fn density_and_virial_coefficient() {
        let gas = Nitrogen::reference();
        let rho = gas.density(Absolute(10e6), 300.0);
        assert!((rho - 111.8).abs() < 1.0, "{rho}");
        let b = (reference_isotherm(300.0)(0.5) / (0.5 * R * 300.0) - 1.0) / (0.5 / 0.028_013_48) * 1e6;
        assert!((b + 4.5).abs() < 0.5, "{b} cm3/mol");
    }

    /// Rounds that are left out change no bit.
    #[test]
    fn a_density_is_that_of_twenty_rounds() {
        let gas = Nitrogen::reference();
        for k in 1..600 {
            let (p, t) = (Absolute(0.1e6 * f64::from(k)), 200.0 + 0.67 * f64::from(k));
            let twenty = (0..20).fold(p.pa() / (gas.gas_constant * t), |density, _| {
                let at = gas.state(density, t);
                density - (at.pressure - p) / at.dp_drho_pa_m3_kg
            });
            assert_eq!(gas.density(p, t).to_bits(), twenty.to_bits(), "{p:?} {t} K");
        }
    }

    #[test]
    fn the_grid_is_the_equation() {
        let gas = Nitrogen::reference();
        for k in 0..400 {
            let (rho, t) = (3.0 + 1.1 * f64::from(k), 240.0 + 0.53 * f64::from(k));
            let exact = reference_isotherm(t)(rho);
            assert!(
                (gas.state(rho, t).pressure.pa() / exact - 1.0).abs() < 1e-5,
                "{rho} {t}"
            );
        }
    }

    #[test]
    fn bwr_is_within_its_published_error() {
        let (a, b) = (Nitrogen::reference(), Nitrogen::bwr());
        for t in [253.0, 293.0, 350.0, 450.0] {
            for p in [1e6, 4e6, 10e6, 20e6] {
                let rho = a.density(Absolute(p), t);
                assert!((b.state(rho, t).pressure.pa() / p - 1.0).abs() < 0.0065, "{t} {p}");
            }
        }
    }
}
