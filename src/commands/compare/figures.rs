//! The figures of a summary, each under one name.

use serde_json::Value;

/// A figure of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Figure {
    /// A number in the unit that its name ends in.
    Number(f64),
    /// A name, yes or no, or `none`.
    Word(String),
}

/// Keys that say where a summary comes from, and those that the wall clock decides.
const NO_FIGURES: [&str; 9] = [
    "schema",
    "command",
    "version",
    "inputs",
    "seed",
    "wall_s",
    "real_time_factor",
    "runtime_s",
    "lateness",
];

impl Figure {
    /// Whether two figures are the same, to the last digit.
    pub fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Number(a), Self::Number(b)) => a == b || (a.is_nan() && b.is_nan()),
            _ => self == other,
        }
    }
}

/// All figures of a summary or of a part of it. Elements of a list are numbered from 0 behind a point.
pub fn figures(summary: &Value) -> Vec<(String, Figure)> {
    let mut found = Vec::new();
    if let Value::Object(entries) = summary {
        for (key, value) in entries.iter().filter(|(key, _)| !NO_FIGURES.contains(&key.as_str())) {
            collect(key, value, &mut found);
        }
    }
    found
}

fn collect(name: &str, value: &Value, found: &mut Vec<(String, Figure)>) {
    let figure = match value {
        Value::Number(number) => Figure::Number(number.as_f64().unwrap_or(f64::NAN)),
        Value::String(word) => Figure::Word(word.clone()),
        Value::Bool(true) => Figure::Word("yes".into()),
        Value::Bool(false) => Figure::Word("no".into()),
        Value::Null => Figure::Word("none".into()),
        Value::Array(values) => {
            for (i, value) in values.iter().enumerate() {
                collect(&format!("{name}.{i}"), value, found);
            }
            return;
        }
        Value::Object(entries) => {
            for (key, value) in entries {
                collect(&format!("{name}.{key}"), value, found);
            }
            return;
        }
    };
    found.push((name.to_owned(), figure));
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn provenance_and_wall_clock_are_no_figures() {
        let summary = json!({
            "schema": 1, "inputs": [], "wall_s": 0.3, "max_roll_deg": 2.5, "ending": null,
            "valve_switches": [1, 2], "modes": [{ "tick": 3, "mode": "safe" }],
        });
        let number = |name: &str, value| (name.to_owned(), Figure::Number(value));
        let expected = [
            ("ending".to_owned(), Figure::Word("none".into())),
            number("max_roll_deg", 2.5),
            ("modes.0.mode".to_owned(), Figure::Word("safe".into())),
            number("modes.0.tick", 3.0),
            number("valve_switches.0", 1.0),
            number("valve_switches.1", 2.0),
        ];
        let mut found = figures(&summary);
        found.sort_by(|a, b| a.0.cmp(&b.0));
        assert_eq!(found, expected);
    }
}
