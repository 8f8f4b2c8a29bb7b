//! What an unmodelled law depends on.

use serde::{Deserialize, Serialize};

/// The quantity that an unmodelled law depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LawArgument {
    /// Displacement of the strut, m, compression positive.
    Displacement,
    /// Speed of the strut, m/s, compression positive.
    Speed,
    /// Acceleration of the strut, m/s2, compression positive.
    Acceleration,
    /// Time since the start, s: what leaks, warms or drifts.
    Time,
    /// Phase of an oscillation over time, turns, 0 to 1: time since the start by the frequency of the law, less whole turns.
    Phase,
    /// Gauge pressure p1 of the main chamber, Pa.
    P1,
    /// Flow of the path, m3/s, out of the main chamber positive.
    Flow,
    /// Rate at which the flow of the path changes, m3/s2. The law over it is a line through the origin, a mass of oil: two points.
    FlowRate,
    /// Pressure drop across the pack, Pa; across a valve its size, without the sign.
    PressureDrop,
    /// Density of the gas over the one at static pressure, the inverse of the relative volume. A law over it is an equation of state: its value is
    /// the compressibility factor at ambient temperature, the gas is warmed by its work as this equation says, and at rest it has the static
    /// pressure.
    RelativeDensity,
    /// Gas volume over the one at static pressure.
    RelativeVolume,
    /// The same less its mean over the time constant of the law (a first-order lag): what has changed lately. A law over it has a memory.
    VolumeChange,
    /// Energy held by the oil of a pack, J: what is lost in the pack, less what the oil loses over the time constant of the law. A law over it has a
    /// memory.
    Energy,
    /// Energy held by a gas, over its static pressure times its static volume: the work that compresses it, less what it loses over the time constant
    /// of the law. A law over it has a memory.
    RelativeEnergy,
    /// Force between strut and mount above the static one, N, compression positive.
    Force,
    /// Reading of the instrument, in the unit of its column.
    Reading,
    /// Rate at which the reading changes, in that unit a second.
    ReadingRate,
    /// The reading less its mean over the time constant of the law (a first-order lag), in that unit: what has changed lately. A law over it has a
    /// memory.
    ReadingChange,
}

impl LawArgument {
    /// Whether a law over this quantity has a memory, and with it a time constant.
    #[must_use]
    pub fn is_remembered(self) -> bool {
        matches!(
            self,
            Self::VolumeChange | Self::Energy | Self::RelativeEnergy | Self::ReadingChange
        )
    }
}
