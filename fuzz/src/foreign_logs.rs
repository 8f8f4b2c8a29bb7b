//! What reads the logs and the CAN databases of other programs.

use oleo_hil::signal_log::{Database, Selection, SignalMap};

use super::frames_of;

/// An MDF 4 file, and whatever else a log may be.
pub fn mf4(bytes: &[u8]) {
    frames_of(bytes);
}

/// A CAN database. A signal that is found has finite values in every frame.
pub fn can_database(bytes: &[u8]) {
    let database = match Database::from_bytes(bytes, "any.dbc") {
        Ok(database) => database,
        Err(error) => return assert!(!error.is_empty() && !error.contains('\n'), "{error}"),
    };
    for name in ["M.S", "S", "M.T", "T"] {
        match database.signal(name) {
            Ok(signal) => {
                for data in [&[][..], &[0xFF; 8], &[0x5A; 64]] {
                    assert!(signal.decoder.value(data).is_none_or(f64::is_finite));
                }
            }
            Err(error) => assert!(!error.is_empty() && !error.contains('\n'), "{error}"),
        }
    }
}

/// A map of signals, with a database in which it may find them.
pub fn signal_map(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let database = include_bytes!("../../hil/src/signal_log/invented_car.dbc");
    let database = Database::from_bytes(database, "car.dbc").expect("a database");
    let selection = SignalMap::from_toml(text, "any.toml").and_then(|map| Selection::of(&map, &database, "any.toml"));
    if let Err(error) = selection {
        assert!(!error.is_empty() && !error.contains('\n'), "{error}");
    }
}
