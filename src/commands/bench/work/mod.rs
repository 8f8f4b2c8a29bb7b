//! The work of the points: inputs from fixed seeds, made before the clock starts, and the code of the command that does such work.

mod candidates;
mod contract;
mod log;
mod rig;
mod samples;
mod vehicles;

use std::path::Path;

use super::curve::Curve;
use super::point::Point;
use crate::failure::Failure;
use contract::Work;

/// Gets ready for the work of a point. Files are made in `scratch`.
pub fn prepare(point: Point, scratch: &Path) -> Result<Box<dyn Work>, Failure> {
    Ok(match point.curve {
        Curve::Vehicles => Box::new(vehicles::Vehicles::prepare(point.size)?),
        Curve::Samples => Box::new(samples::Samples::prepare(point.size, scratch)?),
        Curve::Candidates => Box::new(candidates::Candidates::prepare(point.size)?),
        Curve::LogFrames => Box::new(log::Conversion::prepare(point.size, scratch, "asc")?),
        Curve::LogColumns => Box::new(log::Conversion::prepare(point.size, scratch, "csv")?),
    })
}
