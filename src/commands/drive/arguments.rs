//! Arguments of `oleo drive`: the manoeuvre with its road and driver, the model of the vehicle and its suspension.

use std::path::PathBuf;

use clap::ValueEnum;
use oleo_plant_sim::course::ManoeuvreKind;
use strum::IntoStaticStr;

use crate::commands::course_arguments::CourseArgs;

/// Drive the vehicle through a manoeuvre and report its motion, comfort and handling.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  oleo drive --manoeuvre lane-change --speed-km-h 60 --setting controlled --out lane\n  \
                  oleo drive --manoeuvre belgian --model both --setting baseline --out figures-2-to-5\n  \
                  oleo drive --manoeuvre lane-change --road iso-d --driver hard --load laden --setting baseline\n  \
                  oleo drive --manoeuvre straight --side-slope-percent 10 --setting soft\n  \
                  oleo drive --manoeuvre belgian --gas-temperature-c -20 --setting soft\n  \
                  oleo drive --manoeuvre bump --speed-km-h 10 --model both --setting baseline\n\n\
                  Steer, yaw and lateral values are positive to the left, roll with the left side up, pitch with the nose down."
)]
pub struct Args {
    /// What to drive
    #[arg(long, value_enum)]
    pub manoeuvre: Kind,
    /// Model of the vehicle; `both` compares them on the same road
    #[arg(long, value_enum, default_value_t = Model::Handling)]
    pub model: Model,
    /// Suspension: struts with all valves open, all closed, under the controller, or the coil springs of the vehicle as sold
    #[arg(long, value_enum, default_value_t = Setting::Controlled)]
    pub setting: Setting,
    /// Speed, km/h [default: 60, bump 5, braking in a bend and acceleration 40; constant-radius: speed at the end]
    #[arg(long, value_name = "KM_H", allow_negative_numbers = true)]
    pub speed_km_h: Option<f64>,
    /// Road: belgian, apg-left, apg-right, apg-both, iso-a .. iso-f, flat, or a .crg or .csv file [default: flat; belgian and
    /// bump have their own]
    #[arg(long, value_name = "ROAD")]
    pub road: Option<String>,
    #[command(flatten)]
    pub course: CourseArgs,
    /// Temperature of the struts' gas, degrees Celsius; they were charged at 20
    #[arg(long, value_name = "CELSIUS", allow_negative_numbers = true)]
    pub gas_temperature_c: Option<f64>,
    /// Time to drive, s [default: 20; lane changes end behind the last cones; with a time they go on straight ahead]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub duration_s: Option<f64>,
    /// Time at the start that does not count for comfort, s
    #[arg(long, value_name = "S", default_value_t = 1.0, allow_negative_numbers = true)]
    pub score_from_s: f64,
    /// Phases of random roads
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Vehicle parameters; without it the built-in defender110
    #[arg(long, value_name = "VEHICLE.toml")]
    pub vehicle: Option<PathBuf>,
    /// Handling parameters; without it the built-in defender110
    #[arg(long, value_name = "HANDLING.toml")]
    pub handling: Option<PathBuf>,
    /// Folder for CSV data, summary.json and report.html; without it only the table is printed
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// What to drive.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// Belgian block, straight ahead
    Belgian,
    /// APG obstacle under the left wheels
    Bump,
    /// ISO 3888-1, severe double lane change
    LaneChange,
    /// ISO 3888-2, obstacle avoidance
    #[value(name = "lane-change-2")]
    LaneChange2,
    /// ISO 4138, circle at slowly rising speed
    ConstantRadius,
    /// ISO 7401, step of steer
    StepSteer,
    /// Straight over any road
    Straight,
    /// Braking straight ahead to a stop
    Braking,
    /// ISO 7975, braking in a bend with the steering wheel held
    BrakingInBend,
    /// Acceleration straight ahead
    Acceleration,
}

impl Kind {
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
    /// Appendix A, seven degrees of freedom
    Ride,
    /// Fourteen degrees of freedom with tyres and driver
    Handling,
    /// Both, compared
    Both,
}

/// Suspension of the vehicle.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum, IntoStaticStr)]
#[strum(serialize_all = "kebab-case")]
pub enum Setting {
    /// All valves open
    Soft,
    /// All valves closed
    Stiff,
    /// The controller decides every 5 ms
    Controlled,
    /// Coil springs and dampers of the vehicle as sold
    Baseline,
}

impl Setting {
    /// As on the command line.
    pub fn name(self) -> &'static str {
        self.into()
    }
}
