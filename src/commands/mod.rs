//! One file a command: `pub struct Args` (clap, with units and an example in the help) and
//! `pub fn run(args: Args) -> Result<ExitCode, Failure>`.

pub mod a2l;
pub mod bench;
mod column_map;
pub mod compare;
pub mod convert;
mod course_arguments;
pub mod diagnose;
mod dividable;
pub mod drive;
pub mod fmu;
pub mod hil;
mod mcap;
pub mod merge;
pub mod predict;
mod prediction;
pub mod rig;
pub mod seal;
pub mod show;
pub mod study;
pub mod submit;
mod vehicle_log;
mod word;
