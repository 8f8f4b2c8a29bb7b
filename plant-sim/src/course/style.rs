//! The two drivers, of whom one demands more of the vehicle than the other.

use strum::{EnumString, IntoStaticStr, VariantArray};

use super::track::LaneChangeLine;

/// How a driver takes a manoeuvre.
#[derive(Debug, Clone, Copy, PartialEq, Eq, IntoStaticStr, EnumString, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum DriverStyle {
    /// The report's driver (preview, pure pursuit) on a line that is eased into the lanes. Cuts corners and asks for about half
    /// of what the manoeuvre can ask for.
    Eased,
    /// A driver who knows the car (optimal preview control) on the line of hard left and hard right.
    Hard,
}

impl DriverStyle {
    /// Name in files and on the command line: `eased` or `hard`.
    pub fn key(self) -> &'static str {
        self.into()
    }

    /// Line of this driver between lanes.
    pub fn lane_change_line(self) -> LaneChangeLine {
        match self {
            Self::Eased => LaneChangeLine::Eased,
            Self::Hard => LaneChangeLine::Hard,
        }
    }
}
