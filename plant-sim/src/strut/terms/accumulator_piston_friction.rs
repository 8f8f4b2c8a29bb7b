//! Pressure held back by the seals of the floating pistons (the report's first suspicion for its hysteresis, 3.5.1).
//!
//! `p_oil = p_gas + p_f s`, `ds/dV = (1 - s sgn(Q)) / V_s`: the shear `s` of the seal goes from -1 to 1 while oil volume `V`
//! flows in, as Dahl's friction (1968) does over a displacement.

use super::equation::Equation;
use serde::{Deserialize, Serialize};

use crate::lanes::Number;
use crate::model_file::{Checked, Limit, Range};
use crate::strut::flow_path::FlowPath;

/// The seals of the accumulators' floating pistons rub.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AccumulatorPistonFriction {
    /// Breakaway pressure of accumulator 1, `p_f`, Pa; usually 1e4 to 2e5.
    #[serde(rename = "pressure_1_Pa")]
    pub pressure_1_pa: f64,
    /// Breakaway pressure of accumulator 2, Pa.
    #[serde(rename = "pressure_2_Pa")]
    pub pressure_2_pa: f64,
    /// Oil volume that shears a piston's seal from rest to sliding, `V_s`, m3; 1e-7 where the file does not say.
    #[serde(default = "presliding_volume")]
    pub presliding_volume_m3: f64,
}

/// Oil volume that shears a seal where a model file does not say: 0.05 mm of a 50 mm piston, m3. *Assumed*; a diagnosis fits it.
pub(in crate::strut::terms) const PRESLIDING_M3: f64 = 1e-7;

/// The same, as serde calls it.
fn presliding_volume() -> f64 {
    PRESLIDING_M3
}

/// Oil volume that may shear a seal, m3.
pub(in crate::strut::terms) const PRESLIDING_VOLUME_M3: Range = Range::FromTo(1e-12, 1.0);

/// Breakaway pressure, Pa.
const PRESSURE_PA: Range = Range::FromTo(0.0, 1e9);

impl Checked for AccumulatorPistonFriction {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("pressure_1_Pa", PRESSURE_PA, "Pa", |t| t.pressure_1_pa),
        Limit::one("pressure_2_Pa", PRESSURE_PA, "Pa", |t| t.pressure_2_pa),
        Limit::one("presliding_volume_m3", PRESLIDING_VOLUME_M3, "m3", |t| {
            t.presliding_volume_m3
        }),
    ];
}

impl AccumulatorPistonFriction {
    /// The seal of the piston at the end of a path.
    #[must_use]
    pub fn seal(&self, path: FlowPath) -> PistonSeal {
        PistonSeal {
            breakaway_pa: path.pick(self.pressure_1_pa, self.pressure_2_pa),
            presliding_m3: self.presliding_volume_m3,
        }
    }
}

/// The seal of one floating piston.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PistonSeal<N = f64> {
    /// Breakaway pressure, Pa; 0 for a piston without friction.
    pub breakaway_pa: N,
    /// Oil volume that shears the seal from rest to sliding, m3.
    pub presliding_m3: N,
}

/// Pressure beyond the piston, and the shear `s` of its seal.
pub const EQUATION: Equation = Equation {
    text: "p_oil = p_gas + p_f s, ds/dV = (1 - s sgn(Q)) / V_s",
    source: "Theron & Els, final report 2002, section 3.5.1; Dahl 1968",
};

impl PistonSeal {
    /// A piston without friction.
    pub const FREE: Self = Self {
        breakaway_pa: 0.0,
        presliding_m3: 1.0,
    };
}

impl<N: Number> PistonSeal<N> {
    /// Shear of the seal, -1 to 1, after oil has flowed in for `duration_s`, and its derivative by the flow, s/m3. One
    /// implicit step.
    #[inline(always)]
    #[must_use]
    pub fn sheared(&self, shear: N, duration_s: N, flow_m3_s: N) -> (N, N) {
        let k = duration_s / self.presliding_m3;
        let divisor = k * flow_m3_s.abs() + 1.0;
        (
            (shear + k * flow_m3_s) / divisor,
            k * (shear.of(1.0) - shear * flow_m3_s.map(f64::signum)) / (divisor * divisor),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEAL: PistonSeal = PistonSeal {
        breakaway_pa: 5e4,
        presliding_m3: 1e-7,
    };

    #[test]
    fn shears_exponentially_over_the_volume_and_never_beyond_sliding() {
        // ds/dV = (1 - s) / V_s from rest: s = 1 - exp(-V / V_s).
        let mut shear = 0.0;
        for _ in 0..100_000 {
            shear = SEAL.sheared(shear, 1e-6, 2e-6).0;
        }
        assert!((shear - (1.0 - libm::exp(-2.0))).abs() < 1e-5, "{shear}");
        assert!((SEAL.sheared(shear, 1.0, 1e-3).0 - 1.0).abs() < 1e-3);
        assert!((SEAL.sheared(shear, 1.0, -1e-3).0 + 1.0).abs() < 1e-3);
    }

    #[test]
    fn the_slope_is_that_of_the_shear() {
        for (shear, flow) in [(0.0, 1e-6), (0.7, -3e-5), (-0.4, 2e-4)] {
            let at = |q: f64| SEAL.sheared(shear, 1e-3, q).0;
            let quotient = (at(flow * 1.0001) - at(flow * 0.9999)) / (flow * 2e-4);
            assert!((SEAL.sheared(shear, 1e-3, flow).1 / quotient - 1.0).abs() < 1e-4);
        }
    }
}
