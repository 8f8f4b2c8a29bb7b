//! What is taken of a log: the messages of the database that the map names, and for each the readings that it carries.

use embedded_can::Id;
use oleo_interface::{Corner, Corners, PressurePoint, StrutPressures};
use oleo_plant_sim::rig::unit_size;

use super::database::{Database, Definition};
use super::decoder::Decoder;
use super::map::{COLUMNS, OpenValue, SignalMap, Source, VALVES};

/// Values in the column of a valve.
const OPEN: f64 = 1.0;
/// Values in the column of a valve.
const CLOSED: f64 = 0.0;

/// What is taken of a log.
pub struct Selection {
    /// The bus, where the map names one.
    pub bus: Option<String>,
    /// The messages.
    pub messages: Vec<Selected>,
    /// Valves without a signal, with their value.
    pub fixed: Vec<(Target, f64)>,
    /// Steps between two readings.
    pub steps: Corners<Steps>,
}

/// Steps between two readings of a strut; 0 of a floating-point number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Steps {
    /// Step of the displacement, m.
    pub displacement_m: f64,
    /// Steps of the pressures, Pa.
    pub pressure_pa: StrutPressures<f64>,
}

/// A message, and the readings that it carries.
pub struct Selected {
    /// Its name in the database.
    pub name: String,
    /// Its identifier.
    pub id: Id,
    /// Its readings.
    pub readings: Vec<Reading>,
}

/// A column of a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Target {
    /// The corner.
    pub corner: Corner,
    /// Position among [`COLUMNS`].
    pub column: usize,
}

/// A reading in a message.
pub struct Reading {
    /// Where it belongs.
    pub target: Target,
    /// Whether it is sent when it changes only.
    pub on_change: bool,
    decoder: Decoder,
    meaning: Meaning,
    /// Another signal, and the value that it must have.
    valid: Option<(Decoder, f64)>,
}

enum Meaning {
    /// `(value - zero) size` is the reading in SI units.
    Number { zero: f64, size: f64 },
    /// The valve is open at this value, within half a step, or at any but 0.
    Valve { open: Option<f64> },
}

impl Reading {
    /// The reading in a frame, in SI units, or 0 and 1 of a valve; `None` if there is none.
    pub fn value(&self, data: &[u8]) -> Option<f64> {
        if let Some((decoder, is)) = &self.valid
            && decoder
                .value(data)
                .is_none_or(|value| (value - is).abs() > 0.5 * decoder.step())
        {
            return None;
        }
        let value = self.decoder.value(data)?;
        Some(match self.meaning {
            Meaning::Number { zero, size } => (value - zero) * size,
            Meaning::Valve { open: None } => f64::from(u8::from(value != 0.0)),
            Meaning::Valve { open: Some(open) } => {
                f64::from(u8::from((value - open).abs() <= 0.5 * self.decoder.step()))
            }
        })
    }
}

impl Selection {
    /// Looks the signals of a map up in a database. `file` is the map's name in errors.
    ///
    /// # Errors
    /// Signals that are not there, units that are not known; one line.
    pub fn of(map: &SignalMap, database: &Database, file: &str) -> Result<Self, String> {
        let mut out = Self {
            bus: map.bus.clone(),
            messages: Vec::new(),
            fixed: Vec::new(),
            steps: Corners::default(),
        };
        let corners = map.corners();
        for corner in Corner::ALL {
            for (column, name) in COLUMNS.into_iter().enumerate() {
                let Some(source) = corners[corner].get(name) else {
                    continue;
                };
                let target = Target { corner, column };
                let place = |what: String| format!("{file}: [{}] {name}: {what}", corner.key());
                let Some(signal) = &source.signal else {
                    let value = if source.always.as_deref() == Some("open") {
                        OPEN
                    } else {
                        CLOSED
                    };
                    out.fixed.push((target, value));
                    continue;
                };
                let mut definition = database.signal(signal).map_err(place)?;
                if source.ignore_range {
                    definition.decoder = definition.decoder.without_range();
                }
                let valid = valid(source, &definition, database).map_err(place)?;
                let meaning = meaning(source, &definition, target).map_err(place)?;
                out.enter_step(target, &meaning, &definition.decoder);
                let message = out.messages.iter().position(|message| message.id == definition.id);
                let message = message.unwrap_or_else(|| {
                    out.messages.push(Selected {
                        name: definition.message.clone(),
                        id: definition.id,
                        readings: Vec::new(),
                    });
                    out.messages.len() - 1
                });
                out.messages[message].readings.push(Reading {
                    target,
                    on_change: source.on_change,
                    decoder: definition.decoder,
                    meaning,
                    valid,
                });
            }
        }
        Ok(out)
    }

    fn enter_step(&mut self, target: Target, meaning: &Meaning, decoder: &Decoder) {
        let Meaning::Number { size, .. } = meaning else { return };
        let (step, steps) = (decoder.step() * size.abs(), &mut self.steps[target.corner]);
        match target
            .column
            .checked_sub(1)
            .and_then(|point| PressurePoint::ALL.get(point))
        {
            Some(point) => steps.pressure_pa[*point] = step,
            None => steps.displacement_m = step,
        }
    }
}

fn valid(source: &Source, definition: &Definition, database: &Database) -> Result<Option<(Decoder, f64)>, String> {
    let Some(valid) = &source.valid else { return Ok(None) };
    let other = database.signal(&valid.signal)?;
    if other.id != definition.id {
        return Err(format!(
            "valid.signal is {} of the message {}; name a signal of the same message, {}",
            valid.signal, other.message, definition.message
        ));
    }
    Ok(Some((other.decoder, valid.is)))
}

fn meaning(source: &Source, definition: &Definition, target: Target) -> Result<Meaning, String> {
    if VALVES.contains(&target.column) {
        let open = match &source.open {
            None => None,
            Some(OpenValue::Number(value)) => Some(*value),
            Some(OpenValue::Label(label)) => Some(labelled(label, definition)?),
        };
        return Ok(Meaning::Valve { open });
    }
    let name = COLUMNS[target.column];
    let size = match &source.unit {
        Some(unit) => unit_size(name, unit).map_err(without_name)?,
        None => unit_size(name, definition.unit.trim()).map_err(|what| {
            format!(
                "the database states the unit {:?}; add unit = \"...\" ({})",
                definition.unit,
                without_name(what)
            )
        })?,
    };
    Ok(Meaning::Number {
        zero: source.zero,
        size: size * f64::from(source.sign),
    })
}

/// The message of [`unit_size`] without the name of the column, which the caller states with the corner.
fn without_name(what: String) -> String {
    what.split_once(": ").map_or(what.clone(), |(_, what)| what.to_owned())
}

fn labelled(label: &str, definition: &Definition) -> Result<f64, String> {
    let found = definition.labels.iter().find(|(name, _)| name == label);
    found.map(|(_, value)| *value).ok_or_else(|| {
        let names: Vec<&str> = definition.labels.iter().map(|(name, _)| name.as_str()).collect();
        match names.is_empty() {
            true => "the database names no values of this signal; state open as a number".to_owned(),
            false => format!(
                "the database does not name a value {label:?}; its names are {}",
                names.join(", ")
            ),
        }
    })
}
