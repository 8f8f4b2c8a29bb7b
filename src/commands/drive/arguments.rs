//! Arguments of `oleo drive`: the manoeuvre with its road and driver, the model of the vehicle and its suspension.

use std::path::PathBuf;

use oleo_hil::drive::{Kind, Model, Request, Setting};

use crate::commands::course_arguments::CourseArgs;
use crate::commands::mcap::McapArgs;
use crate::commands::word::described;
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
                  oleo drive --manoeuvre lane-change --setting soft,controlled --mcap drives.mcap\n  \
                  oleo drive --manoeuvre bump --speed-km-h 10 --model both --setting baseline\n\n\
                  Steer angle, yaw rate and lateral values are positive to the left. Roll is positive with the left side up, pitch \
                  with the nose down."
)]
pub struct Args {
    /// Manoeuvre to drive
    #[arg(long, value_name = "MANOEUVRE", value_parser = described(Kind::words))]
    pub manoeuvre: Kind,
    /// Vehicle model; both runs the two models on the same road and compares them
    #[arg(long, value_name = "MODEL", value_parser = described(Model::words), default_value = "handling")]
    pub model: Model,
    /// Suspension of the vehicle; several, separated by commas, are driven one by one and compared
    #[arg(long, value_name = "SETTING", value_parser = described(Setting::description), value_delimiter = ',', default_value = "controlled")]
    pub setting: Vec<Setting>,
    /// Speed, km/h; in constant-radius the speed at the end [default: 5 for bump, 40 for braking-in-bend and acceleration,
    /// otherwise 60]
    #[arg(long, alias = "speed", value_name = "KM_H", allow_negative_numbers = true)]
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
    #[arg(long, alias = "duration", value_name = "S", allow_negative_numbers = true)]
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
    pub mcap: McapArgs,
    #[command(flatten)]
    pub results: ResultsArgs,
}

impl Args {
    /// What is asked for.
    pub fn request(&self) -> Request {
        Request {
            manoeuvre: self.manoeuvre,
            model: self.model,
            setting: self.setting.clone(),
            speed_km_h: self.speed_km_h,
            road: self.road.clone(),
            course: self.course.changes(),
            load: self.course.load,
            gas_temperature_c: self.gas_temperature_c,
            duration_s: self.duration_s,
            score_from_s: self.score_from_s,
            seed: self.seed,
            has_handling: self.handling.is_some(),
            has_strut: self.strut.is_some(),
        }
    }
}
