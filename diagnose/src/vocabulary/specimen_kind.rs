//! The kinds of specimen, as `specimen.kind` of a model file names them.

use strum::{Display, EnumString, IntoStaticStr, VariantArray};

/// A kind of specimen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Display, EnumString, IntoStaticStr, VariantArray)]
pub enum SpecimenKind {
    /// Hydropneumatic strut with two accumulators, two dampers and three valves, on a test rig.
    #[strum(serialize = "two-stage hydropneumatic strut")]
    TwoStageStrut,
    /// One chamber of gas behind a piston.
    #[strum(serialize = "gas spring")]
    GasSpring,
    /// Chambers under pressure that is measured, and the force of the rod.
    #[strum(serialize = "cylinder")]
    Cylinder,
    /// Damper that is moved by a dynamometer, and its force.
    #[strum(serialize = "damper")]
    Damper,
    /// Carriage that is pushed by a measured force, and its position.
    #[strum(serialize = "drive")]
    Drive,
    /// Somebody else's model, whatever it is of. No model file has this kind: the model is an FMU, and a map says what it is compared with.
    #[strum(serialize = "co-simulation model")]
    CoSimulation,
}

impl SpecimenKind {
    /// The text in a model file.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        self.into()
    }
}
