//! Arguments of `oleo drive`: the manoeuvre with its road and driver, the model of the vehicle and its suspension.

use std::path::PathBuf;

use clap::ValueEnum;
use oleo_plant_sim::course::ManoeuvreKind;
use strum::IntoStaticStr;

use crate::commands::course_arguments::CourseArgs;
use crate::results::ResultsArgs;

/// Drive the vehicle through a manoeuvre and report its motion, comfort and handling, with one suspension or several.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  oleo drive --manoeuvre lane-change --speed-km-h 60 --setting controlled --out lane\n  \
                  oleo drive --manoeuvre lane-change-2 --setting soft,stiff,controlled,baseline --out four\n  \
                  oleo drive --manoeuvre belgian --model both --setting baseline --out figures-2-to-5\n  \
                  oleo drive --manoeuvre lane-change --road iso-d --driver hard --load laden --setting baseline\n  \
                  oleo drive --manoeuvre straight --side-slope-percent 10 --setting soft\n  \
                  oleo drive --manoeuvre belgian --gas-temperature-c -20 --setting soft\n  \
                  oleo drive --manoeuvre bump --speed-km-h 10 --model both --setting baseline\n\n\
                  Steer angle, yaw rate and lateral values are positive to the left. Roll is positive with the left side up, pitch \
                  with the nose down."
)]
pub struct Args {
    /// Manoeuvre to drive
    #[arg(long, value_enum)]
    pub manoeuvre: Kind,
    /// Vehicle model; both runs the two models on the same road and compares them
    #[arg(long, value_enum, default_value_t = Model::Handling)]
    pub model: Model,
    /// Suspension of the vehicle; several, separated by commas, are driven one by one and compared
    #[arg(long, value_enum, value_delimiter = ',', default_value = "controlled")]
    pub setting: Vec<Setting>,
    /// Speed, km/h; in constant-radius the speed at the end [default: 5 for bump, 40 for braking-in-bend and acceleration,
    /// otherwise 60]
    #[arg(long, value_name = "KM_H", allow_negative_numbers = true)]
    pub speed_km_h: Option<f64>,
    /// Road: belgian, apg-left, apg-right, apg-both, iso-a .. iso-f, flat, or a .crg or .csv file [default: flat; the manoeuvres
    /// belgian and bump have a road of their own]
    #[arg(long, value_name = "ROAD")]
    pub road: Option<String>,
    #[command(flatten)]
    pub course: CourseArgs,
    /// Gas temperature of the struts, degrees Celsius; the struts were charged at 20 [default: 20]
    #[arg(long, value_name = "CELSIUS", allow_negative_numbers = true)]
    pub gas_temperature_c: Option<f64>,
    /// Simulated time, s [default: 20; lane changes end behind the last cones, and with a time they continue straight ahead]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub duration_s: Option<f64>,
    /// Time at the start that is left out of the comfort measures, s
    #[arg(long, value_name = "S", default_value_t = 1.0, allow_negative_numbers = true)]
    pub score_from_s: f64,
    /// Seed of random roads
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// File of vehicle parameters [default: the built-in defender110]
    #[arg(long, value_name = "VEHICLE.toml")]
    pub vehicle: Option<PathBuf>,
    /// File of handling parameters [default: the built-in defender110]
    #[arg(long, value_name = "HANDLING.toml")]
    pub handling: Option<PathBuf>,
    /// Strut model, such as the model.toml that oleo diagnose writes; it is charged for the load that it carries [default: the
    /// built-in defender110]
    #[arg(long, value_name = "MODEL.toml")]
    pub strut: Option<PathBuf>,
    #[command(flatten)]
    pub results: ResultsArgs,
}

/// The manoeuvres that can be driven.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// Straight ahead over Belgian block
    Belgian,
    /// Straight ahead over an APG obstacle under the left wheels
    Bump,
    /// Severe double lane change, ISO 3888-1
    LaneChange,
    /// Obstacle avoidance, ISO 3888-2
    #[value(name = "lane-change-2")]
    LaneChange2,
    /// Steady circle at slowly rising speed, ISO 4138
    ConstantRadius,
    /// Step of the steer angle, ISO 7401
    StepSteer,
    /// Straight ahead over the road given by --road
    Straight,
    /// Braking straight ahead to a stop
    Braking,
    /// Braking in a bend with the steering wheel held, ISO 7975
    BrakingInBend,
    /// Acceleration straight ahead
    Acceleration,
}

impl Kind {
    /// As on the command line.
    pub fn name(self) -> String {
        self.to_possible_value()
            .map_or(String::new(), |value| value.get_name().to_owned())
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
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Model {
    /// Ride model of the report's appendix A, seven degrees of freedom
    Ride,
    /// Handling model with tyres and driver, fourteen degrees of freedom
    Handling,
    /// Both models, compared
    Both,
}

impl Model {
    /// As on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ride => "ride",
            Self::Handling => "handling",
            Self::Both => "both",
        }
    }
}

/// Suspension of the vehicle.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum, IntoStaticStr)]
#[strum(serialize_all = "kebab-case")]
pub enum Setting {
    /// Hydropneumatic struts with all valves open
    Soft,
    /// Hydropneumatic struts with all valves closed
    Stiff,
    /// Hydropneumatic struts whose valves the controller sets every 5 ms
    Controlled,
    /// Coil springs and dampers of the production vehicle
    Baseline,
}

impl Setting {
    /// As on the command line.
    pub fn name(self) -> &'static str {
        self.into()
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
