//! `oleo bench`: what the work of the other commands costs as it grows.
//!
//! ```text
//!   curve (sizes) --> point: a process of its own (work, resources) --> measurement (medians of repeats)
//!         --> growth (exponent, words) --> sheet (summary.json, points.csv, report.html)
//! ```
//!
//! Every point runs in a process of its own, so that its peak memory is its own and nothing is warm from another point. The
//! repeats go round all points, so that a machine that slows down slows all of them down alike. Times are the result here and differ between
//! runs; what is computed does not, and is compared between the repeats.

mod curve;
mod growth;
mod instructions;
mod measurement;
mod point;
mod process;
mod resources;
mod sheet;
mod work;

use std::path::PathBuf;
use std::process::ExitCode;

use oleo_report::OutputDirectory;

use super::word::described;
use crate::failure::Failure;
use crate::results::{ResultsArgs, command_line, origin, say};
use curve::Curve;
use measurement::{Extent, measure};
use point::Point;
use process::Part;

/// Measure what the work of the other commands costs as it grows: time, memory, and the exponent of the growth.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  oleo bench --quick --out bench                   half a minute\n  oleo bench --out bench                           about 15 minutes on 2 cores\n  \
    oleo bench --curve vehicles --repeats 3 --out bench\n  oleo bench --curve log-frames --instructions     counts instructions too (valgrind)\n\n\
    Every point runs in a process of its own, which measures its processor time, wall clock and peak memory. The exponent is the slope of \
    processor time over work with both logarithmic: 1 is linear. Clocks depend on what else the machine does; compare exponents and \
    ratios of one run, and instructions between runs (docs/performance.md)."
)]
pub struct Args {
    /// Curve that is measured; may be repeated [default: all]
    #[arg(long, value_name = "NAME", value_parser = described::<Curve>(Curve::in_words))]
    curve: Vec<Curve>,
    /// Number of times that each point is measured, 1 to 100; points that take long are measured fewer times, but three
    #[arg(long, value_name = "N", default_value_t = 5)]
    repeats: u32,
    /// Measure few small points only
    #[arg(long)]
    quick: bool,
    /// Count instructions too, with valgrind, of the points that take less than half a second
    #[arg(long)]
    instructions: bool,
    /// Do the work of one point in this process, and print what it cost
    #[arg(long, hide = true, value_name = "CURVE:SIZE", requires = "scratch")]
    point: Option<Point>,
    /// Do only this part of the point
    #[arg(long, hide = true, requires = "point", value_name = "PART")]
    only: Option<Part>,
    /// Folder for the files of points
    #[arg(long, hide = true, value_name = "DIR")]
    scratch: Option<PathBuf>,
    #[command(flatten)]
    results: ResultsArgs,
}

/// Most repeats of a point.
const MOST_REPEATS: u32 = 100;

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode, Failure> {
    if let (Some(point), Some(scratch)) = (args.point, &args.scratch) {
        say(&process::here(point, scratch, args.only)?)?;
        return Ok(ExitCode::SUCCESS);
    }
    if !(1..=MOST_REPEATS).contains(&args.repeats) {
        return Err(Failure::new(format!(
            "--repeats {}: give a number from 1 to {MOST_REPEATS}",
            args.repeats
        )));
    }
    if args.instructions {
        instructions::require()?;
    }
    let curves = match args.curve.is_empty() {
        true => Curve::ALL.to_vec(),
        false => Curve::ALL
            .into_iter()
            .filter(|curve| args.curve.contains(curve))
            .collect(),
    };
    let mut out = (args.results).stage("oleo bench", "bench", Vec::new())?;
    let (scratch, _kept) = scratch()?;
    let extent = Extent {
        quick: args.quick,
        repeats: args.repeats,
        instructions: args.instructions,
    };
    let measured = measure(&curves, &extent, &scratch)?;
    let text = sheet::text(&measured);
    if let Some(out) = &mut out {
        sheet::write(out, &measured, &extent, &command_line())?;
    }
    args.results.publish(out, &text)?;
    Ok(ExitCode::SUCCESS)
}

/// A folder for the files of points. It is staged like results and never committed, so that it is removed in every case, Ctrl-C included.
fn scratch() -> Result<(PathBuf, OutputDirectory), Failure> {
    let folder = std::env::temp_dir().join(format!("oleo-bench-{}", std::process::id()));
    let mut staged = OutputDirectory::stage(folder, origin("oleo bench", Vec::new()), false)?;
    let inside = staged.path("points/here")?;
    let folder = inside.parent().map(PathBuf::from).unwrap_or_default();
    Ok((folder, staged))
}
