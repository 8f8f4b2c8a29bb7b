//! A gas spring in parallel: `F = F_0 (1 - x/L)^(-1.4)`.
//!
//! The gas of a monotube damper or of a counterbalance is compressed by the volume of the rod. In strokes of seconds a
//! diatomic gas is adiabatic, with the exponent 1.4. `F_0` is its force at `x = 0`, and `L` the length of the gas column there:
//! gas volume over rod area.

use serde::{Deserialize, Serialize};

use crate::model_file::{Checked, Limit, Range};
use crate::strut::Equation;

/// Ratio of the specific heats of a diatomic gas.
const ADIABATIC_EXPONENT: f64 = 1.4;
/// Least part of the gas column that may be left.
const LEAST_LENGTH: f64 = 0.02;

/// A gas spring in parallel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParallelGasSpring {
    /// Force at zero displacement, `F_0`, N, 0 or more.
    #[serde(rename = "gas_force_N")]
    pub gas_force_n: f64,
    /// Length of the gas column at zero displacement, `L`, m.
    #[serde(rename = "gas_length_m")]
    pub gas_length_m: f64,
}

impl Checked for ParallelGasSpring {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("gas_force_N", Range::FromTo(0.0, 1e9), "N", |g| g.gas_force_n),
        Limit::one("gas_length_m", Range::FromTo(1e-4, 1e4), "m", |g| g.gas_length_m),
    ];
}

impl ParallelGasSpring {
    /// Force over displacement, compression positive.
    pub const EQUATION: Equation = Equation {
        text: "F = F_0 (1 - x/L)^(-1.4)",
        source: "Poisson's adiabat of a diatomic gas",
    };

    /// Force at a displacement (m), N. Compressed to the last fiftieth of its length the column counts as solid.
    #[must_use]
    pub fn force_n(&self, displacement_m: f64) -> f64 {
        let left = 1.0 - displacement_m / self.gas_length_m;
        self.gas_force_n * libm::pow(left.max(LEAST_LENGTH), -ADIABATIC_EXPONENT)
    }

    /// Refuse a displacement (m) that leaves no gas volume.
    ///
    /// # Errors
    /// The displacement and the length of the gas column.
    pub fn check_reaches(&self, displacement_m: f64) -> Result<(), String> {
        if displacement_m <= (1.0 - LEAST_LENGTH) * self.gas_length_m {
            return Ok(());
        }
        Err(format!(
            "a displacement of {displacement_m} m would leave nothing of a gas column of {} m; correct gas_length_m",
            self.gas_length_m
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAS: ParallelGasSpring = ParallelGasSpring {
        gas_force_n: 200.0,
        gas_length_m: 0.1,
    };

    #[test]
    fn force_times_length_to_the_exponent_is_constant() {
        for x in [-0.05, 0.0, 0.03, 0.08] {
            let constant = GAS.force_n(x) * libm::pow(0.1 - x, 1.4);
            assert!((constant / (200.0 * libm::pow(0.1, 1.4)) - 1.0).abs() < 1e-12, "{x}");
        }
        // Work of the gas over a stroke: F_0 L / 0.4 ((1 - x/L)^-0.4 - 1).
        let steps = 20_000;
        let step = 0.06 / f64::from(steps);
        let work: f64 = (0..steps)
            .map(|k| step * GAS.force_n((f64::from(k) + 0.5) * step))
            .sum();
        let expected = 200.0 * 0.1 / 0.4 * (libm::pow(0.4, -0.4) - 1.0);
        assert!((work / expected - 1.0).abs() < 1e-6, "{work} {expected}");
    }

    #[test]
    fn too_long_a_stroke_is_an_error() {
        assert!(GAS.check_reaches(0.099).is_err_and(|e| e.contains("gas_length_m")));
        assert_eq!(GAS.check_reaches(0.09), Ok(()));
        assert_eq!(GAS.force_n(0.2), GAS.force_n(0.099));
    }
}
