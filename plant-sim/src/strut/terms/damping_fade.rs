//! The dampers weaken as their oil warms.
//!
//! `drop = drop_cold / (1 + f E)`, where `E` is the energy that the oil of the pack holds: `dE/dt = dp Q - E / tau`, the
//! power dissipated in the path less what cools away (lumped energy balance; *assumed* form).

use super::equation::Equation;
use serde::{Deserialize, Serialize};

use crate::lanes::Number;
use crate::model_file::{Checked, Limit, Range};
use crate::strut::flow_path::FlowPath;

/// Warm dampers are weaker.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DampingFade {
    /// Relative weakening of pack 1 for each joule held, `f`, 1/J; usually up to 1e-3.
    #[serde(rename = "fade_1_per_J")]
    pub fade_1_per_j: f64,
    /// Relative weakening of pack 2 for each joule held, 1/J.
    #[serde(rename = "fade_2_per_J")]
    pub fade_2_per_j: f64,
    /// Cooling time constant, `tau`, s; usually 10 to 1,000.
    pub cooling_time_s: f64,
}

/// Relative weakening for each joule, 1/J.
const FADE_PER_J: Range = Range::FromTo(0.0, 1e3);

impl Checked for DampingFade {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("fade_1_per_J", FADE_PER_J, "1/J", |t| t.fade_1_per_j),
        Limit::one("fade_2_per_J", FADE_PER_J, "1/J", |t| t.fade_2_per_j),
        Limit::one("cooling_time_s", Range::FromTo(1e-3, 1e12), "s", |t| t.cooling_time_s),
    ];
}

impl DampingFade {
    /// The fade of the pack of a path.
    #[must_use]
    pub fn pack(&self, path: FlowPath) -> PackFade {
        PackFade {
            per_j: path.pick(self.fade_1_per_j, self.fade_2_per_j),
        }
    }

    /// What cools its packs.
    #[must_use]
    pub fn cooling(&self) -> PackCooling {
        PackCooling {
            time_s: self.cooling_time_s,
        }
    }
}

/// The cooling of both packs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PackCooling<N = f64> {
    /// Time constant, s.
    pub time_s: N,
}

impl<N: Number> PackCooling<N> {
    /// What is left of the energy held (J) after it has cooled for a while (s), J. One implicit step.
    #[inline(always)]
    #[must_use]
    pub fn cooled(&self, energy_j: N, duration_s: N) -> N {
        energy_j * (duration_s / self.time_s + 1.0).recip()
    }
}

impl PackCooling {
    /// The energy held, J, by a pack that was cold and was heated by a constant power (W) for a while (s): `P tau (1 - exp(-t / tau))`.
    #[must_use]
    pub fn held_j(&self, power_w: f64, duration_s: f64) -> f64 {
        -power_w * self.time_s * libm::expm1(-duration_s / self.time_s)
    }
}

/// The fade of one pack; none by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PackFade<N = f64> {
    /// Relative weakening for each joule held, 1/J.
    pub per_j: N,
}

/// Drop of a pack whose oil holds the energy `E`.
pub const EQUATION: Equation = Equation {
    text: "drop = drop_cold / (1 + f E), dE/dt = dp Q - E / tau",
    source: "lumped energy balance, assumed",
};

impl<N: Number> PackFade<N> {
    /// What the pack's pressure drop is divided by while its oil holds an energy (J).
    #[inline(always)]
    #[must_use]
    pub fn weakening(&self, energy_j: N) -> N {
        self.per_j * energy_j + 1.0
    }

    /// Energy held, J, after oil has flowed (m3/s) across a pressure drop (Pa) for a while (s). A pack that does not fade
    /// is not heated.
    #[inline(always)]
    #[must_use]
    pub fn heated(&self, energy_j: N, duration_s: N, drop_pa: N, flow_m3_s: N) -> N {
        let fades = self.per_j.above(self.per_j.of(0.0));
        N::choose(fades, energy_j + duration_s * drop_pa * flow_m3_s, energy_j)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FADE: DampingFade = DampingFade {
        fade_1_per_j: 1e-4,
        fade_2_per_j: 0.0,
        cooling_time_s: 60.0,
    };

    #[test]
    fn energy_settles_where_cooling_is_the_power() {
        let pack = FADE.pack(FlowPath::One);
        let mut energy = 0.0;
        for _ in 0..60_000 {
            energy = FADE.cooling().cooled(pack.heated(energy, 1e-3, 1e6, 1e-4), 1e-3);
        }
        assert!(
            (energy / FADE.cooling().held_j(100.0, 60.0) - 1.0).abs() < 1e-4,
            "{energy}"
        );
        // Much later it cools as fast as it is heated.
        assert!((FADE.cooling().held_j(100.0, 6000.0) / 6000.0 - 1.0).abs() < 1e-12);
        assert!((pack.weakening(energy) - (1.0 + 1e-4 * energy)).abs() < 1e-15);
    }

    #[test]
    fn a_pack_without_fade_holds_nothing() {
        let pack = FADE.pack(FlowPath::Two);
        assert_eq!(pack.heated(0.0, 1e-3, 1e6, 1e-4), 0.0);
        assert_eq!(pack.weakening(1e4), 1.0);
    }
}
