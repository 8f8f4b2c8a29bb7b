//! `oleo seal`: puts the check value into a firmware image, before it is flashed.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use oleo_hil::image::{self, Seal};
use oleo_report::OutputFile;

use crate::failure::Failure;
use crate::results::say;

/// Put the check value of its flash into a firmware image.
///
/// The board compares it whenever it starts, and does not run if the flash holds anything else. An image without it runs, and says so
/// in the message BOARD.
#[derive(Parser)]
#[command(after_help = "Example:
  oleo seal firmware/target/thumbv7em-none-eabihf/release/oleo-firmware     write oleo-firmware.sealed beside it")]
pub struct Args {
    /// The ELF file of `cargo build --release` in firmware/.
    image: PathBuf,
    /// File for the sealed image. The default is the image's name with `.sealed` behind it.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// The file is no image, or the sealed image cannot be written.
pub fn run(args: Args) -> Result<ExitCode, Failure> {
    let path = &args.image;
    let mut bytes = std::fs::read(path).map_err(|e| Failure::new(format!("{}: {e}", path.display())))?;
    let seal = image::seal(&mut bytes).map_err(|e| Failure::new(format!("{}: {e}", path.display())))?;
    let out = args.out.unwrap_or_else(|| {
        let mut name = args.image.clone().into_os_string();
        name.push(".sealed");
        name.into()
    });
    let out = OutputFile::stage(&out, &[args.image], false)?.bytes(&bytes)?;
    let Seal { flash_bytes, crc32 } = seal;
    say(&format!(
        "{}: {flash_bytes} bytes of flash, CRC-32 {crc32:08x}\n",
        out.display()
    ))?;
    Ok(ExitCode::SUCCESS)
}
