//! What is driven instead of what a scenario says.

use oleo_controller::{DamperPolicy, Strategy};
use oleo_interface::Corner;
use oleo_interface::tick::TICK_S;
use oleo_plant_sim::course::{CourseChanges, CourseSettings, ManoeuvreKind};
use oleo_plant_sim::model_file::{Checked, InvalidValue};
use oleo_plant_sim::vehicle::Load;

use super::changes::changes;
use super::definition::{Clock, Scenario};
use super::file::{FASTEST_KM_H, LONGEST_S};
use crate::bus::BusAddress;
use crate::imu::ImuSettings;

/// Values that replace those of a scenario; `None` leaves one as it is.
#[derive(Clone, Debug, Default)]
pub struct Overrides {
    /// Bus that carries the frames.
    pub bus: Option<BusAddress>,
    /// Clock of both nodes.
    pub clock: Option<Clock>,
    /// Name of a built-in road, or path of a file.
    pub road: Option<String>,
    /// Manoeuvre; one other than the scenario's uses none of the scenario's settings of its own.
    pub manoeuvre: Option<ManoeuvreKind>,
    /// Settings of the manoeuvre.
    pub course: CourseChanges,
    /// What the vehicle carries.
    pub load: Option<Load>,
    /// Forward speed, km/h.
    pub speed_km_h: Option<f64>,
    /// Simulated time, s.
    pub duration_s: Option<f64>,
    /// Strategy of the controller.
    pub strategy: Option<Strategy>,
    /// Rule by which the strategies `ride-handling` and `road-and-dampers` switch the dampers.
    pub damper_policy: Option<DamperPolicy>,
    /// Place of an inertial unit ahead, left and up of the body's centre of mass in running order, m.
    pub imu_m: Option<[f64; 3]>,
    /// Path of a strut model.
    pub strut: Option<String>,
    /// Paths of strut models of single corners.
    pub strut_at: Vec<(Corner, String)>,
    /// Path of vehicle parameters.
    pub vehicle: Option<String>,
    /// Path of handling parameters.
    pub handling: Option<String>,
    /// Seed of random roads and of injected faults, up to 2^63 - 1.
    pub seed: Option<u64>,
}

impl Overrides {
    /// The scenario that is run instead of `written`.
    ///
    /// # Errors
    /// A value that is out of its range or that nothing has a use for, by its name here.
    pub fn of(&self, written: &Scenario) -> Result<Scenario, InvalidValue> {
        let mut chosen = written.clone();
        let own = |given: &Option<String>, value: &mut String| {
            if let Some(given) = given {
                value.clone_from(given);
            }
        };
        own(&self.road, &mut chosen.road);
        own(&self.strut, &mut chosen.strut);
        for (corner, path) in &self.strut_at {
            chosen.strut_at[*corner] = Some(path.clone());
        }
        own(&self.vehicle, &mut chosen.vehicle);
        own(&self.handling, &mut chosen.handling);
        chosen.load = self.load.unwrap_or(chosen.load);
        chosen.bus = self.bus.clone().unwrap_or(chosen.bus);
        chosen.clock = self.clock.unwrap_or(chosen.clock);
        chosen.strategy = self.strategy.unwrap_or(chosen.strategy);
        chosen.damper_policy = self.damper_policy.unwrap_or(chosen.damper_policy);
        if let Some(speed_km_h) = self.speed_km_h {
            chosen.speed_m_s = within("speed_km_h", speed_km_h, 0.0, FASTEST_KM_H)? / 3.6;
        }
        if let Some(duration_s) = self.duration_s {
            chosen.ticks = (within("duration_s", duration_s, TICK_S, LONGEST_S)? / TICK_S).round() as u32;
        }
        if let Some(place_m) = self.imu_m {
            let imu = ImuSettings::at(place_m, chosen.imu.take().unwrap_or_default());
            let [x, y, z] = place_m;
            let refused = |invalid: InvalidValue| InvalidValue::new("imu", format!("is {x},{y},{z}: {invalid}"));
            imu.check().map_err(refused)?;
            chosen.imu = Some(imu);
        }
        chosen.seed = self.seed.unwrap_or(chosen.seed);
        chosen.course = self.course(chosen.course.take(), &written.name)?;
        if let Some(settings) = &chosen.course {
            settings.manoeuvre(chosen.speed_m_s, Some(chosen.duration_s()))?;
        }
        let with_policy = [Strategy::RideHandling, Strategy::RoadAndDampers];
        if self.damper_policy.is_some() && !with_policy.contains(&chosen.strategy) {
            let [first, second] = with_policy.map(Strategy::name);
            let what = format!(
                "has no use in the strategy {}: take the strategy {first} or {second}, or leave it out",
                chosen.strategy.name(),
            );
            return Err(InvalidValue::new("damper_policy", what));
        }
        chosen.changes = changes(written, &chosen);
        Ok(chosen)
    }

    /// The manoeuvre with its settings, from the scenario's and these.
    fn course(
        &self,
        of_scenario: Option<CourseSettings>,
        scenario: &str,
    ) -> Result<Option<CourseSettings>, InvalidValue> {
        let before = match self.manoeuvre {
            Some(kind) => Some(match of_scenario {
                Some(settings) if settings.kind == kind => settings,
                _ => CourseSettings::new(kind),
            }),
            None => of_scenario,
        };
        match (before, self.course.first_given()) {
            (Some(settings), _) => Ok(Some(self.course.changed(settings))),
            (None, None) => Ok(None),
            (None, Some(setting)) => {
                let what = format!(
                    "has no use, since the scenario {scenario} has no manoeuvre, and the ride model drives straight ahead: take the \
                     manoeuvre straight or another"
                );
                Err(InvalidValue::new(setting, what))
            }
        }
    }
}

fn within(key: &'static str, value: f64, low: f64, high: f64) -> Result<f64, InvalidValue> {
    if (low..=high).contains(&value) {
        return Ok(value);
    }
    Err(InvalidValue::new(
        key,
        format!("is {value}: must be from {low} to {high}"),
    ))
}
