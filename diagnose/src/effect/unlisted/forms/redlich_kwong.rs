//! The compressibility factor of a gas over its density: `1 / (1 - b x) - a x`. The molecules have a volume, which makes a dense gas stiffer, and they
//! attract each other, which makes it softer, the less the hotter it is (Redlich & Kwong, Chem. Rev. 44(1), 1949, with the attraction in proportion
//! to the square of the density, as van der Waals has it).
//!
//! Two numbers are nitrogen to a thousandth of the pressure, over all densities and temperatures of a strut. A factor over the volume is not: the
//! attraction also decides how much work warms the gas.

use super::form::{ClosedForm, Form, Grid};
use crate::parameter::Parameter;

/// Largest part of the volume that molecules take at the static density. Four times as dense they then leave four tenths.
const MOST_VOLUME: f64 = 0.15;
/// Largest part of the factor that attraction takes there. A gas that has more of it is near its vapour.
const MOST_ATTRACTION: f64 = 0.2;

/// The compressibility factor of a gas whose molecules have a volume and attract each other.
pub struct RedlichKwong;

impl Form for RedlichKwong {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = 1 / (1 - b x) - a x (T_0 / T)^(3/2)",
            symbols: &["b", "a"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        vec![
            Parameter::amount("molecular_volume", grid.visible, MOST_VOLUME),
            Parameter::amount("attraction", grid.visible, MOST_ATTRACTION),
        ]
    }

    fn attraction(&self, fitted: &[f64]) -> Option<f64> {
        fitted.get(1).copied()
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let &[volume, attraction] = fitted else {
            return vec![1.0; grid.knots.len()];
        };
        (grid.knots.iter())
            .map(|x| 1.0 / (1.0 - volume * x) - attraction * x)
            .collect()
    }
}
