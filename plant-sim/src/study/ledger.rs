//! What the sweep and the optimiser have run already, so that an optimiser can use what a sweep has found.
//!
//! A record depends on vehicle and handling parameters, conditions, case, and [`MODEL_VERSION`].

use std::path::Path;

use super::case::{Bench, Case, Handling, Ride};
use super::records::{Records, RecordsError};

/// Raised with every change of the models that changes results.
const MODEL_VERSION: u32 = 4;

/// Results of rides and of lane changes.
pub struct Ledger {
    records: Records,
    base: String,
}

impl Ledger {
    /// A ledger that forgets.
    pub fn in_memory(bench: &Bench) -> Self {
        Self {
            records: Records::in_memory(),
            base: base(bench),
        }
    }

    /// Opens or creates the file `path`.
    ///
    /// # Errors
    /// The file cannot be read or written.
    pub fn open(path: &Path, bench: &Bench) -> Result<Self, RecordsError> {
        Ok(Self {
            records: Records::open(path)?,
            base: base(bench),
        })
    }

    /// A ledger from the text of such a file, to which nothing is added.
    pub fn of_text(text: &str, bench: &Bench) -> Self {
        Self {
            records: Records::of_text(text),
            base: base(bench),
        }
    }

    /// Runs known so far.
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// Whether no run is stored.
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    fn key(&self, kind: &str, case: &Case) -> String {
        let mut text = format!("{}|{kind}", self.base);
        for value in case.numbers() {
            text.push_str(&format!("|{:016x}", value.to_bits()));
        }
        Records::key(&text)
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
        let line = self.records.get(&self.key(kind, case))?;
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
    pub fn add_ride(&self, case: &Case, ride: &Ride) -> Result<(), RecordsError> {
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
    pub fn add_handling(&self, case: &Case, handling: &Handling) -> Result<(), RecordsError> {
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

    fn add(&self, kind: &str, case: &Case, values: [f64; 5]) -> Result<(), RecordsError> {
        let numbers = case.numbers().into_iter().chain(values).map(|value| value.to_string());
        self.records
            .add(&self.key(kind, case), std::iter::once(kind.to_owned()).chain(numbers))
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
