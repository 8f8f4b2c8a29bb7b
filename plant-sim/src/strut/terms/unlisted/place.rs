//! Where an unmodelled law acts, and what its number does there.

use serde::{Deserialize, Serialize};

use super::argument::LawArgument;
use crate::strut::flow_path::FlowPath;

/// Where an unmodelled law acts. The place fixes what the law's value is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LawPlace {
    /// Between rod and cylinder: a force, N.
    MainSeal,
    /// Between rod and cylinder: the level of a friction against the motion, N.
    MainSealFriction,
    /// Main chamber: volume that it takes up and gives back, m3.
    MainChamber,
    /// Main chamber: flow that leaves it and does not come back, m3/s.
    MainChamberLoss,
    /// In series with path 1: a pressure drop, Pa.
    #[serde(rename = "path-1")]
    Path1,
    /// In series with path 2: a pressure drop, Pa.
    #[serde(rename = "path-2")]
    Path2,
    /// Beside damper pack 1: a flow, m3/s, over the pressure drop; a flow coefficient, m3/s/sqrt(Pa), over displacement or time.
    #[serde(rename = "beside-pack-1")]
    BesidePack1,
    /// Beside damper pack 2: the same.
    #[serde(rename = "beside-pack-2")]
    BesidePack2,
    /// Damper pack 1: a factor on its pressure drop.
    #[serde(rename = "pack-1")]
    Pack1,
    /// Damper pack 2: a factor on its pressure drop.
    #[serde(rename = "pack-2")]
    Pack2,
    /// Valve 1: a factor on its flow.
    #[serde(rename = "valve-1")]
    Valve1,
    /// Valve 2: a factor on its flow.
    #[serde(rename = "valve-2")]
    Valve2,
    /// Valve 3: a factor on its flow.
    #[serde(rename = "valve-3")]
    Valve3,
    /// Every valve: a factor on its flow.
    #[serde(rename = "valve-1..3")]
    Valves,
    /// Accumulator 1: a factor on its gas pressure.
    #[serde(rename = "accumulator-1")]
    Accumulator1,
    /// Accumulator 2: a factor on its gas pressure.
    #[serde(rename = "accumulator-2")]
    Accumulator2,
}

/// What the value of a law does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LawForm {
    /// It is added to what the model has: a force, a friction, a flow.
    Added,
    /// It is added and must not fall while its argument rises: a compliance, a resistance or a leak that did would push
    /// by itself, and the network would have no solution.
    AddedNotFalling,
    /// It multiplies what the model has: a damper's drop, a valve's flow, a gas pressure.
    Factor,
}

impl LawPlace {
    /// The quantities that a law at this place may depend on. The solver reads no others.
    #[must_use]
    pub fn arguments(self) -> &'static [LawArgument] {
        match self {
            Self::MainSeal => &[
                LawArgument::Displacement,
                LawArgument::Speed,
                LawArgument::P1,
                LawArgument::Acceleration,
                LawArgument::Time,
            ],
            Self::MainSealFriction => &[
                LawArgument::Displacement,
                LawArgument::Speed,
                LawArgument::P1,
                LawArgument::Time,
            ],
            Self::MainChamber => &[LawArgument::P1],
            Self::MainChamberLoss => &[LawArgument::P1, LawArgument::Time],
            Self::Path1 | Self::Path2 => &[LawArgument::Flow],
            Self::BesidePack1 | Self::BesidePack2 => {
                &[LawArgument::PressureDrop, LawArgument::Displacement, LawArgument::Time]
            }
            Self::Pack1 | Self::Pack2 => &[LawArgument::Displacement, LawArgument::Time],
            Self::Valve1 | Self::Valve2 | Self::Valve3 | Self::Valves => &[LawArgument::PressureDrop],
            Self::Accumulator1 | Self::Accumulator2 => &[LawArgument::RelativeVolume, LawArgument::Time],
        }
    }

    /// What the value of a law at this place does, given what it depends on.
    #[must_use]
    pub fn form(self, argument: LawArgument) -> LawForm {
        match self {
            Self::MainSeal | Self::MainSealFriction | Self::MainChamberLoss => LawForm::Added,
            Self::MainChamber | Self::Path1 | Self::Path2 => LawForm::AddedNotFalling,
            Self::BesidePack1 | Self::BesidePack2 if argument == LawArgument::PressureDrop => LawForm::AddedNotFalling,
            // A groove: its size may change with displacement or time as it likes.
            Self::BesidePack1 | Self::BesidePack2 => LawForm::Added,
            Self::Pack1 | Self::Pack2 | Self::Accumulator1 | Self::Accumulator2 => LawForm::Factor,
            Self::Valve1 | Self::Valve2 | Self::Valve3 | Self::Valves => LawForm::Factor,
        }
    }

    /// Whether only one law may act here, whatever it depends on. Everywhere else there may be one for each argument.
    #[must_use]
    pub fn holds_one_law(self) -> bool {
        matches!(self, Self::MainSeal | Self::MainSealFriction)
    }

    /// The place in series with a path.
    pub(super) fn in_series(path: FlowPath) -> Self {
        path.pick(Self::Path1, Self::Path2)
    }

    /// The place beside the damper pack of a path.
    pub(super) fn beside_pack(path: FlowPath) -> Self {
        path.pick(Self::BesidePack1, Self::BesidePack2)
    }

    /// The damper pack of a path.
    pub(super) fn pack(path: FlowPath) -> Self {
        path.pick(Self::Pack1, Self::Pack2)
    }

    /// The accumulator at the end of a path.
    pub(super) fn accumulator(path: FlowPath) -> Self {
        path.pick(Self::Accumulator1, Self::Accumulator2)
    }
}
