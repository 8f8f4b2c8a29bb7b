//! Finite bulk modulus of the oil in the main chamber: `dp = beta dV / V`.
//!
//! The report measured 1.5e9 Pa (figure 21); hydraulic oils have 0.5e9 to 2.5e9 Pa.
//!
//! Two ways of counting oil, [`OilCount`], give the two equations
//!
//! ```text
//! chamber:  dp1/dt = beta / (V - A x) (A dx/dt - Q1 - Q2)
//! static:   d/dt [ (V - A x) (exp((p1 - p_static) / beta) - 1) ] = A dx/dt - Q1 - Q2
//! ```

use super::equation::Equation;
use serde::{Deserialize, Serialize};

use crate::lanes::Number;
use crate::model_file::{Checked, Limit, Range};

/// The density at which the main chamber's balance counts oil.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum OilCount {
    /// The density in the chamber at the moment, as in the recordings' equation. A closed loop in the force-displacement
    /// plane then shifts `loop area / beta` of oil out of the chamber: nothing in a recording, centimetres of ride height
    /// in an hour.
    #[default]
    Chamber,
    /// The density at static pressure. No oil is gained or lost.
    Static,
}

/// The oil in the main chamber is compressible.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OilCompressibility {
    /// Bulk modulus beta, Pa; usually 0.5e9 to 2.5e9.
    #[serde(rename = "bulk_modulus_Pa")]
    pub bulk_modulus_pa: f64,
    /// The density at which oil is counted; `chamber` where the file does not say.
    #[serde(default, skip_serializing_if = "is_chamber")]
    pub counted_at: OilCount,
}

fn is_chamber(counted_at: &OilCount) -> bool {
    *counted_at == OilCount::Chamber
}

impl Checked for OilCompressibility {
    const LIMITS: &'static [Limit<Self>] = &[Limit::one("bulk_modulus_Pa", Range::FromTo(1e6, 1e14), "Pa", |t| {
        t.bulk_modulus_pa
    })];
}

/// The equation with oil counted at the chamber's density. Counted at the static one it is that of the module's heading.
pub const EQUATION: Equation = Equation {
    text: "dp1/dt = beta / (V - A x) (A dx/dt - Q1 - Q2)",
    source: "Theron & Els, final report 2002, figure 21",
};

/// Oil that a chamber of `oil_m3` takes up when its pressure rises by `rise_pa`, counted at the chamber's density, m3, and
/// its derivative by the pressure, m3/Pa. `compressibility` is `1 / beta`, 1/Pa; 0 for rigid oil.
#[inline(always)]
pub(in crate::strut) fn taken_up_at_chamber_density<N: Number>(oil_m3: N, rise_pa: N, compressibility: N) -> (N, N) {
    let slope = oil_m3 * compressibility;
    (slope * rise_pa, slope)
}

/// Oil that a chamber of `oil_m3` holds `over_pa` above static pressure beyond what it holds there, counted at the static
/// density, m3, and its derivative by the pressure, m3/Pa.
///
/// `V (exp(y) - 1)` with `y = over / beta`. `y` is at most a few per cent, so the series is cut after `y^3 / 6`; the term
/// left out is `y^4 / 24`, 1e-8 of the volume.
#[inline(always)]
pub(in crate::strut) fn held_at_static_density<N: Number>(oil_m3: N, over_pa: N, compressibility: N) -> (N, N) {
    let y = over_pa * compressibility;
    (
        oil_m3 * y * (y * (y * (1.0 / 6.0) + 0.5) + 1.0),
        oil_m3 * compressibility * (y * (y * 0.5 + 1.0) + 1.0),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const OIL_M3: f64 = 9e-4;

    #[test]
    fn the_static_density_law_is_the_exponential_and_its_derivative() {
        for over in [-4e6, 0.0, 1e6, 2e7] {
            let (held, slope) = held_at_static_density(OIL_M3, over, 1.0 / 1.5e9);
            assert!((held - OIL_M3 * libm::expm1(over / 1.5e9)).abs() < 2e-9 * OIL_M3);
            assert!((slope / (OIL_M3 / 1.5e9 * libm::exp(over / 1.5e9)) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn both_ways_of_counting_agree_for_small_rises() {
        let (a, slope) = taken_up_at_chamber_density(OIL_M3, 1e3, 1.0 / 1.5e9);
        let (b, _) = held_at_static_density(OIL_M3, 1e3, 1.0 / 1.5e9);
        assert!((a / b - 1.0).abs() < 1e-6 && a == 1e3 * slope);
        assert_eq!(taken_up_at_chamber_density(OIL_M3, 1e6, 0.0), (0.0, 0.0));
    }
}
