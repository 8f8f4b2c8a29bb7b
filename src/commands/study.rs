//! `oleo study`: which springs and dampers suit the ride, which suit the handling (report 3.2), and what the controller gains.

mod control;
mod drive;
mod drives;
mod fleet;
mod mixed_drive;
mod optimise;
mod robust;
mod sweep;

use std::process::ExitCode;

use crate::failure::Failure;
use crate::shard::arguments::of_this_process;
use crate::shard::{Request, conduct};

/// Compare or optimise gas volumes and damper characteristics for ride and handling, or compare the controller with fixed settings.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  oleo study sweep --check --out study\n  oleo study optimise --ride 1 --roll 0 --out optimum\n  oleo study control --out control\n  oleo study robust --vehicles 1000 --out robust\n  oleo study fleet campaigns --out fleet\n\n\
                  Every finished run is stored in DIR/runs.csv (sweep and optimise), DIR/drives.csv (control and robust) or DIR/diagnoses.jsonl (fleet), and runs that are \
                  found there are used. An interrupted command resumes when it is repeated with the same DIR.\n\n\
                  Many machines: with --shard K/N each runs a part of the cases, and oleo merge puts the parts together (docs/scale.md)."
)]
pub struct Args {
    #[command(subcommand)]
    study: Study,
}

#[derive(clap::Subcommand)]
enum Study {
    Sweep(sweep::Args),
    Optimise(optimise::Args),
    Control(control::Args),
    Robust(robust::Args),
    Fleet(fleet::Args),
}

/// Runs the command.
pub fn run(args: Args) -> Result<ExitCode, Failure> {
    match args.study {
        Study::Optimise(args) => optimise::run(&args),
        _ => conduct(&args.request()?, || of_this_process::<Args>("study")),
    }
}

impl Args {
    /// The study that is asked for, if its cases do not depend on each other.
    pub fn request(self) -> Result<Request, Failure> {
        match self.study {
            Study::Sweep(args) => args.request(),
            Study::Control(args) => args.request(),
            Study::Robust(args) => args.request(),
            Study::Fleet(args) => args.request(),
            Study::Optimise(_) => Err(Failure::new(
                "oleo study optimise: each point depends on those before it, so that it has no shards; run it on one machine",
            )),
        }
    }
}
