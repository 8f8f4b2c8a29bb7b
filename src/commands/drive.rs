//! `oleo drive`: drives a vehicle through a manoeuvre with one model or both, with one suspension or several.

mod arguments;
mod columns;
mod driven;
mod measures;
mod page;
mod plan;
mod sheet;
mod suspension;

use std::path::PathBuf;
use std::process::ExitCode;

use oleo_plant_sim::road;

pub use arguments::Args;

use super::parameter_files::Parameters;
use crate::failure::Failure;
use plan::Plan;

/// Runs the command.
pub fn run(args: Args) -> Result<ExitCode, Failure> {
    plan::refuse_unused(&args)?;
    let road = args.road.as_ref().filter(|road| !road::NAMES.contains(&road.as_str()));
    let files = [&args.vehicle, &args.handling, &args.strut];
    let files = files.into_iter().flatten().cloned();
    let inputs = files.chain(road.map(PathBuf::from)).collect();
    let name = format!("drive-{}", args.manoeuvre.name());
    let out = args.results.stage("oleo drive", &name, inputs)?;
    let parameters = Parameters::read(args.vehicle.as_ref(), args.handling.as_ref(), args.strut.as_ref())?;
    let plan = Plan::new(&args, &parameters)?;
    if !(args.score_from_s >= 0.0 && args.score_from_s <= 3600.0) {
        return Err(Failure::new(format!(
            "--score-from-s {}: give a value from 0 to 3600",
            args.score_from_s
        )));
    }
    let drives = driven::drive(&plan, &args)?;
    sheet::publish(&plan, &args, &parameters, &drives, out)?;
    Ok(ExitCode::SUCCESS)
}
