//! The manoeuvres by name, and which settings each of them has.

use strum::{EnumString, IntoStaticStr, VariantArray, VariantNames};

/// What is driven, by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, EnumString, IntoStaticStr, VariantNames, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum ManoeuvreKind {
    /// Straight ahead at constant speed.
    Straight,
    /// ISO 3888-1, severe double lane change.
    LaneChange,
    /// ISO 3888-2, obstacle avoidance.
    #[strum(serialize = "lane-change-2")]
    LaneChange2,
    /// ISO 4138, circle at slowly rising speed.
    ConstantRadius,
    /// ISO 7401, step of steer.
    StepSteer,
    /// Braking straight ahead to a stop.
    Braking,
    /// ISO 7975, braking in a bend with the steering wheel held.
    BrakingInBend,
    /// Acceleration straight ahead.
    Acceleration,
}

impl ManoeuvreKind {
    /// Name in files and on the command line: `lane-change`, for example.
    pub fn key(self) -> &'static str {
        self.into()
    }

    /// Name in reports.
    pub fn title(self) -> &'static str {
        match self {
            Self::Straight => "Straight ahead",
            Self::LaneChange => "Severe double lane change, ISO 3888-1",
            Self::LaneChange2 => "Obstacle avoidance, ISO 3888-2",
            Self::ConstantRadius => "Constant radius, ISO 4138",
            Self::StepSteer => "Step of steer, ISO 7401",
            Self::Braking => "Braking straight ahead",
            Self::BrakingInBend => "Braking in a bend, ISO 7975",
            Self::Acceleration => "Acceleration straight ahead",
        }
    }

    /// Speed at which it is driven where nobody says another, km/h. In a circle this is the speed at the end.
    pub fn usual_speed_km_h(self) -> f64 {
        match self {
            Self::BrakingInBend | Self::Acceleration => 40.0,
            _ => 60.0,
        }
    }

    /// Whether it has cones to drive between.
    pub(super) fn has_cones(self) -> bool {
        matches!(self, Self::LaneChange | Self::LaneChange2)
    }

    /// Whether it goes round a circle.
    pub(super) fn has_radius(self) -> bool {
        matches!(self, Self::ConstantRadius | Self::BrakingInBend)
    }

    /// Whether the brake or the accelerator is part of it.
    pub(super) fn has_pedal(self) -> bool {
        matches!(self, Self::Braking | Self::BrakingInBend | Self::Acceleration)
    }

    /// Whether steering wheel or pedal is moved at a set time.
    pub(super) fn has_begin(self) -> bool {
        self == Self::StepSteer || self.has_pedal()
    }

    /// Whether the two drivers take it differently: both keep to a circle in the same way, and neither steers in a step of steer.
    pub(super) fn has_driver(self) -> bool {
        !self.has_radius() && self != Self::StepSteer
    }
}
