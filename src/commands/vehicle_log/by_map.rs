//! Reads the log of a vehicle with any CAN database, by a map of signals.

use std::path::Path;

use oleo_diagnose::vehicle::Resolution;
use oleo_hil::signal_log::{self, Database, Selection, SignalAccount, SignalMap, SignalPart, Survey};
use oleo_interface::Corners;

use super::content::{InertialSample, Part, PartSink, StrutSample, VehicleSample, others, plural};
use crate::failure::Failure;

/// Maps have no inertial unit.
const NO_UNIT: InertialSample = InertialSample {
    specific_force_m_s2: [f64::NAN; 3],
    rate_rad_s: [f64::NAN; 3],
};

/// The signals that are taken of a log.
pub struct ByMap(Selection);

impl ByMap {
    /// Reads a database, and the map of its signals.
    pub fn of(dbc: &Path, signals: &Path) -> Result<Self, Failure> {
        let read = |path: &Path, what: &str| {
            let cannot = |e| {
                Failure::new(format!(
                    "{}: cannot read the {what}: {e}; check the path",
                    path.display()
                ))
            };
            std::fs::read(path).map_err(cannot)
        };
        let map_file = signals.display().to_string();
        let text = String::from_utf8(read(signals, "map of signals")?)
            .map_err(|_| Failure::new(format!("{map_file}: is not text in UTF-8; save it as such")))?;
        let map = SignalMap::from_toml(&text, &map_file).map_err(Failure::new)?;
        let database =
            Database::from_bytes(&read(dbc, "database")?, &dbc.display().to_string()).map_err(Failure::new)?;
        Ok(Self(Selection::of(&map, &database, &map_file).map_err(Failure::new)?))
    }

    /// Gives the drives of a log to `sink`.
    pub fn stream(&self, path: &Path, sink: &mut PartSink) -> Result<String, Failure> {
        let survey = signal_log::survey(path, &self.0)?;
        let begins = Part::Begins {
            period_s: survey.period_s(),
            of_several: survey.number_of_drives() > 1,
        };
        let account = signal_log::stream(path, &self.0, &survey, &mut |part| match part {
            SignalPart::Begins(_) => sink(begins),
            SignalPart::Sample(struts) => sink(Part::Sample(&VehicleSample {
                struts: struts.map(|strut| StrutSample {
                    displacement_m: strut.displacement_m,
                    pressure_pa: strut.pressure_pa.into_array(),
                    valves: strut.valves,
                }),
                inertial: NO_UNIT,
            })),
        })?;
        Ok(in_words(&account, &survey))
    }

    /// Steps to which the readings are rounded.
    pub fn resolution(&self) -> Corners<Resolution> {
        self.0.steps.map(|steps| Resolution {
            displacement_m: steps.displacement_m,
            pressure_pa: steps.pressure_pa,
        })
    }
}

/// What was read of a log, in one sentence.
fn in_words(account: &SignalAccount, survey: &Survey) -> String {
    format!(
        "{} drive{} with a sample every {:.1} ms, {} frames of the map; {} without a reading, {} repeated, {} outside the drives; {}.",
        survey.number_of_drives(),
        plural(survey.number_of_drives()),
        1e3 * survey.period_s(),
        account.total(|m| m.received),
        account.total(|m| m.without_reading),
        account.total(|m| m.repeated),
        account.total(|m| m.outside),
        others(account.foreign_frames, &account.log),
    )
}
