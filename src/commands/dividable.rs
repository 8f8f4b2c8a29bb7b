//! The commands whose studies can be divided, read from a command line or from the arguments that a shard holds.

use std::ffi::OsString;

use clap::{CommandFactory, Parser, Subcommand};

use super::{diagnose, study};
use crate::failure::Failure;
use crate::shard::{Request, arguments};

#[derive(Parser)]
#[command(name = "oleo")]
struct Line {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Study(study::Args),
    Diagnose(diagnose::Args),
}

/// The study that a command line (without the program) asks for.
pub fn request(words: &[String]) -> Result<Request, Failure> {
    match Line::try_parse_from(line(words)) {
        Ok(Line { command }) => match command {
            Command::Study(args) => args.request(),
            Command::Diagnose(args) => args.request(),
        },
        Err(error) => Err(refused(words, &error)),
    }
}

/// The arguments of a command line in one form.
pub fn arguments_of(words: &[String]) -> Result<Vec<String>, Failure> {
    arguments::of(Line::command(), line(words))
}

fn line(words: &[String]) -> impl Iterator<Item = OsString> {
    std::iter::once("oleo")
        .chain(words.iter().map(String::as_str))
        .map(OsString::from)
}

/// The first line of a complaint says what is wrong.
fn refused(words: &[String], error: &clap::Error) -> Failure {
    let text = error.to_string();
    let first = text.lines().next().unwrap_or("cannot be read");
    Failure::new(format!(
        "oleo {}: {}; give oleo study sweep, control, robust or fleet, or oleo diagnose --self-test",
        arguments::quoted(words),
        first.trim_start_matches("error: ")
    ))
}
