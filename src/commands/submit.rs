//! `oleo submit`: runs the missing shards of a study as an array of jobs of Slurm, and the merge behind them.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use super::dividable;
use crate::failure::Failure;
use crate::results::{default_path, say};
use crate::shard::{Identity, Part, Request, ShardFolder, in_words};
use crate::slurm::{Scripts, queue};

/// Run a study on a cluster with Slurm: an array of jobs for the shards that are missing, and the merge when they are finished.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  oleo submit --shards 12 --dry-run -- study robust --vehicles 1000 --out robust\n  \
    oleo submit --shards 500 --sbatch=--partition=short --sbatch=--time=60 -- study robust --vehicles 100000 --out robust\n\n\
    The shards go into robust.shards, beside the logs of the jobs, and the results into robust. Repeat the command after a failure: shards \
    that are finished are not run again. All machines must see the current folder and this program under the same paths (docs/scale.md)."
)]
pub struct Args {
    /// Number of shards. A shard should have work for half a minute or more
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    shards: u32,
    /// Folder of the shards [default: that of --out of the study, with .shards behind its name]
    #[arg(long, value_name = "DIR")]
    folder: Option<PathBuf>,
    /// Option for sbatch, such as --sbatch=--partition=short; may be repeated
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    sbatch: Vec<String>,
    /// Print the scripts, and submit and write nothing
    #[arg(long)]
    dry_run: bool,
    /// The study, as it would be run undivided
    #[arg(value_name = "COMMAND", required = true, last = true)]
    command: Vec<String>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode, Failure> {
    let Request { study, results, shard } = dividable::request(&args.command)?;
    if shard.is_given() {
        return Err(Failure::new(
            "--shard: oleo submit gives every job its own; leave the option out",
        ));
    }
    let about = study.about();
    let (first, of) = (
        Part {
            number: 1,
            of: args.shards,
        },
        args.shards,
    );
    first.check(study.cases())?;
    let identity = Identity::of(&about, dividable::arguments_of(&args.command)?)?;
    let out = match results.out() {
        Some(out) => out.to_path_buf(),
        None => default_path(&about.name)?,
    };
    let path = args.folder.clone().unwrap_or_else(|| with_end(&out, ".shards"));
    if let Some(option) = args
        .sbatch
        .iter()
        .find(|option| !option.starts_with('-') || option.contains('\n'))
    {
        return Err(Failure::new(format!(
            "--sbatch {option}: is no option of sbatch; write it as --sbatch=--partition=short"
        )));
    }
    let missing = ShardFolder::missing(&path, of, &identity)?;
    let scripts = Scripts {
        name: &about.name,
        program: &program()?,
        arguments: &identity.arguments,
        shards: &absolute(&path)?,
        out: &absolute(&out)?,
        of,
        options: &args.sbatch,
    };
    let numbers: Vec<u32> = missing.iter().map(|part| part.number).collect();
    let (array, merge) = (scripts.array(&numbers), scripts.merge());
    if args.dry_run {
        if !missing.is_empty() {
            say(&format!("{array}\n"))?;
        }
        say(&merge)?;
        return Ok(ExitCode::SUCCESS);
    }
    queue::refuse_without_slurm()?;
    let folder = ShardFolder::create(path)?;
    queue::refuse_while_running(folder.path())?;
    let jobs = queue::submit(folder.path(), (!missing.is_empty()).then_some(array.as_str()), &merge)?;
    let what = match (&jobs.array, numbers.len()) {
        (Some(array), count) => format!("job {array}: {count} of {of} shards ({})", in_words(&numbers)),
        (None, _) => format!("all {of} shards are finished"),
    };
    say(&format!(
        "{what}\njob {}: the merge of all shards\n{}\n",
        jobs.merge,
        out.display()
    ))?;
    Ok(ExitCode::SUCCESS)
}

/// A folder's name with `end` behind it.
fn with_end(folder: &Path, end: &str) -> PathBuf {
    // Without the slash that a user may have typed behind the name.
    let mut name = folder.components().as_path().as_os_str().to_owned();
    name.push(end);
    name.into()
}

fn absolute(path: &Path) -> Result<String, Failure> {
    let absolute = std::path::absolute(path)?;
    (absolute.to_str().map(str::to_owned))
        .filter(|text| !text.contains(['\n', '%']))
        .ok_or_else(|| {
            Failure::new(format!(
                "{}: cannot be named in a script; use another folder",
                path.display()
            ))
        })
}

fn program() -> Result<String, Failure> {
    absolute(&std::env::current_exe()?)
}
