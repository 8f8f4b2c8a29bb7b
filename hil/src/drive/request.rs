//! What is asked for: a manoeuvre, with which models and suspensions, and the files that describe the vehicle.

use oleo_plant_sim::course::CourseChanges;
use oleo_plant_sim::model_file::InvalidValue;
use oleo_plant_sim::vehicle::Load;

use super::choice::{Kind, Model, Setting};
use crate::run::RunError;

/// A drive as it is asked for. `None` is the usual value.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// What is driven.
    pub manoeuvre: Kind,
    /// Model of the vehicle.
    pub model: Model,
    /// Suspensions; each is driven.
    pub setting: Vec<Setting>,
    /// Speed, km/h; in a circle that at the end.
    pub speed_km_h: Option<f64>,
    /// Name of a built-in road, or path of a file; usually flat.
    pub road: Option<String>,
    /// Settings of the manoeuvre.
    pub course: CourseChanges,
    /// What the vehicle carries; usually nothing.
    pub load: Option<Load>,
    /// Gas temperature of the struts, degrees Celsius; they were charged at 20.
    pub gas_temperature_c: Option<f64>,
    /// Simulated time, s; lane changes end behind the last cones unless it is given.
    pub duration_s: Option<f64>,
    /// Time at the start that is left out of the comfort measures, s.
    pub score_from_s: f64,
    /// Seed of random roads.
    pub seed: u64,
    /// Whether handling parameters other than the built-in ones are given.
    pub has_handling: bool,
    /// Whether another strut than the built-in one is given.
    pub has_strut: bool,
}

impl Request {
    /// A drive with the handling model and the controller, everything else as usual.
    #[must_use]
    pub fn new(manoeuvre: Kind) -> Self {
        Self {
            manoeuvre,
            model: Model::Handling,
            setting: vec![Setting::Controlled],
            speed_km_h: None,
            road: None,
            course: CourseChanges::default(),
            load: None,
            gas_temperature_c: None,
            duration_s: None,
            score_from_s: 1.0,
            seed: 1,
            has_handling: false,
            has_strut: false,
        }
    }

    /// Refuses what nothing has a use for, so that nobody believes that it had an effect.
    ///
    /// # Errors
    /// [`RunError::Course`] names the setting.
    pub fn refuse_unused(&self) -> Result<(), RunError> {
        let refuse = |key: &'static str, what: &str| Err(RunError::Course(InvalidValue::new(key, what)));
        if self.model == Model::Both && self.setting.len() > 1 {
            return refuse(
                "model",
                "is both: two models are compared with one setting; give one setting, or one model",
            );
        }
        if let Some(twice) =
            (self.setting.iter().enumerate()).find_map(|(i, s)| self.setting[..i].contains(s).then_some(s))
        {
            return refuse("setting", &format!("has {} twice: name each once", twice.name()));
        }
        if self.setting.is_empty() {
            return refuse("setting", "is empty: name one at least");
        }
        // The controller knows some of the handling parameters, whatever drives.
        if self.model == Model::Ride && self.has_handling && !self.setting.contains(&Setting::Controlled) {
            return refuse(
                "handling",
                "is not used by the ride model: take the model handling, or leave it out",
            );
        }
        if self.setting == [Setting::Baseline] {
            if self.gas_temperature_c.is_some() {
                return refuse(
                    "gas_temperature_c",
                    "has no use, since coil springs contain no gas: take another setting, or leave it out",
                );
            }
            if self.has_strut {
                return refuse(
                    "strut",
                    "has no use, since the vehicle as sold stands on coil springs: take another setting, or leave it out",
                );
            }
        }
        if self.manoeuvre.steers() && self.model != Model::Handling {
            return refuse(
                "model",
                "is not handling, and the ride model can neither steer nor brake: take the model handling for this manoeuvre",
            );
        }
        if self.model == Model::Ride && self.course.driver.is_some() {
            return refuse(
                "driver",
                "has nothing to steer in the ride model: take the model handling, or leave it out",
            );
        }
        if self.manoeuvre.own_road().is_some() && self.road.is_some() {
            return refuse(
                "road",
                "has no use, since this manoeuvre has a road of its own: drive the manoeuvre straight over another one",
            );
        }
        Ok(())
    }

    /// Refuses a value out of its range.
    ///
    /// # Errors
    /// [`RunError::Course`] names the setting.
    pub(super) fn within(key: &'static str, value: f64, low: f64, high: f64) -> Result<(), RunError> {
        if value >= low && value <= high {
            return Ok(());
        }
        let what = format!("is {value}: give a value from {low} to {high}");
        Err(RunError::Course(InvalidValue::new(key, what)))
    }
}
