//! Arguments of `oleo drive`: the manoeuvre, the model of the vehicle and its suspension.

use std::path::PathBuf;

use clap::ValueEnum;
use strum::IntoStaticStr;

/// Drive the vehicle through a manoeuvre and report its motion, comfort and handling.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  oleo drive --manoeuvre lane-change --speed-km-h 60 --setting controlled --out lane\n  \
                  oleo drive --manoeuvre belgian --model both --setting baseline --out figures-2-to-5\n  \
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
    /// Speed, km/h [default: 60, bump 5; constant-radius: speed at the end]
    #[arg(long, value_name = "KM_H", allow_negative_numbers = true)]
    pub speed_km_h: Option<f64>,
    /// Road for `straight`: belgian, apg-left, apg-right, apg-both, iso-a .. iso-f, flat, or a .crg or .csv file
    #[arg(long, value_name = "ROAD", default_value = "flat")]
    pub road: String,
    /// Time to drive, s [default: 20; lane changes end behind the last cones]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub duration_s: Option<f64>,
    /// Radius of constant-radius, m, positive to the left
    #[arg(long, value_name = "M", default_value_t = 40.0, allow_negative_numbers = true)]
    pub radius_m: f64,
    /// Steer angle of step-steer at the road wheels, degrees, positive to the left
    #[arg(long, value_name = "DEG", default_value_t = 2.0, allow_negative_numbers = true)]
    pub steer_deg: f64,
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
