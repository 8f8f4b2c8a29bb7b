//! `oleo study`: which springs and dampers suit the ride, which the handling (seed report 3.2).

mod drive;
mod optimise;
mod sweep;

use std::process::ExitCode;

use crate::failure::Failure;

/// Sweep or optimise gas volume and damping for ride and handling.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  oleo study sweep --check --out study\n  oleo study optimise --ride 1 --roll 0 --out study\n\n\
                  Finished runs are kept in DIR/runs.csv: an interrupted command goes on there, and both commands share it."
)]
pub struct Args {
    #[command(subcommand)]
    study: Study,
}

#[derive(clap::Subcommand)]
enum Study {
    Sweep(sweep::Args),
    Optimise(optimise::Args),
}

/// Runs the command.
pub fn run(args: Args) -> Result<ExitCode, Failure> {
    match args.study {
        Study::Sweep(args) => sweep::run(&args),
        Study::Optimise(args) => optimise::run(&args),
    }
}
