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
mod tests {
    use super::*;
    use proptest::prelude::*;

    const GOOD: &str = "name = \"x\"\nroad = \"flat\"\nspeed_km_h = 60\nduration_s = 2\n";

    fn complaint(more: &str) -> String {
        let error = parse(&format!("{GOOD}{more}"), "x.toml", Path::new(""))
            .unwrap_err()
            .to_string();
        assert_eq!(error.lines().count(), 1, "{error}");
        error
    }

    #[test]
    fn defaults() {
        let scenario = parse(GOOD, "x.toml", Path::new("dir")).unwrap();
        assert_eq!(
            (scenario.ticks, scenario.seed, scenario.road.as_str()),
            (400, 1, "flat")
        );
        let own = parse(&GOOD.replace("flat", "my.crg"), "x.toml", Path::new("dir")).unwrap();
        assert_eq!(own.road, "dir/my.crg");
    }

    #[test]
    fn complaints_name_file_line_and_key() {
        let table = [
            ("sped = 3\n", "x.toml:5: sped is not a known key: did you mean "),
            ("seed = -1\n", "x.toml:5: seed is -1: must be a whole number, 0 or more"),
            (
                "strategy = \"soft\"\n",
                "x.toml:5: strategy is \"soft\": must be one of always-soft",
            ),
            ("bus = \"can0\"\n", "x.toml:5: bus \"can0\" is not a bus"),
            (
                "clock = \"slow\"\n",
                "x.toml:5: clock is \"slow\": must be one of lockstep, realtime",
            ),
            ("seed = \n", "x.toml:5: this is not TOML: "),
            (
                "[[fault]]\nkind = \"drop\"\nat_s = 3\n",
                "x.toml:7: [fault 1] at_s is 3: the run ends at 2 s",
            ),
            (
                "[[fault]]\nkind = \"drop\"\nat_s = 1\nprobability = 1.5\n",
                "x.toml:8: [fault 1] probability is 1.5: must be from 0 to 1",
            ),
            (
                "[[fault]]\nkind = \"drop\"\nat_s = nan\n",
                "x.toml:7: [fault 1] at_s is NaN: must be from 0 to 3600 s",
            ),
            (
                "[[fault]]\nkind = \"drop\"\nat_s = 1\nbits = 3\n",
                "x.toml:8: [fault 1] bits does not belong",
            ),
            (
                "[[fault]]\nkind = \"drop\"\nat_s = 1\n[[fault]]\nkind = \"drop\"\nat_s = -1\n",
                "x.toml:10: [fault 2] at_s is -1: must be from 0 to 3600 s",
            ),
            (
                "[[fault]]\nkind = \"flood\"\nat_s = 1\n",
                "x.toml:6: [fault 1] kind is \"flood\": must be one of silence, drop",
            ),
            (
                "[[fault]]\nkind = \"drop\"\nat_s = 1\nmessage = \"X\"\n",
                "x.toml:8: [fault 1] message is \"X\", which is not a message",
            ),
            (
                "[[fault]]\nkind = \"sensor-nan\"\nat_s = 1\n",
                "x.toml:6: [fault 1] kind is \"sensor-nan\", which needs sensor too",
            ),
            (
                "[[fault]]\nkind = \"sensor-nan\"\nat_s = 1\nsensor = \"p1\"\n",
                "x.toml:8: [fault 1] sensor is \"p1\": must be CORNER.SENSOR",
            ),
            (
                "[[fault]]\nkind = \"node-killed\"\nat_s = 1\nnode = \"me\"\n",
                "x.toml:8: [fault 1] node is \"me\": must be one of plant, controller",
            ),
            (
                "[[check]]\nmetric = \"max_rol_deg\"\nat_most = 1\n",
                "x.toml:6: [check 1] metric is \"max_rol_deg\", which is not a metric: did you mean max_roll_deg?",
            ),
            (
                "[[check]]\nmetric = \"max_roll_deg\"\n",
                "x.toml:6: [check 1] metric is \"max_roll_deg\": give exactly one of",
            ),
            (
                "[[check]]\nmetric = \"max_roll_deg\"\nequals = \"safe\"\n",
                "x.toml:7: [check 1] equals does not go with max_roll_deg, which is a number",
            ),
            (
                "[[check]]\nmetric = \"final_mode\"\nat_most = 1\n",
                "x.toml:7: [check 1] at_most does not go with final_mode, which is a word",
            ),
            (
                "[[check]]\nmetric = \"max_roll_deg\"\nequals = [1]\n",
                "x.toml:7: [check 1] equals is [1]: must be a number or a word",
            ),
            (
                "[[check]]\nmetric = \"max_roll_deg\"\nat_most = inf\n",
                "x.toml:7: [check 1] at_most is inf: must be a finite number",
            ),
            (
                "manoeuvre = \"lane_change\"\n",
                "x.toml:5: manoeuvre is \"lane_change\": did you mean lane-change? The choices are straight, ",
            ),
            (
                "manoeuvre = \"straight\"\ndriver = \"harsh\"\n",
                "x.toml:6: driver is \"harsh\": did you mean hard? The choices are eased, hard",
            ),
            (
                "load = \"heavy\"\n",
                "x.toml:5: load is \"heavy\": the choices are as-sold",
            ),
            (
                "broken_anti_roll_link = \"left\"\n",
                "x.toml:5: broken_anti_roll_link is \"left\": must be front or rear",
            ),
            (
                "[payload]\nmass_kg = -5\n",
                "x.toml:6: [payload] mass_kg is -5: must be from 0 to 2000 kg",
            ),
            ("[imu]\nx_m = 9\n", "x.toml:6: [imu] x_m is 9: must be from -5 to 5 m"),
            ("[imu]\nplace = 9\n", "x.toml:6: [imu] place is not a known key: "),
            ("entry_m = 50\n", "x.toml:5: entry_m needs a manoeuvre"),
            ("driver = \"hard\"\n", "x.toml:5: driver needs a manoeuvre"),
            (
                "manoeuvre = \"step-steer\"\nentry_m = 50\n",
                "x.toml:6: entry_m does not belong to the manoeuvre step-steer",
            ),
            (
                "manoeuvre = \"step-steer\"\nbegin_s = 2\n",
                "x.toml:6: begin_s is 2: the drive ends before, at 2 s",
            ),
            (
                "manoeuvre = \"braking\"\nchange_m_s2 = 20\n",
                "x.toml:6: change_m_s2 is 20: must be from 0.1 to 12 m/s2",
            ),
            (
                "manoeuvre = \"straight\"\nside_slope_percent = -41\n",
                "x.toml:6: side_slope_percent is -41: must be from -40 to 40 %",
            ),
            (
                "score_from_s = -1\n",
                "x.toml:5: score_from_s is -1: must be from 0 to 3600 s",
            ),
            (
                "[[fault]]\nkind = \"sensor-swap\"\nat_s = 1\nsensor = \"front-left.p1\"\n",
                "x.toml:6: [fault 1] kind is \"sensor-swap\", which needs other too",
            ),
            (
                "[[fault]]\nkind = \"sensor-swap\"\nat_s = 1\nsensor = \"front-left.p1\"\nother = \"rear-left.displacement\"\n",
                "x.toml:9: [fault 1] other must be another sensor",
            ),
            (
                "[[fault]]\nkind = \"sensor-noise\"\nat_s = 1\nsensor = \"front-left.p1\"\nvalue = -1\n",
                "x.toml:9: [fault 1] value is -1: a standard deviation is 0 or more",
            ),
            (
                "[[fault]]\nkind = \"node-restarted\"\nat_s = 1\nnode = \"controller\"\n",
                "x.toml:6: [fault 1] kind is \"node-restarted\", which needs for_s too",
            ),
            (
                "[[fault]]\nkind = \"node-restarted\"\nat_s = 1\nfor_s = 0.2\n",
                "x.toml:6: [fault 1] kind is \"node-restarted\", which needs node too",
            ),
            (
                "[[fault]]\nkind = \"node-restarted\"\nat_s = 1\nfor_s = 0.2\nnode = \"plant\"\n",
                "x.toml:9: [fault 1] node is \"plant\", which begins another run when it restarts: must be \"controller\"",
            ),
            (
                "[[fault]]\nkind = \"masquerade\"\nat_s = 1\nprobability = 0.5\n",
                "x.toml:8: [fault 1] probability does not belong",
            ),
            (
                "[[check]]\nmetric = \"decision_s\"\nat_most = 1\n",
                "x.toml:6: [check 1] metric is \"decision_s\", which the ride model does not have",
            ),
        ];
        for (more, expected) in table {
            let error = complaint(more);
            assert!(error.starts_with(expected), "{error}\n  expected {expected}");
        }
        let missing = parse("name = \"x\"\n", "x.toml", Path::new(""))
            .unwrap_err()
            .to_string();
        assert_eq!(missing, "x.toml:1: road is missing: add it");
    }

    proptest! {
        #[test]
        fn no_text_does_harm(text in "\\PC{0,200}") {
            let _ = parse(&text, "x", Path::new(""));
        }

        #[test]
        fn no_damaged_scenario_does_harm(at in 0usize..400, byte in 0x20u8..0x7F) {
            let mut text = format!("{GOOD}[[fault]]\nkind = \"corrupt\"\nat_s = 1.0\nfor_s = 0.5\nbits = 2\n[[check]]\nmetric = \"final_mode\"\nequals = \"safe\"\n").into_bytes();
            let length = text.len();
            text[at % length] = byte;
            let _ = parse(std::str::from_utf8(&text).unwrap(), "x", Path::new(""));
        }
    }
}
