//! `oleo study`: which springs and dampers suit the ride, and which suit the handling (report 3.2).

mod drive;
mod optimise;
mod sweep;

use std::process::ExitCode;

use crate::failure::Failure;

/// Compare or optimise gas volumes and damper characteristics for ride and handling.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  oleo study sweep --check --out study\n  oleo study optimise --ride 1 --roll 0 --out study\n\n\
                  Both commands store every finished run in DIR/runs.csv and use the runs that they find there. An interrupted \
                  command resumes when it is repeated with the same DIR."
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
