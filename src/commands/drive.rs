//! `oleo drive`: the vehicle through a manoeuvre, with the ride model, the handling model or both.

mod course;
mod sheet;
mod suspension;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::ValueEnum;
use oleo_plant_sim::handling::HandlingParameters;
use oleo_plant_sim::vehicle::VehicleParameters;
use strum::IntoStaticStr;

use crate::failure::Failure;
use course::Course;

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
    manoeuvre: Kind,
    /// Model of the vehicle; `both` compares them on the same road
    #[arg(long, value_enum, default_value_t = Model::Handling)]
    model: Model,
    /// Suspension: struts with all valves open, all closed, under the controller, or the coil springs of the vehicle as sold
    #[arg(long, value_enum, default_value_t = Setting::Controlled)]
    setting: Setting,
    /// Speed, km/h [default: 60, bump 5; constant-radius: speed at the end]
    #[arg(long, value_name = "KM_H", allow_negative_numbers = true)]
    speed_km_h: Option<f64>,
    /// Road for `straight`: belgian, apg-left, apg-right, apg-both, iso-a .. iso-f, flat, or a .crg or .csv file
    #[arg(long, value_name = "ROAD", default_value = "flat")]
    road: String,
    /// Time to drive, s [default: 20; lane changes end behind the last cones]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    duration_s: Option<f64>,
    /// Radius of constant-radius, m, positive to the left
    #[arg(long, value_name = "M", default_value_t = 40.0, allow_negative_numbers = true)]
    radius_m: f64,
    /// Steer angle of step-steer at the road wheels, degrees, positive to the left
    #[arg(long, value_name = "DEG", default_value_t = 2.0, allow_negative_numbers = true)]
    steer_deg: f64,
    /// Phases of random roads
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Vehicle parameters; without it the built-in defender110
    #[arg(long, value_name = "VEHICLE.toml")]
    vehicle: Option<PathBuf>,
    /// Handling parameters; without it the built-in defender110
    #[arg(long, value_name = "HANDLING.toml")]
    handling: Option<PathBuf>,
    /// Folder for CSV data, summary.json and report.html; without it only the table is printed
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Kind {
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

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Model {
    /// Appendix A, seven degrees of freedom
    Ride,
    /// Fourteen degrees of freedom with tyres and driver
    Handling,
    /// Both, compared
    Both,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum, IntoStaticStr)]
#[strum(serialize_all = "kebab-case")]
pub(crate) enum Setting {
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
    pub(crate) fn name(self) -> &'static str {
        self.into()
    }
}

/// Parameters from files or built in.
pub(crate) fn parameters(
    vehicle: Option<&PathBuf>,
    handling: Option<&PathBuf>,
) -> Result<(VehicleParameters, HandlingParameters), Failure> {
    let read = |path: &PathBuf| {
        let name = path.display().to_string();
        let text = std::fs::read_to_string(path)
            .map_err(|error| Failure::new(format!("{name}: cannot read the parameters: {error}; check the path")))?;
        Ok::<_, Failure>((text, name))
    };
    let vehicle = match vehicle {
        Some(path) => {
            let (text, name) = read(path)?;
            VehicleParameters::from_toml(&text, &name)?
        }
        None => VehicleParameters::defender110(),
    };
    let handling = match handling {
        Some(path) => {
            let (text, name) = read(path)?;
            HandlingParameters::from_toml(&text, &name)?
        }
        None => HandlingParameters::defender110(),
    };
    Ok((vehicle, handling))
}

/// Runs the command.
pub fn run(args: Args) -> Result<ExitCode, Failure> {
    let out = args.out.as_ref().map(oleo_report::OutputDirectory::stage).transpose()?;
    let (vehicle, handling) = parameters(args.vehicle.as_ref(), args.handling.as_ref())?;
    let course = Course::new(&args, vehicle, handling)?;
    let mut runs = Vec::new();
    if args.model != Model::Handling {
        runs.push(("ride model", course.ride(args.setting)?));
    }
    if args.model != Model::Ride {
        runs.push(("handling model", course.handling(args.setting)?));
    }
    sheet::publish(&course, args.setting, &runs, out)?;
    Ok(ExitCode::SUCCESS)
}
