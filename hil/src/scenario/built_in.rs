//! Scenarios by name: the built-in ones, and files by their path.

use std::path::Path;

use oleo_plant_sim::model_file::ModelFileError;
use oleo_plant_sim::model_file::names::suggestion;

use super::definition::Scenario;
use super::file;

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
    "restarted-controller",
    "lossy-bus",
    "nan",
    "out-of-range",
    "stuck-solenoid",
    "held-up-bus",
    "doubled-frames",
    "lane-change-on-belgian",
    "lane-change-laden",
    "step-steer",
    "side-slope",
    "bus-silence-in-lane-change",
    "masquerade",
    "replay",
);

/// A built-in scenario by its name, or a file by its path.
///
/// # Errors
/// Unknown name, unreadable file, or content that is wrong (with file, line and key).
pub fn named(name_or_path: &str) -> Result<Scenario, ModelFileError> {
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
        let what = format!(
            "{what}: give a .toml file; {}",
            suggestion(name_or_path, &names, "built-in scenarios")
        );
        ModelFileError::new(name_or_path, None, &what)
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
        assert_eq!((default.ticks, default.strategy.name()), (4000, "road-and-cornering"));
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
