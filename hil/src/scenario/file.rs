//! Reads scenario files: TOML is converted into valid values, or into one error line with file, line and key.

use std::path::Path;

use oleo_interface::Axle;
use oleo_interface::tick::TICK_S;
use oleo_plant_sim::course::{CourseSettings, DriverStyle, ManoeuvreKind};
use oleo_plant_sim::model_file::limits::{checked, each_checked};
use oleo_plant_sim::model_file::names::{one_of, suggestion};
use oleo_plant_sim::model_file::{Checked, InvalidValue, Limit, ModelFileError, Range, read};
use oleo_plant_sim::vehicle::{Load, Payload};
use serde::Deserialize;
use strum::VariantArray;

use super::check_entry::CheckEntry;
use super::definition::Scenario;
use super::fault_entry::FaultEntry;
use super::strut_at::StrutAt;
use crate::bus::BusAddress;
use crate::imu::ImuSettings;

pub use super::fault_entry::LONGEST_S;

/// Highest forward speed that a scenario may have, km/h.
pub const FASTEST_KM_H: f64 = 250.0;
/// Name of the built-in vehicle and strut.
pub const DEFENDER: &str = "defender110";

/// A scenario as it stands in the file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ScenarioFile {
    name: String,
    #[serde(default)]
    description: String,
    road: String,
    speed_km_h: f64,
    duration_s: f64,
    strategy: Option<String>,
    damper_policy: Option<String>,
    strut: Option<String>,
    #[serde(default)]
    strut_at: StrutAt,
    vehicle: Option<String>,
    handling: Option<String>,
    load: Option<String>,
    manoeuvre: Option<String>,
    driver: Option<String>,
    entry_m: Option<f64>,
    radius_m: Option<f64>,
    steer_deg: Option<f64>,
    change_m_s2: Option<f64>,
    begin_s: Option<f64>,
    side_slope_percent: Option<f64>,
    score_from_s: Option<f64>,
    seed: Option<u64>,
    bus: Option<String>,
    clock: Option<String>,
    on_controller_loss: Option<String>,
    partner_timeout_s: Option<f64>,
    payload: Option<Payload>,
    broken_anti_roll_link: Option<String>,
    imu: Option<ImuSettings>,
    #[serde(default)]
    fault: Vec<FaultEntry>,
    #[serde(default)]
    check: Vec<CheckEntry>,
}

impl Checked for ScenarioFile {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("speed_km_h", Range::FromTo(0.0, FASTEST_KM_H), "km/h", |file| {
            file.speed_km_h
        }),
        Limit::one("duration_s", Range::FromTo(TICK_S, LONGEST_S), "s", |file| {
            file.duration_s
        }),
        Limit::optional("score_from_s", Range::FromTo(0.0, LONGEST_S), "s", |file| {
            file.score_from_s
        }),
        Limit::optional("partner_timeout_s", Range::FromTo(0.1, 600.0), "s", |file| {
            file.partner_timeout_s
        }),
    ];

    fn check_together(&self) -> Result<(), InvalidValue> {
        if let Some(payload) = &self.payload {
            checked(payload, "payload")?;
        }
        if let Some(imu) = &self.imu {
            checked(imu, "imu")?;
        }
        each_checked(&self.fault, "fault")?;
        each_checked(&self.check, "check")
    }
}

/// Read a scenario. `file` is the name that appears in errors, `folder` is where relative paths in it start.
///
/// # Errors
/// Unknown, missing or impossible entries, with file and line.
pub fn parse(text: &str, file: &str, folder: &Path) -> Result<Scenario, ModelFileError> {
    let raw: ScenarioFile = read(text, file)?;
    raw.scenario(text, folder)
        .map_err(|invalid| invalid.in_file(text, file))
}

impl ScenarioFile {
    /// The scenario, its names looked up.
    fn scenario(self, text: &str, folder: &Path) -> Result<Scenario, InvalidValue> {
        let ticks = (self.duration_s / TICK_S).round() as u32;
        let course = self.course()?;
        let speed_m_s = self.speed_km_h / 3.6;
        if let Some(settings) = &course {
            settings.manoeuvre(speed_m_s, Some(f64::from(ticks) * TICK_S))?;
        }
        let has_manoeuvre = course.is_some();
        Ok(Scenario {
            name: self.name,
            description: self.description,
            text: text.to_owned(),
            changes: Vec::new(),
            road: located(&self.road, folder, &oleo_plant_sim::road::NAMES),
            course,
            speed_m_s,
            ticks,
            strategy: one_of("strategy", self.strategy.as_deref())?,
            damper_policy: one_of("damper_policy", self.damper_policy.as_deref())?,
            strut_at: (self.strut_at.by_corner()).map(|path| path.map(|path| located(&path, folder, &[DEFENDER]))),
            strut: located(self.strut.as_deref().unwrap_or(DEFENDER), folder, &[DEFENDER]),
            vehicle: located(self.vehicle.as_deref().unwrap_or(DEFENDER), folder, &[DEFENDER]),
            handling: located(self.handling.as_deref().unwrap_or(DEFENDER), folder, &[DEFENDER]),
            load: word::<Load>("load", self.load.as_deref())?.unwrap_or_default(),
            payload: self.payload,
            broken_anti_roll_link: axle(self.broken_anti_roll_link.as_deref())?,
            imu: self.imu,
            score_from_s: self.score_from_s.unwrap_or(0.0),
            seed: self.seed.unwrap_or(1),
            bus: match self.bus {
                Some(bus) => bus
                    .parse()
                    .map_err(|error: crate::bus::AddressError| InvalidValue::new("bus", error.to_string()))?,
                None => BusAddress::default(),
            },
            clock: one_of("clock", self.clock.as_deref())?,
            on_controller_loss: one_of("on_controller_loss", self.on_controller_loss.as_deref())?,
            partner_timeout_s: self.partner_timeout_s.unwrap_or(3.0),
            faults: each(self.fault, "fault", |entry| entry.fault(ticks))?,
            checks: each(self.check, "check", |entry| entry.check(has_manoeuvre))?,
        })
    }
}

impl ScenarioFile {
    /// The settings of the manoeuvre, where there is one. Without one, its settings are refused.
    fn course(&self) -> Result<Option<CourseSettings>, InvalidValue> {
        let driver = word::<DriverStyle>("driver", self.driver.as_deref())?;
        let Some(kind) = word::<ManoeuvreKind>("manoeuvre", self.manoeuvre.as_deref())? else {
            let given = [
                ("driver", self.driver.is_some()),
                ("entry_m", self.entry_m.is_some()),
                ("radius_m", self.radius_m.is_some()),
                ("steer_deg", self.steer_deg.is_some()),
                ("change_m_s2", self.change_m_s2.is_some()),
                ("begin_s", self.begin_s.is_some()),
                ("side_slope_percent", self.side_slope_percent.is_some()),
            ];
            return match given.into_iter().find(|(_, given)| *given) {
                None => Ok(None),
                Some((key, _)) => Err(InvalidValue::new(key, NEEDS_MANOEUVRE)),
            };
        };
        Ok(Some(CourseSettings {
            kind,
            driver,
            entry_m: self.entry_m,
            radius_m: self.radius_m,
            steer_deg: self.steer_deg,
            change_m_s2: self.change_m_s2,
            begin_s: self.begin_s,
            side_slope_percent: self.side_slope_percent,
        }))
    }
}

/// What is wrong with a setting of a course where there is none.
const NEEDS_MANOEUVRE: &str = "needs a manoeuvre, since without one the ride model drives straight ahead: add manoeuvre = \"straight\" or another";

/// The axle whose link is broken.
fn axle(name: Option<&str>) -> Result<Option<Axle>, InvalidValue> {
    let Some(name) = name else { return Ok(None) };
    match name {
        "front" => Ok(Some(Axle::Front)),
        "rear" => Ok(Some(Axle::Rear)),
        other => Err(InvalidValue::new(
            "broken_anti_roll_link",
            format!("is {other:?}: must be front or rear"),
        )),
    }
}

/// A value that a key names out of a list.
fn word<T>(key: &'static str, name: Option<&str>) -> Result<Option<T>, InvalidValue>
where
    T: std::str::FromStr + VariantArray + Copy + Into<&'static str>,
{
    let Some(name) = name else { return Ok(None) };
    name.parse().map(Some).map_err(|_| {
        let names: Vec<&str> = T::VARIANTS.iter().map(|variant| (*variant).into()).collect();
        let what = format!("is {name:?}: {}", suggestion(name, &names, "choices"));
        InvalidValue::new(key, what)
    })
}

/// Every entry of an array of tables made into what it stands for.
fn each<T, U>(
    entries: Vec<T>,
    key: &'static str,
    make: impl Fn(T) -> Result<U, InvalidValue>,
) -> Result<Vec<U>, InvalidValue> {
    (entries.into_iter().enumerate())
        .map(|(position, entry)| make(entry).map_err(|invalid| invalid.inside(position).inside(key)))
        .collect()
}

/// A built-in name as it is, anything else as a path from the scenario's folder.
fn located(value: &str, folder: &Path, names: &[&str]) -> String {
    if names.contains(&value) || folder.as_os_str().is_empty() {
        value.to_owned()
    } else {
        folder.join(value).to_string_lossy().into_owned()
    }
}

#[cfg(test)]
mod tests;
