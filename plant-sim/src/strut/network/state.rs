//! The state of the network: what an integrator carries from one step to the next.

use serde::{Deserialize, Serialize};

use crate::strut::gas::GasState;

/// The differential states of the network.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(in crate::strut) struct State {
    /// Gauge pressure of the main chamber, Pa.
    pub p1_pa: f64,
    /// Gas of accumulators 1 and 2.
    pub gas: [GasState; 2],
    /// Volume that the main chamber holds beyond what it holds at static pressure, m3. It is a state of its own beside
    /// p1: stages must blend volumes, since the pressure near vacuum is anything but linear in them.
    pub held_m3: f64,
    /// Fraction by which the chamber's content has been compressed beyond what a constant bulk modulus makes of it. The
    /// recordings' equation multiplies it by the chamber as it is at the moment, so it is a state of its own too.
    pub compressed: f64,
    /// Flow of path 2, m3/s, which the oil column of its line carries on.
    pub q2_m3_s: f64,
    /// Shear of the seals of the floating pistons, -1 to 1.
    pub shear: [f64; 2],
    /// Energy held by the oil of the dampers, J.
    pub heat_j: [f64; 2],
    /// Mean of the gas volumes over the static ones, over the time constant of a law with a memory.
    pub mean_volume: [f64; 2],
}

impl State {
    /// `self + weight (other - self)`, state by state: the recombination that the stages of a Runge-Kutta step need.
    #[inline]
    pub fn blend(&self, other: &Self, weight: f64) -> Self {
        let mix = |a: f64, b: f64| a + weight * (b - a);
        let both = |a: [f64; 2], b: [f64; 2]| [mix(a[0], b[0]), mix(a[1], b[1])];
        let gas = |i: usize| GasState {
            volume_m3: mix(self.gas[i].volume_m3, other.gas[i].volume_m3),
            temperature_k: mix(self.gas[i].temperature_k, other.gas[i].temperature_k),
        };
        Self {
            p1_pa: mix(self.p1_pa, other.p1_pa),
            gas: [gas(0), gas(1)],
            held_m3: mix(self.held_m3, other.held_m3),
            compressed: mix(self.compressed, other.compressed),
            q2_m3_s: mix(self.q2_m3_s, other.q2_m3_s),
            shear: both(self.shear, other.shear),
            heat_j: both(self.heat_j, other.heat_j),
            mean_volume: both(self.mean_volume, other.mean_volume),
        }
    }
}
