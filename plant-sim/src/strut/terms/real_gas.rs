//! Nitrogen departs from the ideal gas law: `p = rho R T (1 + delta d(alpha_r)/d(delta))`.
//!
//! The equations of state themselves, with their sources and range, are in [`Nitrogen`].

use super::equation::Equation;
use serde::{Deserialize, Serialize};

use crate::model_file::{Checked, Limit};
use crate::strut::nitrogen::Nitrogen;

/// Equation of state of the real gas.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum GasEquation {
    /// The reference equation of Span et al., J. Phys. Chem. Ref. Data 29(6), 2000.
    #[default]
    Reference,
    /// Benedict-Webb-Rubin with the constants of the project's vehicle notes.
    Bwr,
}

/// The gas in both accumulators is real.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RealGas {
    /// The equation of state; the reference equation where the file does not say.
    #[serde(default)]
    pub equation: GasEquation,
}

impl Checked for RealGas {
    const LIMITS: &'static [Limit<Self>] = &[];
}

/// The pressure of [`GasEquation::Reference`]: `alpha_r` is the residual Helmholtz energy, `delta` the density over the
/// critical one.
pub const EQUATION: Equation = Equation {
    text: "p = rho R T (1 + delta d(alpha_r)/d(delta))",
    source: "Span et al., J. Phys. Chem. Ref. Data 29(6), 2000",
};

impl RealGas {
    /// The equation of state, ready for use.
    #[must_use]
    pub fn nitrogen(&self) -> Nitrogen {
        match self.equation {
            GasEquation::Reference => Nitrogen::reference(),
            GasEquation::Bwr => Nitrogen::bwr(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_interface::Absolute;

    #[test]
    fn both_equations_are_near_the_ideal_gas_at_low_pressure_and_apart_from_it_at_high() {
        for equation in [GasEquation::Reference, GasEquation::Bwr] {
            let gas = RealGas { equation }.nitrogen();
            let ratio = |pa: f64| gas.density(Absolute(pa), 293.15) * gas.gas_constant() * 293.15 / pa;
            assert!((ratio(1e5) - 1.0).abs() < 1e-3, "{}", ratio(1e5));
            assert!((0.80..0.92).contains(&ratio(4e7)), "{}", ratio(4e7));
        }
    }
}
