//! What laws without a name remember of the two paths.

use serde::{Deserialize, Serialize};

use crate::lanes::Number;

/// The memories of the laws of both paths. Where no law has one they stay as they are at rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(in crate::strut) struct LawMemory<N = f64> {
    /// Means of the gas volumes over the static ones, over the time constants of the laws.
    pub mean_volume: [N; 2],
    /// Energy that the gas holds of what compressed it, over its static pressure times its static volume.
    pub gas_energy: [N; 2],
    /// Energy that the oil of the packs holds of what was lost in them, J.
    pub pack_j: [N; 2],
}

impl LawMemory {
    /// At rest, with the gas volumes over the static ones.
    pub fn at_rest(relative_volume: [f64; 2]) -> Self {
        Self {
            mean_volume: relative_volume,
            gas_energy: [0.0; 2],
            pack_j: [0.0; 2],
        }
    }

    /// Those of several things side by side, `like` any number of their kind.
    #[inline(always)]
    pub fn side_by_side<T, N: Number>(each: &[&T], memory: impl Fn(&T) -> &Self + Copy, like: N) -> LawMemory<N> {
        let both =
            |of: fn(&Self) -> [f64; 2]| [0, 1].map(|path| like.gather_from(each, |thing| of(memory(thing))[path]));
        LawMemory {
            mean_volume: both(|memory| memory.mean_volume),
            gas_energy: both(|memory| memory.gas_energy),
            pack_j: both(|memory| memory.pack_j),
        }
    }
}

impl<N: Number> LawMemory<N> {
    /// What stands in a lane.
    #[inline(always)]
    pub fn part(&self, lane: usize) -> LawMemory {
        let of = |both: [N; 2]| both.map(|one| one.lane(lane));
        LawMemory {
            mean_volume: of(self.mean_volume),
            gas_energy: of(self.gas_energy),
            pack_j: of(self.pack_j),
        }
    }

    /// `self + weight (other - self)`.
    #[inline(always)]
    pub fn blend(&self, other: &Self, weight: f64) -> Self {
        let mixed = |[a1, a2]: [N; 2], [b1, b2]: [N; 2]| [a1 + (b1 - a1) * weight, a2 + (b2 - a2) * weight];
        Self {
            mean_volume: mixed(self.mean_volume, other.mean_volume),
            gas_energy: mixed(self.gas_energy, other.gas_energy),
            pack_j: mixed(self.pack_j, other.pack_j),
        }
    }
}
