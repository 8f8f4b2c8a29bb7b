//! Options that describe a course, the same for every command that drives one.

use oleo_plant_sim::course::{CourseSettings, DriverStyle, ManoeuvreKind};
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
    /// The settings of a manoeuvre without any before.
    pub fn settings(&self, kind: ManoeuvreKind) -> CourseSettings {
        self.changed(CourseSettings::new(kind))
    }

    /// The settings, changed by what was given.
    pub fn changed(&self, before: CourseSettings) -> CourseSettings {
        CourseSettings {
            kind: before.kind,
            driver: self.driver.or(before.driver),
            entry_m: self.entry_m.or(before.entry_m),
            radius_m: self.radius_m.or(before.radius_m),
            steer_deg: self.steer_deg.or(before.steer_deg),
            change_m_s2: self.change_m_s2.or(before.change_m_s2),
            begin_s: self.begin_s.or(before.begin_s),
            side_slope_percent: self.side_slope_percent.or(before.side_slope_percent),
        }
    }

    /// The first option that was given of those that need a manoeuvre.
    pub fn first_of_manoeuvre(&self) -> Option<&'static str> {
        let given = [
            ("--driver", self.driver.is_some()),
            ("--side-slope-percent", self.side_slope_percent.is_some()),
            ("--entry-m", self.entry_m.is_some()),
            ("--radius-m", self.radius_m.is_some()),
            ("--steer-deg", self.steer_deg.is_some()),
            ("--change-m-s2", self.change_m_s2.is_some()),
            ("--begin-s", self.begin_s.is_some()),
        ];
        given.into_iter().find(|(_, given)| *given).map(|(option, _)| option)
    }
}

/// A complaint about a setting as one about its option: `entry_m is 3: ...` becomes `--entry-m is 3: ...`.
pub fn option_failure(invalid: &InvalidValue) -> Failure {
    let text = invalid.to_string();
    let (key, what) = text.split_once(' ').unwrap_or((&text, ""));
    Failure::new(format!("--{} {what}", key.replace('_', "-")))
}
