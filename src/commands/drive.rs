//! `oleo drive`: the vehicle through a manoeuvre, with the ride model, the handling model or both.

mod arguments;
mod course;
mod sheet;
mod suspension;

use std::process::ExitCode;

pub use arguments::Args;

use super::parameter_files::parameters;
use crate::failure::Failure;
use arguments::Model;
use course::Course;

/// Runs the command.
pub fn run(args: Args) -> Result<ExitCode, Failure> {
    let out = args.out.as_ref().map(oleo_report::OutputDirectory::stage).transpose()?;
    let (vehicle, handling) = parameters(args.vehicle.as_ref(), args.handling.as_ref())?;
    let course = Course::new(&args, vehicle, handling)?;
    let mut runs = Vec::new();
    if args.model != Model::Handling {
        runs.push(("ride model", course.ride(args.setting)?));
    }
    if args.model != Model::Ride {
        runs.push(("handling model", course.handling(args.setting)?));
    }
    sheet::publish(&course, args.setting, &runs, out)?;
    Ok(ExitCode::SUCCESS)
}
