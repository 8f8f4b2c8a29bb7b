//! `oleo merge`: makes the results of a study from the shards of its parts.

use std::path::PathBuf;
use std::process::ExitCode;

use super::dividable;
use crate::failure::Failure;
use crate::results::ResultsArgs;
use crate::shard::Shards;

/// Put the shards of a study together: the results are those of the undivided study, to the bit.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  oleo merge shards --out robust\n  oleo merge from-here from-there --out robust\n\n\
    Shards are what oleo study and oleo diagnose --self-test write with --shard K/N into the folder of --out (docs/scale.md). All N must be \
    there, of the same study, seed and inputs and of this version of oleo; what is missing is named. Merge in the folder in which the shards \
    ran, where their inputs are. The exit status is that of the study."
)]
pub struct Args {
    /// Folders of shards
    #[arg(value_name = "FOLDER", required = true)]
    folders: Vec<PathBuf>,
    #[command(flatten)]
    results: ResultsArgs,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode, Failure> {
    let shards = Shards::in_folders(&args.folders)?;
    let identity = &shards.header.identity;
    identity.check_here()?;
    let study = dividable::request(&identity.arguments)?.study;
    if study.cases() != shards.header.cases {
        return Err(Failure::new(format!(
            "the shards are of a study of {} cases, and here it has {}; merge with the program that wrote them",
            shards.header.cases,
            study.cases()
        )));
    }
    study.merged(&shards, &args.results)
}
