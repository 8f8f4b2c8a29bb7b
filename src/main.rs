//! The `oleo` command line: it passes the arguments to the commands and converts their results into an exit status.
//!
//! Everything a command does is in `commands/NAME.rs` (arguments, help and how to run it) and in the library it calls.
//! The exit status is 0 if the command succeeded, 1 if a check failed, 2 if the input was bad or the work could not be
//! done, and 128 and the number of the signal if one stopped it. In the last two cases one line on standard error says what is
//! wrong, where, and what to do.

mod commands;
mod failure;
mod results;
mod shard;
mod slurm;

use std::process::ExitCode;

use clap::builder::styling::{AnsiColor, Styles};
use clap::{CommandFactory, Parser, Subcommand};
use failure::Failure;

const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Green.on_default().bold())
    .usage(AnsiColor::Green.on_default().bold())
    .literal(AnsiColor::Cyan.on_default().bold())
    .placeholder(AnsiColor::Cyan.on_default());

/// Controllable hydropneumatic suspension: controller, plant simulator, hardware-in-the-loop runs and diagnosis.
#[derive(Parser)]
#[command(name = "oleo", version = results::VERSION, styles = STYLES, max_term_width = 110, subcommand_required = true)]
#[command(
    after_help = "Exit status: 0 if the command succeeded, 1 if a check failed, 2 if an input was bad, 128 + N if signal N stopped it. For bad input, one line on standard error says what is wrong, where, and what to do.\n\nWithout --out, results are written to a folder in oleo-out; the last line that a command prints is the path of its page."
)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

/// The commands. The help text, the arguments and the examples of each are in its own file.
#[derive(Subcommand)]
enum Command {
    Drive(commands::drive::Args),
    Study(commands::study::Args),
    Merge(commands::merge::Args),
    Submit(commands::submit::Args),
    Hil(commands::hil::Args),
    Rig(commands::rig::Args),
    Diagnose(commands::diagnose::Args),
    Predict(commands::predict::Args),
    Compare(commands::compare::Args),
    Convert(commands::convert::Args),
    Bench(commands::bench::Args),
    Fmu(commands::fmu::Args),
    A2l(commands::a2l::Args),
    Seal(commands::seal::Args),
    /// Simulates an FMU for the process that started this one, over pipes
    #[cfg(feature = "fmu")]
    #[command(hide = true)]
    FmuChild,
    Show(commands::show::Args),
}

fn main() -> ExitCode {
    let answer = match CommandLine::try_parse() {
        Ok(CommandLine { command }) => match command {
            Command::Drive(args) => commands::drive::run(args),
            Command::Study(args) => commands::study::run(args),
            Command::Merge(args) => commands::merge::run(&args),
            Command::Submit(args) => commands::submit::run(&args),
            Command::Hil(args) => commands::hil::run(args),
            Command::Rig(args) => commands::rig::run(args),
            Command::Diagnose(args) => commands::diagnose::run(args),
            Command::Predict(args) => commands::predict::run(args),
            Command::Compare(args) => commands::compare::run(&args),
            Command::Convert(args) => commands::convert::run(&args),
            Command::Bench(args) => commands::bench::run(&args),
            Command::Fmu(args) => commands::fmu::run(args),
            Command::A2l(args) => commands::a2l::run(&args),
            Command::Seal(args) => commands::seal::run(args),
            #[cfg(feature = "fmu")]
            Command::FmuChild => Ok(oleo_fmu_import::serve()),
            Command::Show(args) => commands::show::run(args, CommandLine::command()),
        },
        Err(error) => failure::usage(&error),
    };
    answer.unwrap_or_else(|failure: Failure| {
        results::tidy();
        failure.report()
    })
}
