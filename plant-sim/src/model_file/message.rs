//! Converts the error messages of toml and serde into this project's terms, with the path of the key.

use super::document::{Document, line_at};
use super::error::ModelFileError;
use super::names::suggestion;

/// The complaint of toml or serde about a text, with its line and key.
pub(super) fn in_file(error: &toml::de::Error, text: &str, file: &str) -> ModelFileError {
    let line = error.span().map(|span| line_at(text, span.start));
    let what = match Document::parse(text) {
        Err(_) => format!("this is not TOML: {}", error.message()),
        Ok(document) => {
            let path = error.span().map(|span| document.path_at(&span)).unwrap_or_default();
            sentence(&path, error.message())
        }
    };
    ModelFileError::new(file, line, what.trim())
}

/// A complaint of serde about the key or table at a path.
fn sentence(path: &super::KeyPath, message: &str) -> String {
    if let Some(rest) = message.strip_prefix("missing field ") {
        let key = quoted(rest).next().unwrap_or(rest).to_owned();
        return format!("{} is missing: add it", path.clone().then(key));
    }
    if message.starts_with("unknown field ") {
        let known: Vec<&str> = alternatives(message).collect();
        let key = path.steps().last().map_or(String::new(), |step| match step {
            super::Step::Key(key) => key.to_string(),
            super::Step::Entry(_) => String::new(),
        });
        return format!("{path} is not a known key: {}", suggestion(&key, &known, "known keys"));
    }
    if let Some(rest) = message.strip_prefix("unknown variant ") {
        let known: Vec<&str> = alternatives(message).collect();
        let name = rest
            .split_once("`, expected")
            .map_or(rest, |(name, _)| name)
            .trim_start_matches('`');
        let words = if known.len() == 1 { "" } else { "one of " };
        return format!("{path} is {name:?}: must be {words}{}", known.join(", "));
    }
    if let Some((found, wanted)) = (message.strip_prefix("invalid type: "))
        .or_else(|| message.strip_prefix("invalid value: "))
        .and_then(|rest| rest.split_once(", expected "))
    {
        return format!("{path} is {}: must be {}", found_value(found), wanted_type(wanted));
    }
    if let Some((found, wanted)) =
        (message.strip_prefix("invalid length ")).and_then(|rest| rest.split_once(", expected "))
    {
        return format!("{path} has {found} entries: must be {}", wanted_type(wanted));
    }
    format!("{path} {message}")
}

/// The words between backquotes.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// What serde would have accepted in place of an unknown name.
fn alternatives(message: &str) -> impl Iterator<Item = &str> {
    quoted(message.rsplit_once(", expected ").map_or("", |(_, known)| known))
}

/// A value as serde describes it: "integer `3`", "string \"fast\"", "sequence".
fn found_value(found: &str) -> String {
    match found {
        "sequence" => "an array".to_owned(),
        "map" => "a table".to_owned(),
        _ => match (quoted(found).next(), found.strip_prefix("string ")) {
            (Some(number), _) => number.to_owned(),
            (None, Some(string)) => format!("the text {string}"),
            (None, None) => found.to_owned(),
        },
    }
}

/// A type as serde names it.
fn wanted_type(wanted: &str) -> String {
    match wanted {
        "f64" | "f32" => "a number".to_owned(),
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number".to_owned(),
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number, 0 or more".to_owned(),
        "a string" | "a borrowed string" => "a text in quotation marks".to_owned(),
        "a sequence" => "an array".to_owned(),
        "a map" => "a table".to_owned(),
        _ if wanted.starts_with("struct ") => "a table".to_owned(),
        _ => match wanted.strip_prefix("an array of length ") {
            Some(length) => format!("an array of {length} entries"),
            None => wanted.to_owned(),
        },
    }
}
