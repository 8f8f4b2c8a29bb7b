//! `oleo compare`: runs beside each other, or recordings beside what models predict of them.
//!
//! ```text
//!   folders, CSV files, recordings and models --> run: groups of runs
//!        figures, traces                              |
//!             \---------------------- differences <---+--- tolerance
//!                                          |
//!                         sheet: summary, CSV <--+--> page, tables (quantity: units; drawn: which)
//! ```

mod difference;
mod differences;
mod drawn;
mod figures;
mod page;
mod quantity;
mod run;
mod sheet;
mod tables;
mod tolerance;
mod traces;

use std::path::PathBuf;
use std::process::ExitCode;

use oleo_plant_sim::model_file::names::did_you_mean;

use self::differences::Differences;
use self::tolerance::{Allowed, Tolerance};
use super::column_map::column_map;
use crate::failure::Failure;
use crate::results::ResultsArgs;

/// Compare runs with the first of them, or recordings with what models predict of them: every figure and every trace
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  oleo drive --manoeuvre lane-change --setting soft,stiff,controlled,baseline --out four\n  \
                  oleo compare four --reference stiff\n  \
                  oleo compare before after --tolerance max_roll_deg=5% --tolerance roll_rad=0.002\n  \
                  oleo compare first second --equal\n  \
                  oleo compare soft stiff --over distance --trace roll_rad\n  \
                  oleo compare --model believed.toml --model found/model.toml campaign/slow_hold.csv --tolerance force_N=1.2x\n\n\
                  A folder of oleo drive may hold several runs. Runs are compared at the samples of the first one; the others are \
                  interpolated, and signals are held. Wall-clock times are not compared.\n\n\
                  Exit status: 0 if all tolerances are met or none were given, 1 if one is not, 2 if an input was bad."
)]
pub struct Args {
    /// Folders of results of oleo hil or oleo drive, or CSV files with time_s; with --model, recordings
    #[arg(value_name = "RUN", required = true)]
    runs: Vec<PathBuf>,
    /// Model whose prediction is compared with each recording; it may be given several times
    #[arg(long, value_name = "MODEL.toml")]
    model: Vec<PathBuf>,
    /// Map of the columns of recordings that another program wrote (docs/diagnose.md)
    #[arg(long, value_name = "MAP.toml", requires = "model")]
    columns: Option<PathBuf>,
    /// Name of the run that the others are compared with [default: the first; of the runs in a folder the first by name]
    #[arg(long, value_name = "NAME", conflicts_with = "model")]
    reference: Option<String>,
    /// What the traces are compared over
    #[arg(long, value_enum, default_value_t = Over::Time, conflicts_with = "model")]
    over: Over,
    /// Trace that is drawn; it may be given several times [default: the motion of the body, the struts and the valves; of a
    /// recording all channels]
    #[arg(long, value_name = "COLUMN")]
    trace: Vec<String>,
    /// How far a figure, or the RMS of a trace's difference, may be from the first run: a number in its unit, a percentage of the
    /// first run's, or with x a multiple of the sensor noise that the model states. For signals a share of the samples, 0 to 1. Words
    /// must be the same
    #[arg(long, value_name = "NAME=VALUE[%|x]")]
    tolerance: Vec<Tolerance>,
    /// File of tolerances: a table [tolerance] with lines such as max_roll_deg = "5 %". --tolerance overrides it
    #[arg(long, value_name = "FILE.toml")]
    tolerances: Option<PathBuf>,
    /// Every figure and every trace must be there in all runs and the same to the last digit
    #[arg(long)]
    equal: bool,
    #[command(flatten)]
    results: ResultsArgs,
}

/// Axis of a comparison.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Over {
    /// Time from the start
    Time,
    /// Position along the road
    Distance,
}

impl Over {
    /// Name of the column.
    fn column(self) -> &'static str {
        match self {
            Self::Time => "time_s",
            Self::Distance => "station_m",
        }
    }
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode, Failure> {
    let mut inputs: Vec<PathBuf> = args.runs.iter().flat_map(|operand| run::files(operand)).collect();
    inputs.extend(args.model.iter().chain(&args.columns).chain(&args.tolerances).cloned());
    let out = args.results.stage("oleo compare", "compare", inputs)?;
    let mut tolerances = args.tolerance.clone();
    if let Some(path) = &args.tolerances {
        let given = |name: &str| args.tolerance.iter().any(|tolerance| tolerance.name == name);
        tolerances.extend(
            tolerance::read(path)?
                .into_iter()
                .filter(|of_file| !given(&of_file.name)),
        );
    }
    run::check_operands(&args.runs)?;
    let groups = if args.model.is_empty() {
        let mut group = run::of_results(&args.runs)?;
        if let Some(reference) = &args.reference {
            group.put_first(reference)?;
        }
        vec![group]
    } else {
        let map = args.columns.as_deref().map(column_map).transpose()?;
        run::of_recordings(&args.runs, &args.model, map.as_ref())?
    };
    let axis = args.over.column();
    let found = (groups.iter())
        .map(|group| Differences::of(group, axis, &tolerances))
        .collect::<Result<Vec<_>, Failure>>()?;
    let known: Vec<&str> = found.iter().flat_map(Differences::names).collect();
    for Tolerance { name, allowed } in &tolerances {
        is_known("--tolerance", name, "figure or trace", &known)?;
        if matches!(allowed, Allowed::Noise(_)) && !groups.iter().any(|group| group.noise.contains_key(name)) {
            return Err(Failure::new(format!(
                "--tolerance {name}={allowed}: no model states a noise of {name}; give a number or a percentage"
            )));
        }
    }
    let traces: Vec<&str> = found.iter().flat_map(Differences::trace_names).collect();
    for trace in &args.trace {
        is_known("--trace", trace, "trace", &traces)?;
    }
    let sheet = sheet::Sheet {
        axis,
        equal: args.equal,
        drawn: drawn::Drawn::of(&args.trace),
        compared: groups.iter().zip(&found).collect(),
    };
    let passed = sheet.publish(&args.results, out)?;
    Ok(if passed { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Refuses a name that no run has.
fn is_known(option: &str, name: &str, what: &str, known: &[&str]) -> Result<(), Failure> {
    if known.contains(&name) {
        return Ok(());
    }
    let hint = match did_you_mean(name, known.iter().copied()) {
        Some(meant) => format!("did you mean {meant}?"),
        None => "the names are in the table All figures and in the headers of the CSV files".to_owned(),
    };
    Err(Failure::new(format!(
        "{option} {name}: no run has such a {what}: {hint}"
    )))
}
