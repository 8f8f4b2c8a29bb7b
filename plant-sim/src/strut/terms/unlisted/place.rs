//! Where an unmodelled law acts, and what its number does there.

use serde::{Deserialize, Serialize};

use super::argument::LawArgument;
use crate::strut::flow_path::FlowPath;
use crate::strut::terms::COLUMNS;

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
    /// Beside valve 3: a flow coefficient, m3/s/sqrt(Pa).
    #[serde(rename = "beside-valve-3")]
    BesideValve3,
    /// Every valve: a time that is added to its response, s.
    ValveTiming,
    /// Every valve: the time that its movement takes, s, 95 % of which is done when the response is over.
    ValveMovement,
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
    /// Accumulator 1: a factor on its gas pressure; over the density the compressibility factor of its gas.
    #[serde(rename = "accumulator-1")]
    Accumulator1,
    /// Accumulator 2: the same.
    #[serde(rename = "accumulator-2")]
    Accumulator2,
    /// Both accumulators: the same of each.
    #[serde(rename = "accumulator-1..2")]
    Accumulators,
    /// Floating piston of accumulator 1: the level of a friction against its motion, Pa.
    #[serde(rename = "accumulator-1-friction")]
    Accumulator1Friction,
    /// Floating piston of accumulator 2: the same.
    #[serde(rename = "accumulator-2-friction")]
    Accumulator2Friction,
    /// Mount: by how much it yields, m.
    Mount,
    /// Instrument of the displacement: what it adds to the truth, m.
    #[serde(rename = "sensor:displacement_m")]
    InstrumentDisplacement,
    /// Load cell: the same, N.
    #[serde(rename = "sensor:force_N")]
    InstrumentForce,
    /// Instrument of p1: the same, Pa.
    #[serde(rename = "sensor:p1_Pa")]
    InstrumentP1,
    /// Instrument of p2: the same.
    #[serde(rename = "sensor:p2_Pa")]
    InstrumentP2,
    /// Instrument of p3: the same.
    #[serde(rename = "sensor:p3_Pa")]
    InstrumentP3,
    /// Instrument of p4: the same.
    #[serde(rename = "sensor:p4_Pa")]
    InstrumentP4,
}

/// The instruments, in the order of the columns.
const INSTRUMENTS: [LawPlace; 6] = [
    LawPlace::InstrumentDisplacement,
    LawPlace::InstrumentForce,
    LawPlace::InstrumentP1,
    LawPlace::InstrumentP2,
    LawPlace::InstrumentP3,
    LawPlace::InstrumentP4,
];

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
                LawArgument::Phase,
            ],
            Self::MainSealFriction => &[
                LawArgument::Displacement,
                LawArgument::Speed,
                LawArgument::P1,
                LawArgument::Time,
                LawArgument::Phase,
            ],
            Self::MainChamber => &[LawArgument::P1],
            Self::MainChamberLoss => &[LawArgument::P1, LawArgument::Time, LawArgument::Phase],
            Self::Path1 => &[LawArgument::Flow],
            Self::Path2 => &[LawArgument::Flow, LawArgument::FlowRate],
            Self::BesidePack1 | Self::BesidePack2 => {
                &[LawArgument::PressureDrop, LawArgument::Displacement, LawArgument::Time]
            }
            Self::Pack1 | Self::Pack2 => &[
                LawArgument::Displacement,
                LawArgument::Energy,
                LawArgument::Time,
                LawArgument::Phase,
            ],
            Self::Valve1 | Self::Valve2 | Self::Valve3 | Self::Valves => {
                &[LawArgument::PressureDrop, LawArgument::Phase]
            }
            Self::BesideValve3 => &[LawArgument::Displacement, LawArgument::Time],
            Self::ValveTiming | Self::ValveMovement => &[LawArgument::PressureDrop],
            Self::Accumulator1 | Self::Accumulator2 | Self::Accumulators => &[
                LawArgument::RelativeVolume,
                LawArgument::RelativeDensity,
                LawArgument::VolumeChange,
                LawArgument::RelativeEnergy,
                LawArgument::Time,
                LawArgument::Phase,
            ],
            Self::Accumulator1Friction | Self::Accumulator2Friction => &[LawArgument::RelativeVolume],
            Self::Mount => &[LawArgument::Force],
            // Nothing that was lost in a memory can be taken back, and the displacement is an input.
            Self::InstrumentDisplacement => &[
                LawArgument::Reading,
                LawArgument::Time,
                LawArgument::Phase,
                LawArgument::ReadingRate,
            ],
            Self::InstrumentForce
            | Self::InstrumentP1
            | Self::InstrumentP2
            | Self::InstrumentP3
            | Self::InstrumentP4 => &[
                LawArgument::Reading,
                LawArgument::Time,
                LawArgument::Phase,
                LawArgument::ReadingRate,
                LawArgument::ReadingChange,
            ],
        }
    }

    /// What the value of a law at this place does, given what it depends on.
    #[must_use]
    pub fn form(self, argument: LawArgument) -> LawForm {
        match self {
            Self::MainSeal | Self::MainSealFriction | Self::MainChamberLoss => LawForm::Added,
            Self::BesideValve3 | Self::ValveTiming | Self::ValveMovement => LawForm::Added,
            Self::Accumulator1Friction | Self::Accumulator2Friction => LawForm::Added,
            Self::InstrumentDisplacement
            | Self::InstrumentForce
            | Self::InstrumentP1
            | Self::InstrumentP2
            | Self::InstrumentP3
            | Self::InstrumentP4 => LawForm::Added,
            Self::MainChamber | Self::Mount | Self::Path1 | Self::Path2 => LawForm::AddedNotFalling,
            Self::BesidePack1 | Self::BesidePack2 if argument == LawArgument::PressureDrop => LawForm::AddedNotFalling,
            // A groove: its size may change with displacement or time as it likes.
            Self::BesidePack1 | Self::BesidePack2 => LawForm::Added,
            Self::Pack1 | Self::Pack2 | Self::Accumulator1 | Self::Accumulator2 | Self::Accumulators => LawForm::Factor,
            Self::Valve1 | Self::Valve2 | Self::Valve3 | Self::Valves => LawForm::Factor,
        }
    }

    /// The instrument behind a column of a strut's recording.
    pub(super) fn instrument(column: &str) -> Option<Self> {
        INSTRUMENTS.into_iter().find(|place| place.column() == Some(column))
    }

    /// The column that the instrument at this place records; `None` for a place of the strut.
    pub(in crate::strut::terms) fn column(self) -> Option<&'static str> {
        let at = INSTRUMENTS.iter().position(|place| *place == self)?;
        COLUMNS.get(at).copied()
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

    /// The floating piston at the end of a path.
    pub(super) fn piston(path: FlowPath) -> Self {
        path.pick(Self::Accumulator1Friction, Self::Accumulator2Friction)
    }

    /// Whether the place is the seal of a floating piston.
    pub(super) fn is_floating_piston(self) -> bool {
        matches!(self, Self::Accumulator1Friction | Self::Accumulator2Friction)
    }

    /// The accumulator at the end of a path.
    pub(super) fn accumulator(path: FlowPath) -> Self {
        path.pick(Self::Accumulator1, Self::Accumulator2)
    }
}
