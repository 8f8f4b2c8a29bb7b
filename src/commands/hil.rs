//! `oleo hil`: the loop of controller and plant over a CAN bus.

use std::process::ExitCode;

use crate::failure::Failure;

/// Drive the vehicle with controller and plant talking only through CAN frames.
#[derive(clap::Args)]
pub struct Args {}

/// Runs the command.
pub fn run(_args: Args) -> Result<ExitCode, Failure> {
    Ok(ExitCode::SUCCESS)
}
