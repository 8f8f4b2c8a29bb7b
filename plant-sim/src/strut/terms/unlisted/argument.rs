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
    /// Gauge pressure p1 of the main chamber, Pa.
    P1,
    /// Flow of the path, m3/s, out of the main chamber positive.
    Flow,
    /// Pressure drop across the pack, Pa; across a valve its size, without the sign.
    PressureDrop,
    /// Gas volume over the one at static pressure.
    RelativeVolume,
}
