//! The `oleo` command line: names the commands, hands each its arguments, and turns its answer into an exit status.
//!
//! Everything a command does is in `commands/NAME.rs` (arguments, help and how to run it) and in the library it calls.
//! Exit status: 0 done, 1 a check failed or the verdict is "no", 2 the input was bad or the work could not be done,
//! with one line on standard error that says what, where and what to do.

mod commands;
mod failure;

use std::process::ExitCode;

use clap::builder::styling::{AnsiColor, Styles};
use clap::{Parser, Subcommand};
use failure::Failure;

const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Green.on_default().bold())
    .usage(AnsiColor::Green.on_default().bold())
    .literal(AnsiColor::Cyan.on_default().bold())
    .placeholder(AnsiColor::Cyan.on_default());

/// Controllable hydropneumatic suspension: controller, plant simulator, hardware-in-the-loop, diagnosis.
#[derive(Parser)]
#[command(name = "oleo", version, styles = STYLES, max_term_width = 110, subcommand_required = true)]
#[command(
    after_help = "Exit status: 0 done; 1 a check failed; 2 bad input, with one line saying what, where and what to do."
)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

/// One line a command; its doc comment, arguments and examples are in its own file.
#[derive(Subcommand)]
enum Command {
    Drive(commands::drive::Args),
    Study(commands::study::Args),
    Hil(commands::hil::Args),
    Rig(commands::rig::Args),
    Diagnose(commands::diagnose::Args),
    Predict(commands::predict::Args),
}

fn main() -> ExitCode {
    let answer = match CommandLine::try_parse() {
        Ok(CommandLine { command }) => match command {
            Command::Drive(args) => commands::drive::run(args),
            Command::Study(args) => commands::study::run(args),
            Command::Hil(args) => commands::hil::run(args),
            Command::Rig(args) => commands::rig::run(args),
            Command::Diagnose(args) => commands::diagnose::run(args),
            Command::Predict(args) => commands::predict::run(args),
        },
        Err(error) => failure::usage(&error),
    };
    answer.unwrap_or_else(|failure: Failure| failure.report())
}
