//! The map from signals of a CAN database to what the diagnosis reads of a vehicle.
//!
//! ```toml
//! bus = "2"                # only where the log has several buses with the same identifiers
//!
//! [front_left]             # front_right, rear_left and rear_right too
//! displacement_m = { signal = "RIDE_HEIGHT.FrontLeft", unit = "mm", zero = 312.0, sign = -1 }
//! p1_Pa = { signal = "PRESSURE_FL.P1", unit = "bar", valid = { signal = "PRESSURE_FL.State", is = 0 } }
//! p2_Pa = { signal = "PRESSURE_FL.P2" }                     # the unit is that of the database
//! p3_Pa = { signal = "PRESSURE_FL.P3" }
//! p4_Pa = { signal = "PRESSURE_FL.P4" }
//! valve1 = { signal = "VALVES.FrontLeft1" }                 # open unless 0
//! valve2 = { signal = "VALVES.FrontLeft2", open = "Auf", on_change = true }
//! valve3 = { always = "closed" }
//! ```
//!
//! A reading is `sign (value - zero)` in SI units, where `value` and `zero` are in the unit of the signal: displacement from the static
//! position with compression positive, and pressure above that of the atmosphere (`zero = 1.01325` for a sensor of absolute
//! pressure in bar).

use std::collections::BTreeMap;

use oleo_interface::{Corner, Corners};
use oleo_plant_sim::model_file::names::suggestion;
use serde::Deserialize;

/// Our names of what is read of a strut: displacement, four pressures, three valves.
pub const COLUMNS: [&str; 8] = [
    "displacement_m",
    "p1_Pa",
    "p2_Pa",
    "p3_Pa",
    "p4_Pa",
    "valve1",
    "valve2",
    "valve3",
];

/// Positions of the valves in [`COLUMNS`].
pub const VALVES: std::ops::Range<usize> = 5..8;

/// A map as its file states it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SignalMap {
    /// The bus of the log: the interface of candump, the number of the channel in ASC and MF4.
    pub bus: Option<String>,
    front_left: BTreeMap<String, Source>,
    front_right: BTreeMap<String, Source>,
    rear_left: BTreeMap<String, Source>,
    rear_right: BTreeMap<String, Source>,
}

/// From where one of [`COLUMNS`] is taken.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// Name of the signal: `MESSAGE.Signal`, or `Signal` if only one message has it.
    pub signal: Option<String>,
    /// Its unit; that of the database unless stated.
    pub unit: Option<String>,
    /// -1 where it counts the other way.
    #[serde(default = "positive")]
    pub sign: i8,
    /// Its value that is our zero, in its unit.
    #[serde(default)]
    pub zero: f64,
    /// Its value for an open valve, as a number or as the database names it. A valve is open unless 0 if nothing is stated.
    pub open: Option<OpenValue>,
    /// Whether the signal of a valve is sent when it changes, and not again and again.
    #[serde(default)]
    pub on_change: bool,
    /// For a valve without a signal: `open` or `closed`.
    pub always: Option<String>,
    /// Whether values outside the range that the database states are readings too.
    #[serde(default)]
    pub ignore_range: bool,
    /// Another signal of the same message that says whether the value means something.
    pub valid: Option<Valid>,
}

fn positive() -> i8 {
    1
}

/// What the signal of a valve holds while the valve is open.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum OpenValue {
    /// A value.
    Number(f64),
    /// A name that the database has for a value.
    Label(String),
}

/// A signal that says whether others mean something.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Valid {
    /// Its name.
    pub signal: String,
    /// Its value where they do.
    pub is: f64,
}

impl SignalMap {
    /// Reads a map. `file` is the name that appears in errors.
    ///
    /// # Errors
    /// Unknown keys, columns that are missing, sources that contradict themselves; one line with file, place, what to do.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, String> {
        let map: Self = toml::from_str(text).map_err(|error| {
            let line = error
                .span()
                .and_then(|span| text.get(..span.start))
                .map(|before| before.matches('\n').count() + 1);
            let place = line.map_or_else(String::new, |line| format!(":{line}"));
            format!("{file}{place}: {}", error.message().replace('\n', " "))
        })?;
        let corners = map.corners();
        for corner in Corner::ALL {
            let sources = corners[corner];
            if let Some(unknown) = sources.keys().find(|name| !COLUMNS.contains(&name.as_str())) {
                let rest = suggestion(unknown, &COLUMNS, "columns");
                return Err(format!(
                    "{file}: [{}] {unknown} is not a column of a strut: {rest}",
                    corner.key()
                ));
            }
            for name in COLUMNS {
                let source = sources.get(name).ok_or_else(|| missing(file, corner, name))?;
                source
                    .check(name)
                    .map_err(|what| format!("{file}: [{}] {name}: {what}", corner.key()))?;
            }
        }
        Ok(map)
    }

    /// The sources of every corner.
    #[must_use]
    pub fn corners(&self) -> Corners<&BTreeMap<String, Source>> {
        Corners::from_array([&self.front_left, &self.front_right, &self.rear_left, &self.rear_right])
    }
}

fn missing(file: &str, corner: Corner, name: &str) -> String {
    let example = match name.starts_with("valve") {
        true => format!("{name} = {{ signal = \"MESSAGE.Signal\" }}, or {name} = {{ always = \"closed\" }}"),
        false => format!("{name} = {{ signal = \"MESSAGE.Signal\", unit = \"...\" }}"),
    };
    format!("{file}: [{}] has no {name}; add {example}", corner.key())
}

impl Source {
    fn check(&self, name: &str) -> Result<(), String> {
        let is_valve = name.starts_with("valve");
        if self.sign != 1 && self.sign != -1 {
            return Err(format!("sign is {}; it is 1 or -1", self.sign));
        }
        if !self.zero.is_finite() {
            return Err(format!(
                "zero is {}; it is a number in the unit of the signal",
                self.zero
            ));
        }
        match (&self.signal, self.always.as_deref()) {
            (Some(_), Some(_)) => return Err("has a signal and always; leave one of them out".to_owned()),
            (None, None) => return Err("names no signal; add signal = \"MESSAGE.Signal\"".to_owned()),
            (None, Some("open" | "closed")) if is_valve => {}
            (None, Some(_)) if is_valve => return Err("always is \"open\" or \"closed\"".to_owned()),
            (None, Some(_)) => return Err("always is for valves; a reading needs a signal".to_owned()),
            (Some(_), None) => {}
        }
        if !is_valve && (self.open.is_some() || self.on_change) {
            return Err("open and on_change are for valves; leave them out".to_owned());
        }
        if is_valve && (self.unit.is_some() || self.sign != 1 || self.zero != 0.0) {
            return Err(
                "unit, sign and zero are not for valves; state its value for an open valve with open".to_owned(),
            );
        }
        Ok(())
    }
}
