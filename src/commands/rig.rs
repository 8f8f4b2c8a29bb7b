//! `oleo rig`: the simulated strut on the report's test rig. Each measurement has its own file in `rig/`.

mod bulk_modulus;
mod damping;
mod limits;
mod replay;
mod sheet;
mod spring;
mod valve_response;

use std::process::ExitCode;

use crate::failure::Failure;

/// Repeat the report's test-rig measurements on the simulated strut.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  oleo rig spring --out spring\n  oleo rig damping --strut model.toml --out damping\n  \
                  oleo rig limits --static-load-n 4000"
)]
pub struct Args {
    #[command(subcommand)]
    measurement: Measurement,
}

#[derive(clap::Subcommand)]
enum Measurement {
    Spring(spring::Args),
    Damping(damping::Args),
    BulkModulus(bulk_modulus::Args),
    ValveResponse(valve_response::Args),
    Replay(replay::Args),
    Limits(limits::Args),
}

/// Runs the command.
pub fn run(args: Args) -> Result<ExitCode, Failure> {
    match args.measurement {
        Measurement::Spring(args) => spring::run(&args),
        Measurement::Damping(args) => damping::run(&args),
        Measurement::BulkModulus(args) => bulk_modulus::run(&args),
        Measurement::ValveResponse(args) => valve_response::run(&args),
        Measurement::Replay(args) => replay::run(&args),
        Measurement::Limits(args) => limits::run(&args),
    }
}
