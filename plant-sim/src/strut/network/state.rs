//! The state of the network: what an integrator carries from one step to the next.

use serde::{Deserialize, Serialize};

use super::law_memory::LawMemory;
use crate::lanes::Number;
use crate::strut::gas::GasState;

/// The differential states of the network.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(in crate::strut) struct State<N = f64> {
    /// Gauge pressure of the main chamber, Pa.
    pub p1_pa: N,
    /// Gas of accumulators 1 and 2.
    pub gas: [GasState<N>; 2],
    /// Volume that the main chamber holds beyond what it holds at static pressure, m3. It is a state of its own beside
    /// p1: stages must blend volumes, since the pressure near vacuum is anything but linear in them.
    pub held_m3: N,
    /// Fraction by which the chamber's content has been compressed beyond what a constant bulk modulus makes of it. The
    /// recordings' equation multiplies it by the chamber as it is at the moment, so it is a state of its own too.
    pub compressed: N,
    /// Flow of path 2, m3/s, which the oil column of its line carries on.
    pub q2_m3_s: N,
    /// Shear of the seals of the floating pistons, -1 to 1.
    pub shear: [N; 2],
    /// Energy held by the oil of the dampers, J.
    pub heat_j: [N; 2],
    /// What laws without a name remember.
    pub laws: LawMemory<N>,
}

impl State {
    /// Several side by side, `like` any number of their kind.
    #[inline(always)]
    pub fn side_by_side<N: Number>(each: &[&Self], like: N) -> State<N> {
        let gas = |i: usize| GasState {
            volume_m3: like.gather_from(each, |s| s.gas[i].volume_m3),
            temperature_k: like.gather_from(each, |s| s.gas[i].temperature_k),
        };
        State {
            p1_pa: like.gather_from(each, |s| s.p1_pa),
            gas: [gas(0), gas(1)],
            held_m3: like.gather_from(each, |s| s.held_m3),
            compressed: like.gather_from(each, |s| s.compressed),
            q2_m3_s: like.gather_from(each, |s| s.q2_m3_s),
            shear: [
                like.gather_from(each, |s| s.shear[0]),
                like.gather_from(each, |s| s.shear[1]),
            ],
            heat_j: [
                like.gather_from(each, |s| s.heat_j[0]),
                like.gather_from(each, |s| s.heat_j[1]),
            ],
            laws: LawMemory::side_by_side(each, |state| &state.laws, like),
        }
    }
}

impl<N: Number> State<N> {
    /// What stands in a lane.
    #[inline(always)]
    pub fn part(&self, lane: usize) -> State {
        let gas = |i: usize| GasState {
            volume_m3: self.gas[i].volume_m3.lane(lane),
            temperature_k: self.gas[i].temperature_k.lane(lane),
        };
        State {
            p1_pa: self.p1_pa.lane(lane),
            gas: [gas(0), gas(1)],
            held_m3: self.held_m3.lane(lane),
            compressed: self.compressed.lane(lane),
            q2_m3_s: self.q2_m3_s.lane(lane),
            shear: [self.shear[0].lane(lane), self.shear[1].lane(lane)],
            heat_j: [self.heat_j[0].lane(lane), self.heat_j[1].lane(lane)],
            laws: self.laws.part(lane),
        }
    }

    /// `self + weight (other - self)`, state by state: the recombination that the stages of a Runge-Kutta step need. What laws without a name
    /// remember is left as it is without `LAWS`.
    #[inline(always)]
    pub fn blend<const LAWS: bool>(&self, other: &Self, weight: f64) -> Self {
        Self {
            p1_pa: mixed(self.p1_pa, other.p1_pa, weight),
            gas: [
                mixed_gas(self.gas[0], other.gas[0], weight),
                mixed_gas(self.gas[1], other.gas[1], weight),
            ],
            held_m3: mixed(self.held_m3, other.held_m3, weight),
            compressed: mixed(self.compressed, other.compressed, weight),
            q2_m3_s: mixed(self.q2_m3_s, other.q2_m3_s, weight),
            shear: both_mixed(self.shear, other.shear, weight),
            heat_j: both_mixed(self.heat_j, other.heat_j, weight),
            laws: if LAWS {
                self.laws.blend(&other.laws, weight)
            } else {
                self.laws
            },
        }
    }
}

#[inline(always)]
fn mixed<N: Number>(a: N, b: N, weight: f64) -> N {
    a + (b - a) * weight
}

#[inline(always)]
fn both_mixed<N: Number>([a1, a2]: [N; 2], [b1, b2]: [N; 2], weight: f64) -> [N; 2] {
    [mixed(a1, b1, weight), mixed(a2, b2, weight)]
}

#[inline(always)]
fn mixed_gas<N: Number>(a: GasState<N>, b: GasState<N>, weight: f64) -> GasState<N> {
    GasState {
        volume_m3: mixed(a.volume_m3, b.volume_m3, weight),
        temperature_k: mixed(a.temperature_k, b.temperature_k, weight),
    }
}
