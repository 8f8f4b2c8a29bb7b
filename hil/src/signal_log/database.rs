//! A CAN database: its messages and signals by name.

use can_dbc::{Dbc, DbcError, Message, MessageId, Signal};
use embedded_can::Id;
use oleo_plant_sim::model_file::names::did_you_mean;

use super::decoder::Decoder;
use crate::logs::identifier;

/// A CAN database in the form of Vector (DBC).
pub struct Database {
    file: String,
    content: Dbc,
}

/// A signal of the database.
pub struct Definition {
    /// Name of its message.
    pub message: String,
    /// Identifier of its message.
    pub id: Id,
    /// Decodes its value.
    pub decoder: Decoder,
    /// Its unit as the database spells it.
    pub unit: String,
    /// Names of its values, such as `Open` for 1.
    pub labels: Vec<(String, f64)>,
}

impl Database {
    /// Reads a database. `file` is the name that appears in errors.
    ///
    /// # Errors
    /// Text that is no database, in one line.
    pub fn from_bytes(bytes: &[u8], file: &str) -> Result<Self, String> {
        // Databases are in UTF-8 or, more often, in the code page of Western Windows.
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => text.trim_start_matches('\u{feff}').to_owned(),
            Err(_) => bytes.iter().copied().map(char::from).collect(),
        };
        let content = Dbc::try_from(text.as_str()).map_err(|error| refused(&error, file))?;
        Ok(Self {
            file: file.to_owned(),
            content,
        })
    }

    /// The signal with a name, `MESSAGE.Signal` or, where only one message has such a signal, `Signal`.
    ///
    /// # Errors
    /// No such signal, or several, in one line.
    pub fn signal(&self, name: &str) -> Result<Definition, String> {
        let wrong = |what: String| format!("{}: {what}", self.file);
        let (message, signal) = match name.split_once('.') {
            Some((message, signal)) => {
                let message = self.message(message).map_err(wrong)?;
                (message, self.signal_of(message, signal).map_err(wrong)?)
            }
            None => self.only_signal(name).map_err(wrong)?,
        };
        let full_name = format!("{}.{}", message.name, signal.name);
        let decoder = Decoder::of(&self.content, message, signal)
            .map_err(|what| wrong(format!("the signal {full_name} {what}, which is not read")))?;
        let (number, is_extended) = match message.id {
            MessageId::Standard(id) => (u32::from(id), false),
            MessageId::Extended(id) => (id, true),
        };
        let id = identifier(number, is_extended)
            .ok_or_else(|| wrong(format!("the message {} has the identifier {number:#x}", message.name)))?;
        let labels = self.content.value_descriptions_for_signal(message.id, &signal.name);
        Ok(Definition {
            message: message.name.clone(),
            id,
            decoder,
            unit: signal.unit.clone(),
            labels: (labels.unwrap_or(&[]).iter())
                .map(|label| {
                    (
                        label.description.clone(),
                        label.id as f64 * signal.factor + signal.offset,
                    )
                })
                .collect(),
        })
    }

    fn message(&self, name: &str) -> Result<&Message, String> {
        let messages = &self.content.messages;
        messages.iter().find(|message| message.name == name).ok_or_else(|| {
            let names = messages.iter().map(|message| message.name.as_str());
            format!("has no message {name}{}", meant(name, names))
        })
    }

    fn signal_of<'d>(&self, message: &'d Message, name: &str) -> Result<&'d Signal, String> {
        message
            .signals
            .iter()
            .find(|signal| signal.name == name)
            .ok_or_else(|| {
                let names: Vec<&str> = message.signals.iter().map(|signal| signal.name.as_str()).collect();
                let meant = meant(name, names.iter().copied());
                format!(
                    "the message {} has no signal {name}{meant}; its signals are {}",
                    message.name,
                    names.join(", ")
                )
            })
    }

    fn only_signal(&self, name: &str) -> Result<(&Message, &Signal), String> {
        let all =
            || (self.content.messages.iter()).flat_map(|message| message.signals.iter().map(move |s| (message, s)));
        let found: Vec<_> = all().filter(|(_, signal)| signal.name == name).collect();
        match found.as_slice() {
            [one] => Ok(*one),
            [] => Err(format!(
                "has no signal {name}{}",
                meant(name, all().map(|(_, s)| s.name.as_str()))
            )),
            several => {
                let names: Vec<String> = several.iter().map(|(m, s)| format!("{}.{}", m.name, s.name)).collect();
                Err(format!("has several signals {name}; write one of {}", names.join(", ")))
            }
        }
    }
}

fn meant<'n>(name: &str, known: impl Iterator<Item = &'n str>) -> String {
    did_you_mean(name, known).map_or_else(String::new, |meant| format!("; did you mean {meant}?"))
}

/// What the parser says, in one line with the line of the database.
fn refused(error: &DbcError, file: &str) -> String {
    let text = error.to_string();
    // Its errors of grammar are drawings of several lines: ` --> LINE:COLUMN`, the text, `= expected this or that`.
    let place = (text.split_once("--> ")).and_then(|(_, rest)| rest.split([':', '\n']).next());
    let said = text.lines().last().unwrap_or("").trim().trim_start_matches("= ");
    let place = place.map_or_else(String::new, |line| format!(":{line}"));
    format!("{file}{place}: is no CAN database that can be read ({said}); give a DBC file")
}
