//! A force that yields smoothly with speed: `F = F_y tanh(v / v_y)`.
//!
//! A magneto-rheological fluid, or a blow-off valve, resists a slow motion like a stiff viscous damper and a fast one with a
//! nearly constant force. The hyperbolic tangent joins the two; at the yield speed `v_y` it has reached 76 % of `F_y`.

use serde::{Deserialize, Serialize};

use crate::model_file::{Checked, Limit, Range};
use crate::strut::Equation;

/// A resisting force that saturates with speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SmoothYield {
    /// Force at high speed, `F_y`, N, 0 or more.
    #[serde(rename = "yield_force_N")]
    pub yield_force_n: f64,
    /// Speed at which the force has reached 76 % of that, `v_y`, m/s.
    #[serde(rename = "yield_speed_m_s")]
    pub yield_speed_m_s: f64,
}

impl Checked for SmoothYield {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("yield_force_N", Range::FromTo(0.0, 1e9), "N", |f| f.yield_force_n),
        Limit::one("yield_speed_m_s", Range::FromTo(1e-6, 1e3), "m/s", |f| {
            f.yield_speed_m_s
        }),
    ];
}

impl SmoothYield {
    /// Force against the motion.
    pub const EQUATION: Equation = Equation {
        text: "F = F_y tanh(v / v_y)",
        source: "Kwok, Ha, Nguyen, Li & Samali, Sensors and Actuators A 132(2), 2006",
    };

    /// Force at a speed (m/s), N, and its slope over speed, N s/m.
    #[must_use]
    pub fn force_and_slope(&self, speed_m_s: f64) -> (f64, f64) {
        let tanh = libm::tanh(speed_m_s / self.yield_speed_m_s);
        let slope = self.yield_force_n / self.yield_speed_m_s * (1.0 - tanh * tanh);
        (self.yield_force_n * tanh, slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const YIELD: SmoothYield = SmoothYield {
        yield_force_n: 600.0,
        yield_speed_m_s: 0.015,
    };

    #[test]
    fn slow_it_is_viscous_and_fast_it_is_constant() {
        let force = |speed: f64| YIELD.force_and_slope(speed).0;
        let viscous = 600.0 / 0.015;
        assert!((force(1e-5) / (viscous * 1e-5) - 1.0).abs() < 1e-6);
        assert!((force(1.0) - 600.0).abs() < 1e-9 && force(-1.0) == -force(1.0));
        // tanh(1) = (e^2 - 1) / (e^2 + 1).
        let e2 = std::f64::consts::E * std::f64::consts::E;
        assert!((force(0.015) - 600.0 * (e2 - 1.0) / (e2 + 1.0)).abs() < 1e-9);
    }

    #[test]
    fn the_slope_is_the_derivative() {
        for speed in [-0.03, -0.004, 0.0, 0.01, 0.05] {
            let (low, high) = (
                YIELD.force_and_slope(speed - 1e-6).0,
                YIELD.force_and_slope(speed + 1e-6).0,
            );
            let slope = YIELD.force_and_slope(speed).1;
            assert!((slope - (high - low) / 2e-6).abs() < 1e-3 * (1.0 + slope), "{speed}");
        }
    }
}
