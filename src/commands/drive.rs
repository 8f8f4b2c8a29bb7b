//! `oleo drive`: drives a vehicle through a manoeuvre with one model or both, with one suspension or several.

mod arguments;
mod page;
mod sheet;

use std::path::PathBuf;
use std::process::ExitCode;

use oleo_hil::drive::{Plan, drive, series};
use oleo_hil::parameter_files::Parameters;
use oleo_hil::telemetry::write_series;
use oleo_plant_sim::road;

pub use arguments::Args;

use super::course_arguments::run_failure;
use super::mcap::program;
use crate::failure::Failure;

/// Runs the command.
pub fn run(args: Args) -> Result<ExitCode, Failure> {
    let request = args.request();
    request.refuse_unused().map_err(run_failure)?;
    let road = args.road.as_ref().filter(|road| !road::NAMES.contains(&road.as_str()));
    let files = [&args.vehicle, &args.handling, &args.strut];
    let files = files.into_iter().flatten().cloned();
    let inputs: Vec<PathBuf> = files.chain(road.map(PathBuf::from)).collect();
    let mcap = args.mcap.stage(&inputs, args.results.force())?;
    let name = format!("drive-{}", args.manoeuvre.name());
    let out = args.results.stage("oleo drive", &name, inputs)?;
    let parameters = Parameters::read(args.vehicle.as_ref(), args.handling.as_ref(), args.strut.as_ref())?;
    let plan = Plan::new(&request, &parameters).map_err(run_failure)?;
    let drives = drive(&plan, &request)?;
    if let Some(mcap) = mcap {
        mcap.write(|out| write_series(out, &program(), &series(&drives)))?;
    }
    sheet::publish(&plan, &args, &parameters, &drives, out)?;
    Ok(ExitCode::SUCCESS)
}
