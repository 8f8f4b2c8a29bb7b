//! What is driven, what goes wrong when, and what must hold: everything that makes a run repeatable.
//!
//! A [`Scenario`] holds only checked values; [`file`] reads it from TOML, [`fault`] and [`check`] are its two lists, and
//! [`named`] looks up the built-in ones. `docs/hil.md` is the reference for people.

pub mod check;
pub mod fault;
mod fault_entry;
pub mod file;

use std::path::Path;

use oleo_controller::{DamperPolicy, Strategy};
use oleo_interface::tick::TICK_S;
use strum::{EnumString, IntoStaticStr, VariantNames};

use crate::bus::BusAddress;
pub use check::{Check, Comparison};
pub use fault::{Fault, FaultKind};
pub use file::ScenarioError;

/// How time passes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, EnumString, IntoStaticStr, VariantNames)]
#[strum(serialize_all = "lowercase")]
pub enum Clock {
    /// Plant and controller exchange tick n before either goes on: deterministic, as fast as it goes.
    #[default]
    Lockstep,
    /// Absolute deadlines of wall-clock time.
    RealTime,
}

impl Clock {
    /// As on the command line: `lockstep` or `realtime`.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// What the plant does when the controller is gone for good.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, EnumString, VariantNames)]
#[strum(serialize_all = "lowercase")]
pub enum OnControllerLoss {
    /// Goes on to the end with de-energised valves.
    #[default]
    Continue,
    /// Ends the run.
    End,
}

/// A run, complete and checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Short name.
    pub name: String,
    /// What it shows.
    pub description: String,
    /// Built-in road or path of a `.crg` or `.csv` file.
    pub road: String,
    /// Forward speed, m/s.
    pub speed_m_s: f64,
    /// Simulated time, whole ticks.
    pub ticks: u32,
    /// How valves are decided.
    pub strategy: Strategy,
    /// How dampers are switched in ride mode.
    pub damper_policy: DamperPolicy,
    /// Strut model: `defender110` or the path of a `model.toml`.
    pub strut: String,
    /// Vehicle: `defender110` or the path of a parameter file.
    pub vehicle: String,
    /// Of the road and of all fault randomness.
    pub seed: u64,
    /// Where the frames go.
    pub bus: BusAddress,
    /// How time passes.
    pub clock: Clock,
    /// What the plant does without a controller.
    pub on_controller_loss: OnControllerLoss,
    /// Wall-clock time after which a silent partner is gone, s. A guard against hanging, without effect on results.
    pub partner_timeout_s: f64,
    /// What goes wrong.
    pub faults: Vec<Fault>,
    /// What must hold.
    pub checks: Vec<Check>,
}

impl Scenario {
    /// Simulated time, s.
    pub fn duration_s(&self) -> f64 {
        f64::from(self.ticks) * TICK_S
    }

    /// Length of road needed, m, with room for the smooth entry and the rear axle.
    pub fn road_length_m(&self) -> f64 {
        self.speed_m_s * self.duration_s() + 20.0
    }

    /// First tick of the first fault, and the first tick after the last one, where there is any.
    pub fn fault_ticks(&self) -> Option<(u32, u32)> {
        let from = self.faults.iter().map(|fault| fault.from_tick).min()?;
        let until = self.faults.iter().map(|fault| fault.until_tick).max()?;
        Some((from, until))
    }
}

macro_rules! built_in {
    ($($name:literal),* $(,)?) => {
        /// The built-in scenarios: name and text.
        pub const BUILT_IN: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../../scenarios/", $name, ".toml")))),*];
    };
}
built_in!(
    "belgian",
    "apg",
    "bus-silence",
    "stuck-sensor",
    "corrupt-burst",
    "killed-plant",
    "killed-controller",
    "lossy-bus",
    "nan",
    "out-of-range",
    "stuck-solenoid",
);

/// A built-in scenario by its name, or a file by its path.
///
/// # Errors
/// Unknown name, unreadable file, or content that is wrong (with file, line and key).
pub fn named(name_or_path: &str) -> Result<Scenario, ScenarioError> {
    if let Some((name, text)) = BUILT_IN.iter().find(|(name, _)| *name == name_or_path) {
        return file::parse(text, &format!("scenarios/{name}.toml"), Path::new(""));
    }
    let path = Path::new(name_or_path);
    let text = std::fs::read_to_string(path).map_err(|error| {
        let names: Vec<&str> = BUILT_IN.iter().map(|(name, _)| *name).collect();
        let what = if path.extension().is_some() {
            format!("cannot be read ({error})")
        } else {
            "is no scenario".into()
        };
        ScenarioError {
            file: name_or_path.into(),
            line: None,
            what: format!("{what}: give a .toml file or one of {}", names.join(", ")),
        }
    })?;
    file::parse(&text, name_or_path, path.parent().unwrap_or(Path::new("")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_scenario_reads() {
        for (name, _) in BUILT_IN {
            let scenario = named(name).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(scenario.name, *name);
            assert!(
                !scenario.checks.is_empty() && !scenario.description.is_empty(),
                "{name}"
            );
        }
        let default = named("belgian").unwrap();
        assert_eq!((default.ticks, default.strategy.name()), (4000, "ride-handling"));
        assert!((default.speed_m_s - 60.0 / 3.6).abs() < 1e-12);
    }

    #[test]
    fn an_unknown_name_lists_the_known_ones() {
        let error = named("belgium").unwrap_err().to_string();
        assert!(error.contains("belgian, apg") && error.lines().count() == 1, "{error}");
        assert!(
            named("nowhere.toml")
                .unwrap_err()
                .to_string()
                .starts_with("nowhere.toml: cannot be read")
        );
    }
}
