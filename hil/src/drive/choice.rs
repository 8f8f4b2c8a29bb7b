//! What can be chosen of a drive by name: manoeuvre, model of the vehicle, suspension.

use oleo_plant_sim::course::ManoeuvreKind;
use strum::{EnumString, IntoStaticStr, VariantArray};

/// The manoeuvres that can be driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq, EnumString, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum Kind {
    /// Straight ahead over Belgian block.
    Belgian,
    /// Straight ahead over an APG obstacle under the left wheels.
    Bump,
    /// Severe double lane change, ISO 3888-1.
    LaneChange,
    /// Obstacle avoidance, ISO 3888-2.
    #[strum(serialize = "lane-change-2")]
    LaneChange2,
    /// Steady circle at slowly rising speed, ISO 4138.
    ConstantRadius,
    /// Step of the steer angle, ISO 7401.
    StepSteer,
    /// Straight ahead over any road.
    Straight,
    /// Braking straight ahead to a stop.
    Braking,
    /// Braking in a bend with the steering wheel held, ISO 7975.
    BrakingInBend,
    /// Acceleration straight ahead.
    Acceleration,
}

impl Kind {
    /// Name by which it is chosen.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// What is driven, in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Belgian => "Straight ahead over Belgian block",
            Self::Bump => "Straight ahead over an APG obstacle under the left wheels",
            Self::LaneChange => "Severe double lane change, ISO 3888-1",
            Self::LaneChange2 => "Obstacle avoidance, ISO 3888-2",
            Self::ConstantRadius => "Steady circle at slowly rising speed, ISO 4138",
            Self::StepSteer => "Step of the steer angle, ISO 7401",
            Self::Straight => "Straight ahead over the road that is given",
            Self::Braking => "Braking straight ahead to a stop",
            Self::BrakingInBend => "Braking in a bend with the steering wheel held, ISO 7975",
            Self::Acceleration => "Acceleration straight ahead",
        }
    }

    /// Needs the handling model: steering, brakes or drive.
    pub fn steers(self) -> bool {
        !matches!(self, Self::Belgian | Self::Bump | Self::Straight)
    }

    /// What is driven; the first two are straight drives over roads of their own.
    pub fn manoeuvre(self) -> ManoeuvreKind {
        match self {
            Self::Belgian | Self::Bump | Self::Straight => ManoeuvreKind::Straight,
            Self::LaneChange => ManoeuvreKind::LaneChange,
            Self::LaneChange2 => ManoeuvreKind::LaneChange2,
            Self::ConstantRadius => ManoeuvreKind::ConstantRadius,
            Self::StepSteer => ManoeuvreKind::StepSteer,
            Self::Braking => ManoeuvreKind::Braking,
            Self::BrakingInBend => ManoeuvreKind::BrakingInBend,
            Self::Acceleration => ManoeuvreKind::Acceleration,
        }
    }

    /// The road that it has, whatever others are given.
    pub fn own_road(self) -> Option<&'static str> {
        match self {
            Self::Belgian => Some("belgian"),
            Self::Bump => Some("apg-left"),
            _ => None,
        }
    }

    /// Heading of the report.
    pub fn title(self) -> &'static str {
        match self {
            Self::Belgian => "Belgian block",
            Self::Bump => "APG obstacle, left wheels",
            _ => self.manoeuvre().title(),
        }
    }
}

/// Model of the vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, EnumString, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum Model {
    /// Ride model of the report's appendix A, seven degrees of freedom.
    Ride,
    /// Handling model with tyres and driver, fourteen degrees of freedom.
    Handling,
    /// Both models, compared.
    Both,
}

impl Model {
    /// Name by which it is chosen.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// What it is, in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Ride => "Ride model of the report's appendix A, seven degrees of freedom",
            Self::Handling => "Handling model with tyres and driver, fourteen degrees of freedom",
            Self::Both => "Both models, compared",
        }
    }
}

/// Suspension of the vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, EnumString, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum Setting {
    /// Hydropneumatic struts with all valves open.
    Soft,
    /// Hydropneumatic struts with all valves closed.
    Stiff,
    /// Hydropneumatic struts whose valves the controller sets every 5 ms.
    Controlled,
    /// Coil springs and dampers of the production vehicle.
    Baseline,
}

impl Setting {
    /// Name by which it is chosen.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// What it is, in words.
    pub fn description(self) -> &'static str {
        match self {
            Self::Soft => "Hydropneumatic struts with all valves open",
            Self::Stiff => "Hydropneumatic struts with all valves closed",
            Self::Controlled => "Hydropneumatic struts whose valves the controller sets every 5 ms",
            Self::Baseline => "Coil springs and dampers of the production vehicle",
        }
    }

    /// What the vehicle drives with, in a sentence.
    pub fn words(self) -> &'static str {
        match self {
            Self::Soft => "all valves open",
            Self::Stiff => "all valves closed",
            Self::Controlled => "the controller",
            Self::Baseline => "coil springs",
        }
    }
}
