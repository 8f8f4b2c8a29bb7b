//! Undissolved air in the main chamber's oil: the bulk modulus falls at low pressure.
//!
//! `1/beta_eff = 1/beta + a (p_atm/p)^(1/n) / (n p)`, p absolute (Gholizadeh, Burton & Schoenau, "Fluid bulk modulus: a
//! literature survey", Int. J. Fluid Power 12(3), 2011). Ordinary hydraulic practice has a = 0.005.

use super::equation::Equation;
use oleo_interface::{Absolute, Gauge};
use serde::{Deserialize, Serialize};

use crate::lanes::{Mask, Number, power};
use crate::model_file::{Checked, Limit, Range};
use crate::strut::pressure::{ATMOSPHERE_PA, absolute};

/// The oil in the main chamber holds bubbles of air.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EntrainedAir {
    /// Volume of the air over that of the oil at atmospheric pressure, `a`; usually 0 to 0.1.
    pub volume_fraction: f64,
    /// Polytropic exponent of the bubbles, `n`: 1 where they exchange heat (slow), 1.4 where they do not (fast).
    pub polytropic_exponent: f64,
}

impl Checked for EntrainedAir {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("volume_fraction", Range::FromTo(0.0, 1.0), "", |t| t.volume_fraction),
        Limit::one("polytropic_exponent", Range::FromTo(0.5, 3.0), "", |t| {
            t.polytropic_exponent
        }),
    ];
}

/// Pressure below which the volume of the bubbles is continued by its tangent: a tenth of the least that oil shows.
pub(in crate::strut) const LEAST_BUBBLE_PRESSURE: Absolute<f64> = Absolute(2e3);

/// `p` is absolute, `beta` the bulk modulus of the oil alone.
pub const EQUATION: Equation = Equation {
    text: "1/beta_eff = 1/beta + a (p_atm/p)^(1/n) / (n p)",
    source: "Gholizadeh, Burton & Schoenau, Int. J. Fluid Power 12(3), 2011",
};

impl EntrainedAir {
    /// Its bubbles.
    #[must_use]
    pub fn bubbles(&self) -> Bubbles {
        Bubbles {
            volume_fraction: self.volume_fraction,
            polytropic_exponent: self.polytropic_exponent,
        }
    }
}

/// The bubbles of entrained air.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bubbles<N = f64> {
    /// Volume of the air over that of the oil at atmospheric pressure.
    pub volume_fraction: N,
    /// Polytropic exponent of the bubbles.
    pub polytropic_exponent: N,
}

impl<N: Number> Bubbles<N> {
    /// Volume of the air over that of the oil at a pressure, and minus its derivative, 1/Pa.
    ///
    /// `a (p_atm/p)^(1/n)`. As the pressure nears vacuum the bubbles take up the whole flow; this is also what keeps a
    /// strut in violent rebound from pulling on its oil.
    #[inline(always)]
    #[must_use]
    pub fn volume(&self, pressure: Gauge<N>) -> (N, N) {
        let pressure = absolute(pressure).pa();
        let held = pressure.at_least(pressure.of(LEAST_BUBBLE_PRESSURE.pa()));
        let inverse = held.recip();
        let ratio = inverse * ATMOSPHERE_PA;
        let n = self.polytropic_exponent;
        let one = n.of(1.0);
        // Isothermal bubbles, the usual choice, need no power function.
        let isothermal = n.up_to(one) & one.up_to(n);
        let (expansion, shrinking) = if isothermal.all() {
            (ratio, inverse)
        } else {
            let polytropic = power(ratio, n.recip());
            (N::choose(isothermal, ratio, polytropic), inverse / n)
        };
        let volume = self.volume_fraction * expansion;
        let slope = volume * shrinking;
        (volume + slope * (held - pressure), slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn isothermal_bubbles_obey_boyle() {
        let air = EntrainedAir {
            volume_fraction: 0.01,
            polytropic_exponent: 1.0,
        };
        assert_eq!(air.bubbles().volume(Gauge(0.0)).0, 0.01);
        let (volume, _) = air.bubbles().volume(Gauge(3.0 * ATMOSPHERE_PA));
        assert!((volume - 0.0025).abs() < 1e-15);
    }

    #[test]
    fn the_slope_is_that_of_the_volume_and_the_tangent_goes_on_below() {
        for n in [1.0, 1.2, 1.4] {
            let air = EntrainedAir {
                volume_fraction: 0.02,
                polytropic_exponent: n,
            };
            for gauge in [-1.1 * ATMOSPHERE_PA, -0.99 * ATMOSPHERE_PA, -5e4, 0.0, 4e6] {
                let h = 1e-4 * (gauge + 1.2 * ATMOSPHERE_PA);
                let quotient =
                    (air.bubbles().volume(Gauge(gauge - h)).0 - air.bubbles().volume(Gauge(gauge + h)).0) / (2.0 * h);
                let (_, slope) = air.bubbles().volume(Gauge(gauge));
                assert!((slope / quotient - 1.0).abs() < 1e-3, "{n} {gauge}: {slope} {quotient}");
            }
        }
    }
}
