//! Topics: which columns a message contains, its JSON Schema, and its text.
//!
//! A column belongs to a corner if its name says so: `p1_front_left_Pa` is the field `p1_Pa` of the topic `/front_left`. What the controller
//! or the bus says has a topic of its own, and all else is of the body.

use oleo_interface::Corner;
use oleo_report::rounded;
use serde::Serializer as _;
use serde_json::{Map, json};

/// What a field holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A number, with nine significant digits.
    Number,
    /// A word, such as the name of a mode.
    Word,
}

/// A value of a column. A number that is not finite and an empty word are left out of the message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// A word.
    Word(&'static str),
}

/// A column: its name with unit, and what it holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name with unit, such as `p1_front_left_Pa`.
    pub name: String,
    /// What it holds.
    pub kind: Kind,
}

impl Column {
    /// A column of numbers.
    pub fn number(name: impl Into<String>) -> Self {
        let (name, kind) = (name.into(), Kind::Number);
        Self { name, kind }
    }

    /// A column of words.
    pub fn word(name: impl Into<String>) -> Self {
        let (name, kind) = (name.into(), Kind::Word);
        Self { name, kind }
    }
}

/// Columns by which rows are told apart. The time of a message says the first, its topic the second.
const KEYS: [&str; 2] = ["time_s", "drive"];

/// What the controller commands and says.
const CONTROLLER: [&str; 12] = [
    "valve_word",
    "energised_word",
    "front_valves_open",
    "rear_valves_open",
    "handling",
    "rollover_guard",
    "lateral_rms_m_s2",
    "vertical_rms_m_s2",
    "invalid_readings",
    "lost_messages_word",
    "mode",
    "fault",
];

/// What is on the bus.
pub(super) const BUS: [&str; 4] = ["frames_sent", "frames_received", "load_500k", "load_1m"];

/// Part of the vehicle that a topic is about.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Part {
    Body,
    Corner(Corner),
    Controller,
    Bus,
}

impl Part {
    fn all() -> impl Iterator<Item = Self> {
        (std::iter::once(Self::Body))
            .chain(Corner::ALL.map(Self::Corner))
            .chain([Self::Controller, Self::Bus])
    }

    fn topic(self) -> &'static str {
        match self {
            Self::Body => "body",
            Self::Corner(corner) => corner.key(),
            Self::Controller => "controller",
            Self::Bus => "bus",
        }
    }

    fn schema(self) -> &'static str {
        match self {
            Self::Body => "oleo.Body",
            Self::Corner(_) => "oleo.Corner",
            Self::Controller => "oleo.Controller",
            Self::Bus => "oleo.Bus",
        }
    }
}

/// The part that a column belongs to and its name there; `None` for a key.
fn place(column: &str) -> Option<(Part, String)> {
    if KEYS.contains(&column) {
        return None;
    }
    let of_corner = |corner: Corner| {
        let (before, after) = column.split_once(&format!("_{}", corner.key()))?;
        Some((Part::Corner(corner), format!("{before}{after}")))
    };
    Corner::ALL.into_iter().find_map(of_corner).or_else(|| {
        let part = if CONTROLLER.contains(&column) {
            Part::Controller
        } else if BUS.contains(&column) {
            Part::Bus
        } else {
            Part::Body
        };
        Some((part, column.to_owned()))
    })
}

struct Field {
    name: String,
    kind: Kind,
    /// Position of its value in a row.
    at: usize,
}

/// A topic with the fields of its messages.
pub struct Topic {
    /// Name that begins with a slash.
    pub name: String,
    /// Name of its schema.
    pub schema: &'static str,
    fields: Vec<Field>,
}

impl Topic {
    /// The topics of rows with these columns. `run` is the first part of their names where a file has several runs.
    pub fn of(run: Option<&str>, columns: &[Column]) -> Vec<Self> {
        let places: Vec<_> = columns.iter().map(|column| place(&column.name)).collect();
        let topic = |part: Part| {
            let fields = places
                .iter()
                .zip(columns)
                .enumerate()
                .filter_map(|(at, (place, column))| {
                    let (_, name) = place.as_ref().filter(|(own, _)| *own == part)?;
                    Some(Field {
                        name: name.clone(),
                        kind: column.kind,
                        at,
                    })
                });
            Self {
                name: match run {
                    Some(run) => format!("/{run}/{}", part.topic()),
                    None => format!("/{}", part.topic()),
                },
                schema: part.schema(),
                fields: fields.collect(),
            }
        };
        Part::all()
            .map(topic)
            .filter(|topic| !topic.fields.is_empty())
            .collect()
    }

    /// The JSON Schema of the topic's messages.
    pub fn json_schema(&self) -> String {
        let properties: Map<_, _> = (self.fields.iter())
            .map(|field| {
                let of_type = match field.kind {
                    Kind::Number => "number",
                    Kind::Word => "string",
                };
                (field.name.clone(), json!({ "type": of_type }))
            })
            .collect();
        json!({ "title": self.schema, "type": "object", "properties": properties }).to_string()
    }

    /// Appends the topic's message of a row as JSON.
    pub fn write(&self, row: &[Value], out: &mut Vec<u8>) {
        let fields = self.fields.iter().filter_map(|field| {
            let value = match *row.get(field.at)? {
                Value::Number(number) if number.is_finite() => json!(rounded(number)),
                Value::Word(word) if !word.is_empty() => json!(word),
                _ => return None,
            };
            Some((&field.name, value))
        });
        // Writing to memory does not fail.
        let _ = serde_json::Serializer::new(out).collect_map(fields);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_go_to_the_topic_of_their_part() {
        let columns = [
            Column::number("time_s"),
            Column::number("rear_left_acceleration_m_s2"),
            Column::number("p1_rear_left_Pa"),
            Column::number("valve1_rear_left"),
            Column::word("mode"),
            Column::number("frames_sent"),
        ];
        let topics = Topic::of(Some("soft"), &columns);
        let fields = |topic: &Topic| topic.fields.iter().map(|field| field.name.clone()).collect::<Vec<_>>();
        let found: Vec<(&str, Vec<String>)> = topics.iter().map(|t| (t.name.as_str(), fields(t))).collect();
        let expected = [
            ("/soft/body", vec!["rear_left_acceleration_m_s2"]),
            ("/soft/rear_left", vec!["p1_Pa", "valve1"]),
            ("/soft/controller", vec!["mode"]),
            ("/soft/bus", vec!["frames_sent"]),
        ];
        assert_eq!(
            found,
            expected.map(|(topic, fields)| (topic, fields.into_iter().map(str::to_owned).collect()))
        );
        let schema = r#"{"properties":{"p1_Pa":{"type":"number"},"valve1":{"type":"number"}},"title":"oleo.Corner","type":"object"}"#;
        assert_eq!(topics[1].json_schema(), schema);
    }

    #[test]
    fn a_message_has_the_digits_of_the_files_and_leaves_out_what_is_missing() {
        let columns = [
            Column::number("a_m"),
            Column::number("b_m"),
            Column::word("c"),
            Column::word("d"),
        ];
        let topics = Topic::of(None, &columns);
        let row = [
            Value::Number(2.0 / 3.0),
            Value::Number(f64::NAN),
            Value::Word("normal"),
            Value::Word(""),
        ];
        let mut text = Vec::new();
        topics[0].write(&row, &mut text);
        assert_eq!(String::from_utf8_lossy(&text), r#"{"a_m":0.666666667,"c":"normal"}"#);
    }
}
