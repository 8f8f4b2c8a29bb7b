//! Options that describe a course, the same for every command that drives one.

use oleo_hil::run::RunError;
use oleo_plant_sim::course::{CourseChanges, DriverStyle};
use oleo_plant_sim::model_file::InvalidValue;
use oleo_plant_sim::vehicle::Load;

use super::word::word;
use crate::failure::Failure;

/// What is said of manoeuvre, driver, road and load. What the manoeuvre has no use for is refused.
#[derive(clap::Args)]
pub struct CourseArgs {
    /// Who drives: eased cuts corners, hard asks for all that a lane change takes [default: eased]
    #[arg(long, value_name = "eased|hard", value_parser = word::<DriverStyle>)]
    pub driver: Option<DriverStyle>,
    /// What the vehicle carries: as-sold (nothing), laden (900 kg), roof (150 kg on the roof) or laden-roof (750 and 150 kg)
    /// [default: as-sold]
    #[arg(long, value_name = "LOAD", value_parser = word::<Load>)]
    pub load: Option<Load>,
    /// Side slope of the road, %, positive where the left side is the higher one; it grows over 30 m [default: 0]
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true)]
    pub side_slope_percent: Option<f64>,
    /// Way to drive straight ahead before the first cones of a lane change, m [default: 25]
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub entry_m: Option<f64>,
    /// Radius of constant-radius and braking-in-bend, m, positive to the left [default: 40]
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub radius_m: Option<f64>,
    /// Angle of the steering wheel over the steering ratio in step-steer, degrees, positive to the left [default: 2]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    pub steer_deg: Option<f64>,
    /// Deceleration or acceleration asked for, m/s2 [default: 5 for braking, 2 for acceleration]
    #[arg(long, value_name = "M_S2", allow_negative_numbers = true)]
    pub change_m_s2: Option<f64>,
    /// Time at which the step of steer, the brake or the accelerator begins, s [default: 1; braking in a bend 8]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub begin_s: Option<f64>,
}

impl CourseArgs {
    /// What was given of the manoeuvre.
    pub fn changes(&self) -> CourseChanges {
        CourseChanges {
            driver: self.driver,
            entry_m: self.entry_m,
            radius_m: self.radius_m,
            steer_deg: self.steer_deg,
            change_m_s2: self.change_m_s2,
            begin_s: self.begin_s,
            side_slope_percent: self.side_slope_percent,
        }
    }
}

/// A run that did not come about. A complaint about a setting becomes one about its option.
pub fn run_failure(error: RunError) -> Failure {
    match error {
        RunError::Course(invalid) => option_failure(&invalid),
        error => error.into(),
    }
}

/// A complaint about a setting as one about its option: `entry_m is 3: ...` becomes `--entry-m is 3: ...`.
pub fn option_failure(invalid: &InvalidValue) -> Failure {
    let text = invalid.to_string();
    let (key, what) = text.split_once(' ').unwrap_or((&text, ""));
    Failure::new(format!("--{} {what}", key.replace('_', "-")))
}
