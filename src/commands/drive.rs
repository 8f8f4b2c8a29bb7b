//! `oleo drive`: drives a vehicle through a manoeuvre with the ride model, the handling model or both.

mod arguments;
mod measures;
mod plan;
mod sheet;
mod suspension;

use std::process::ExitCode;

pub use arguments::Args;

use super::parameter_files::parameters;
use crate::failure::Failure;
use arguments::Model;
use plan::Plan;

/// Runs the command.
pub fn run(args: Args) -> Result<ExitCode, Failure> {
    let mut out = args.out.as_ref().map(oleo_report::OutputDirectory::stage).transpose()?;
    if let Some(out) = &mut out {
        out.keep([&args.vehicle, &args.handling].into_iter().flatten());
        out.keep(&args.road);
    }
    let (vehicle, handling) = parameters(args.vehicle.as_ref(), args.handling.as_ref())?;
    let plan = Plan::new(&args, vehicle, handling)?;
    if !(args.score_from_s >= 0.0 && args.score_from_s <= 3600.0) {
        return Err(Failure::new(format!(
            "--score-from-s {}: give a value from 0 to 3600",
            args.score_from_s
        )));
    }
    let mut runs = Vec::new();
    if args.model != Model::Handling {
        runs.push(("ride model", plan.ride(args.setting)?));
    }
    if args.model != Model::Ride {
        runs.push(("handling model", plan.handling(args.setting)?));
    }
    sheet::publish(&plan, &args, &runs, out)?;
    Ok(ExitCode::SUCCESS)
}
