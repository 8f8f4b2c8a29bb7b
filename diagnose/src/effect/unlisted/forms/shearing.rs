//! The level of a friction that is reached once a volume of oil has sheared the seal to sliding: `p_f x^n s`, where the shear `s` follows
//! `ds/dV = (1 - s sgn(Q)) / V_s`. A floating piston rubs so (Dahl, A solid friction model, Aerospace Corporation TOR-0158, 1968).
//!
//! The power of the gas volume is the change of the friction over the stroke of the piston. A seal that the gas presses on rubs more the less
//! volume the gas has; one that is squeezed as it was mounted rubs everywhere alike, with an exponent of zero.

use super::form::{ClosedForm, Form, Grid};
use crate::parameter::Parameter;

/// Volumes that are tried first, m3: a seal that is stiff, and one that is soft.
pub(super) const STARTS_M3: [f64; 2] = [1e-7, 1e-6];
/// Volumes that are possible, m3: a hundredth of a millimetre of a small piston to ten of a large one.
pub(super) const RANGE_M3: (f64, f64) = (1e-8, 2e-5);
/// Largest size of the exponent.
const STEEPEST: f64 = 3.0;

/// A level of friction of a seal that shears.
pub struct Shearing;

impl Form for Shearing {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = p_f x^n s, ds/dV = (1 - s sgn(Q)) / V_s",
            symbols: &["p_f", "n", "V_s"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        vec![
            Parameter::amount("breakaway_pressure_Pa", grid.visible, grid.most()),
            Parameter::linear("exponent", 0.0, 0.2, (-STEEPEST, STEEPEST)),
            Parameter::log("presliding_volume_m3", STARTS_M3[0], RANGE_M3),
        ]
    }

    fn starts(&self, grid: &Grid) -> Vec<Vec<f64>> {
        (STARTS_M3.iter())
            .flat_map(|volume| grid.larger().map(|level| vec![level, 0.0, *volume]))
            .collect()
    }

    fn presliding_volume_m3(&self, fitted: &[f64]) -> Option<f64> {
        fitted.get(2).copied()
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let &[level, exponent, _] = fitted else {
            return vec![0.0; grid.knots.len()];
        };
        grid.knots.iter().map(|x| level * libm::pow(*x, exponent)).collect()
    }
}
