//! What has been run already: one line of CSV a run, appended as it ends, so that a study that was interrupted goes on where
//! it stopped and an optimiser can use what a sweep has found.
//!
//! A line's key is a hash (FNV-1a, 64 bit) of everything the result depends on: vehicle and handling parameters,
//! conditions, case, and [`MODEL_VERSION`]. Another parameter, another key: old lines are never mistaken for new ones. A line
//! that an interruption cut short is skipped and its run made again.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::hash::Hasher as _;
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use csv::StringRecord;
use fnv::FnvHasher;

use super::case::{Bench, Case, Handling, Ride};

/// Raised with every change of the models that changes results.
const MODEL_VERSION: u32 = 4;

/// A ledger that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}: give another --out folder, or empty this one", path.display())]
pub struct LedgerError {
    path: PathBuf,
    problem: std::io::Error,
}

/// Results by key, and the file they are appended to.
pub struct Ledger {
    known: BTreeMap<String, StringRecord>,
    file: Option<(PathBuf, Mutex<File>)>,
    base: String,
}

impl Ledger {
    /// A ledger that forgets.
    pub fn in_memory(bench: &Bench) -> Self {
        Self {
            known: BTreeMap::new(),
            file: None,
            base: base(bench),
        }
    }

    /// Opens or creates the file `path`.
    ///
    /// # Errors
    /// The file cannot be read or written.
    pub fn open(path: &Path, bench: &Bench) -> Result<Self, LedgerError> {
        let wrap = |problem| LedgerError {
            path: path.to_owned(),
            problem,
        };
        let mut text = String::new();
        let mut file = OpenOptions::new()
            .read(true)
            .append(true)
            .create(true)
            .open(path)
            .map_err(wrap)?;
        file.read_to_string(&mut text).map_err(wrap)?;
        // Only what ends with a line break was written to its end.
        let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .from_reader(whole.as_bytes());
        let mut known = BTreeMap::new();
        for record in reader.records().flatten() {
            if let Some(key) = record.get(0) {
                known.insert(key.to_owned(), record);
            }
        }
        // A line cut short by an interruption must not swallow the next one.
        if !text.is_empty() && !text.ends_with('\n') {
            file.write_all(b"\n").map_err(wrap)?;
        }
        Ok(Self {
            known,
            file: Some((path.to_owned(), Mutex::new(file))),
            base: base(bench),
        })
    }

    /// Runs known so far.
    pub fn len(&self) -> usize {
        self.known.len()
    }

    /// Whether no run is stored.
    pub fn is_empty(&self) -> bool {
        self.known.is_empty()
    }

    fn key(&self, kind: &str, case: &Case) -> String {
        let mut text = format!("{}|{kind}", self.base);
        for value in case.numbers() {
            text.push_str(&format!("|{:016x}", value.to_bits()));
        }
        let mut hash = FnvHasher::default();
        hash.write(text.as_bytes());
        format!("{:016x}", hash.finish())
    }

    /// A ride result, if known.
    pub fn ride(&self, case: &Case) -> Option<Ride> {
        let fields = self.fields("ride", case)?;
        let [driver, passenger, driver_sick, passenger_sick, completed] = fields;
        Some(Ride {
            driver_rms_m_s2: driver,
            passenger_rms_m_s2: passenger,
            driver_msdv_m_s1_5: driver_sick,
            passenger_msdv_m_s1_5: passenger_sick,
            completed: completed > 0.5,
        })
    }

    /// A handling result, if known.
    pub fn handling(&self, case: &Case) -> Option<Handling> {
        let [roll, lateral, margin, completed, rolled_over] = self.fields("handling", case)?;
        Some(Handling {
            max_roll_rad: roll,
            max_lateral_m_s2: lateral,
            cone_margin_m: margin,
            completed: completed > 0.5,
            rolled_over: rolled_over > 0.5,
        })
    }

    /// The last five fields of a line, if the line is known and whole.
    fn fields(&self, kind: &str, case: &Case) -> Option<[f64; 5]> {
        let line = self.known.get(&self.key(kind, case))?;
        let fields: Vec<f64> = line
            .iter()
            .skip(FIELDS - 5)
            .map_while(|field| field.parse().ok())
            .collect();
        fields.try_into().ok().filter(|_| line.len() == FIELDS)
    }

    /// Appends a ride result.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add_ride(&self, case: &Case, ride: &Ride) -> Result<(), LedgerError> {
        let flag = f64::from(u8::from(ride.completed));
        self.add(
            "ride",
            case,
            [
                ride.driver_rms_m_s2,
                ride.passenger_rms_m_s2,
                ride.driver_msdv_m_s1_5,
                ride.passenger_msdv_m_s1_5,
                flag,
            ],
        )
    }

    /// Appends a handling result.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add_handling(&self, case: &Case, handling: &Handling) -> Result<(), LedgerError> {
        let flag = |b: bool| f64::from(u8::from(b));
        self.add(
            "handling",
            case,
            [
                handling.max_roll_rad,
                handling.max_lateral_m_s2,
                handling.cone_margin_m,
                flag(handling.completed),
                flag(handling.rolled_over),
            ],
        )
    }

    fn add(&self, kind: &str, case: &Case, values: [f64; 5]) -> Result<(), LedgerError> {
        let Some((path, file)) = &self.file else { return Ok(()) };
        let wrap = |problem| LedgerError {
            path: path.clone(),
            problem,
        };
        let mut line = csv::Writer::from_writer(Vec::new());
        let numbers = case.numbers().into_iter().chain(values).map(|value| value.to_string());
        line.write_record([self.key(kind, case), kind.to_owned()].into_iter().chain(numbers))
            .map_err(|error| wrap(error.into()))?;
        let line = line.into_inner().map_err(|error| wrap(error.into_error()))?;
        // One write a line: whole lines only, whatever the thread.
        let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
        file.write_all(&line).map_err(wrap)
    }
}

/// Fields of a line: key, kind, the four numbers of the case, five results.
const FIELDS: usize = 11;

/// Everything but the case, as text.
fn base(bench: &Bench) -> String {
    let conditions = &bench.conditions;
    format!(
        "{MODEL_VERSION}|{}|{}|{conditions:?}",
        bench.parameters.to_toml(),
        bench.handling.to_toml()
    )
}

#[cfg(test)]
mod tests {
    use super::super::case::Conditions;
    use super::*;
    use crate::handling::HandlingParameters;
    use crate::vehicle::VehicleParameters;

    fn bench(seed: u64) -> Bench {
        let conditions = Conditions {
            ride_duration_s: 1.0,
            seed,
            ..Conditions::default()
        };
        Bench::new(
            VehicleParameters::defender110(),
            HandlingParameters::defender110(),
            conditions,
        )
        .unwrap()
    }

    #[test]
    fn remembers_across_openings_and_skips_what_was_cut_short() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("runs.csv");
        let bench = bench(1);
        let (a, b) = (Case::alike(1e-4, 0.8), Case::alike(2e-4, 0.8));
        let ride = Ride {
            driver_rms_m_s2: 1.0 / 3.0,
            passenger_rms_m_s2: 0.1,
            driver_msdv_m_s1_5: 2.0,
            passenger_msdv_m_s1_5: 3.0,
            completed: true,
        };
        let handling = Handling {
            max_roll_rad: 0.123_456_789_012_345_67,
            max_lateral_m_s2: 5.0,
            cone_margin_m: -0.1,
            completed: false,
            rolled_over: true,
        };
        let ledger = Ledger::open(&path, &bench).unwrap();
        ledger.add_ride(&a, &ride).unwrap();
        ledger.add_handling(&a, &handling).unwrap();
        ledger.add_ride(&b, &ride).unwrap();
        let again = Ledger::open(&path, &bench).unwrap();
        assert_eq!((again.ride(&a), again.handling(&a)), (Some(ride), Some(handling)));
        assert_eq!((again.ride(&b), again.handling(&b)), (Some(ride), None));

        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, &text[..text.len() - 9]).unwrap();
        let cut = Ledger::open(&path, &bench).unwrap();
        assert_eq!((cut.ride(&a), cut.ride(&b)), (Some(ride), None));
        cut.add_ride(&b, &ride).unwrap();
        assert_eq!(Ledger::open(&path, &bench).unwrap().ride(&b), Some(ride));
    }

    #[test]
    fn another_condition_is_another_key() {
        let (one, other) = (Ledger::in_memory(&bench(1)), Ledger::in_memory(&bench(2)));
        let case = Case::alike(1e-4, 0.8);
        assert_ne!(one.key("ride", &case), other.key("ride", &case));
        assert_ne!(one.key("ride", &case), one.key("handling", &case));
    }
}
