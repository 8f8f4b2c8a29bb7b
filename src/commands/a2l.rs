//! `oleo a2l`: writes the description file by which calibration tools read the controller.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::failure::Failure;

/// Write the description file (A2L) by which calibration tools read the controller by XCP on CAN.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  oleo a2l --out oleo.a2l\n  oleo hil --bus socketcan:vcan0 --clock realtime --xcp     the controller that the file describes\n\n\
    The program must be built with the feature `xcp` or `calibration`: cargo build --release --features xcp. With `calibration` the parameters of \
    the file can be written. docs/xcp.md describes all quantities."
)]
pub struct Args {
    /// File that is written
    #[arg(long, value_name = "FILE.a2l")]
    out: PathBuf,
    /// Bit rate of the bus, bit/s
    #[arg(long, value_name = "BIT_RATE", default_value = "500000",
          value_parser = PossibleValuesParser::new(["500000", "1000000"]).try_map(|rate| rate.parse::<u32>()))]
    bit_rate: u32,
    /// Replace a file of a campaign
    #[arg(long)]
    force: bool,
}

/// Runs the command.
///
/// # Errors
/// The file cannot be written.
#[cfg(feature = "xcp")]
pub fn run(args: &Args) -> Result<ExitCode, Failure> {
    let out = oleo_report::OutputFile::stage(&args.out, &[], args.force)?;
    let text = oleo_xcp::a2l::description(args.bit_rate).map_err(|error| Failure::new(error.to_string()))?;
    let out = out.bytes(text.as_bytes())?;
    crate::results::say(&format!("{}\n{}\n", oleo_xcp::identity(), out.display()))?;
    Ok(ExitCode::SUCCESS)
}

/// Runs the command.
///
/// # Errors
/// This program has no XCP.
#[cfg(not(feature = "xcp"))]
pub fn run(args: &Args) -> Result<ExitCode, Failure> {
    let Args {
        out,
        bit_rate: _,
        force: _,
    } = args;
    Err(Failure::new(format!(
        "{}: this program was built without XCP; build it with `cargo build --release --features xcp`",
        out.display()
    )))
}
