//! A scenario as a file again, so that a run can be repeated: what was written, with what a command line changed.

use oleo_interface::tick::TICK_S;
use oleo_plant_sim::road;
use toml::{Table, Value};

use super::definition::Scenario;
use super::file::DEFENDER;
use super::strut_at::as_table;

/// Keys that describe the manoeuvre; those of the written one go where another is driven.
const MANOEUVRE: [&str; 8] = [
    "manoeuvre",
    "driver",
    "entry_m",
    "radius_m",
    "steer_deg",
    "change_m_s2",
    "begin_s",
    "side_slope_percent",
];

impl Scenario {
    /// The text of a file that is this scenario. Files that it names have absolute paths; the vehicle, its handling and its strut
    /// are `vehicle.toml`, `handling.toml` and `strut.toml` beside the file where they are not built in.
    pub fn to_toml(&self) -> String {
        let mut table: Table = self.text.parse().unwrap_or_default();
        let mut set = |key: &str, value: Value| {
            table.insert(key.to_owned(), value);
        };
        let built_in = road::NAMES.contains(&self.road.as_str());
        let road = match std::path::absolute(&self.road) {
            Ok(path) if !built_in => path.display().to_string(),
            _ => self.road.clone(),
        };
        set("road", road.into());
        if !self.changes.is_empty() {
            set("description", self.title().into());
        }
        set("speed_km_h", speed_km_h(self.speed_m_s).into());
        set("duration_s", self.duration_s().into());
        set("strategy", self.strategy.name().into());
        set("damper_policy", self.damper_policy.name().into());
        for (key, given) in [
            ("strut", &self.strut),
            ("vehicle", &self.vehicle),
            ("handling", &self.handling),
        ] {
            let name = if given == DEFENDER {
                DEFENDER.to_owned()
            } else {
                format!("{key}.toml")
            };
            set(key, name.into());
        }
        set("load", self.load.key().into());
        set("seed", Value::Integer(self.seed.cast_signed()));
        set("bus", self.bus.to_string().into());
        set("clock", self.clock.name().into());
        table.retain(|key, _| !MANOEUVRE.contains(&key));
        if let Some(course) = &self.course {
            table.insert("manoeuvre".to_owned(), course.kind.key().into());
            if let Some(driver) = course.driver {
                table.insert("driver".to_owned(), driver.key().into());
            }
            let numbers = [
                ("entry_m", course.entry_m),
                ("radius_m", course.radius_m),
                ("steer_deg", course.steer_deg),
                ("change_m_s2", course.change_m_s2),
                ("begin_s", course.begin_s),
                ("side_slope_percent", course.side_slope_percent),
            ];
            let given = numbers
                .into_iter()
                .filter_map(|(key, number)| Some((key.to_owned(), number?.into())));
            table.extend(given);
        }
        if let Some(struts) = as_table(&self.strut_at) {
            table.insert("strut_at".to_owned(), struts);
        }
        if let Some(imu) = self.imu.as_ref().and_then(|imu| Value::try_from(imu).ok()) {
            table.insert("imu".to_owned(), imu);
        }
        // A fault after the end of a shortened run does not happen, and a file may not name it.
        if let Some(Value::Array(faults)) = table.get_mut("fault") {
            let begin_s = |fault: &Value| match fault.get("at_s") {
                Some(Value::Integer(at_s)) => *at_s as f64,
                Some(Value::Float(at_s)) => *at_s,
                _ => 0.0,
            };
            faults.retain(|fault| begin_s(fault) < self.duration_s() - 0.5 * TICK_S);
        }
        toml::to_string(&table).unwrap_or_default()
    }
}

/// The speed that is read as this one, to the bit, and has few digits where there is such a one.
fn speed_km_h(speed_m_s: f64) -> f64 {
    let about = 3.6 * speed_m_s;
    let brief = (about * 1e6).round() / 1e6;
    let candidates = [brief, about, about.next_up(), about.next_down()];
    (candidates.into_iter().find(|km_h| km_h / 3.6 == speed_m_s)).unwrap_or(about)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use oleo_plant_sim::course::{CourseSettings, ManoeuvreKind};

    use super::super::file::parse;
    use super::super::{BUILT_IN, named};
    use super::*;
    use crate::imu::ImuSettings;

    fn read_back(scenario: &Scenario) -> Scenario {
        let text = scenario.to_toml();
        let read = parse(&text, "scenario.toml", Path::new("")).unwrap_or_else(|error| panic!("{error}\n{text}"));
        Scenario {
            text: scenario.text.clone(),
            ..read
        }
    }

    #[test]
    fn every_built_in_scenario_is_read_back() {
        for (name, _) in BUILT_IN {
            let scenario = named(name).expect("built in");
            assert_eq!(read_back(&scenario), scenario, "{name}");
        }
    }

    #[test]
    fn what_was_changed_is_in_the_file() {
        let written = named("lane-change-on-belgian").expect("built in");
        let changed = Scenario {
            speed_m_s: 47.123_456_789_12 / 3.6,
            seed: u64::from(u32::MAX),
            imu: Some(ImuSettings::at([0.1, -0.2, 0.3], ImuSettings::default())),
            course: Some(CourseSettings {
                steer_deg: Some(3.0),
                ..CourseSettings::new(ManoeuvreKind::StepSteer)
            }),
            ..written
        };
        assert_eq!(read_back(&changed), changed);
        let shortened = Scenario {
            ticks: 100,
            ..named("bus-silence").expect("built in")
        };
        assert!(read_back(&shortened).faults.is_empty());
    }
}
