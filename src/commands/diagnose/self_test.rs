//! `oleo diagnose --self-test`: measures how good the diagnosis is on campaigns whose answers are known.

use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

use oleo_diagnose::selftest::{Case, Flaw, Ledger, Plan, Subject, Summary, csv_rows, page, run, save, tables};
use oleo_report::Progress;

use crate::failure::Failure;
use crate::results::{ResultsArgs, command_line, say};

/// What results say of where they come from.
const COMMAND: &str = "oleo diagnose --self-test";

/// Options of the self-test.
#[derive(clap::Args)]
// Flattened into the command's own `Args`: two groups of one name are refused.
#[group(id = "self-test arguments")]
pub struct Args {
    /// Diagnose simulated campaigns whose models leave known effects out, and report detection rate (power), confusion,
    /// coverage of the confidence intervals, and false alarms
    #[arg(long, conflicts_with = "campaign", help_heading = "Self-test")]
    pub self_test: bool,
    /// Number of simulated campaigns [default: 70, which is every term twice]
    #[arg(
        long,
        value_name = "N",
        default_value_t = 70,
        requires = "self_test",
        help_heading = "Self-test",
        hide_default_value = true
    )]
    campaigns: usize,
    /// Seed of all random draws
    #[arg(
        long,
        value_name = "S",
        default_value_t = 1,
        requires = "self_test",
        help_heading = "Self-test"
    )]
    seed: u64,
    /// Conceal only these, separated by commas: ids of effects, none (the model is complete), pair (two effects) or
    /// periodic (a law without a name that swings in time, in six places and three sizes) [default: all but periodic]
    #[arg(
        long,
        value_name = "A,B",
        value_delimiter = ',',
        requires = "self_test",
        help_heading = "Self-test"
    )]
    terms: Vec<String>,
    /// Remove each concealed term from the search, so that it can only be found as a law without a name
    #[arg(long, requires = "self_test", help_heading = "Self-test")]
    without_names: bool,
    /// Record with instruments as they are, one of these flaws a campaign in turn: coloured_noise, twelve_bit, spikes, hum, jitter,
    /// noise_twice, noise_half, no_force, no_pressure, or all
    #[arg(
        long,
        value_name = "A,B",
        value_delimiter = ',',
        requires = "self_test",
        help_heading = "Self-test"
    )]
    instruments: Vec<String>,
    /// Write the simulated campaigns and their answers into DIR instead of diagnosing them
    #[arg(long, requires = "self_test", help_heading = "Self-test")]
    save: bool,
    /// Number of campaigns that run at the same time, one thread each [default: all cores]
    #[arg(long, value_name = "N", requires = "self_test", help_heading = "Self-test")]
    threads: Option<usize>,
}

/// Writes the campaigns and their answers.
fn save_campaigns(cases: &[Case], results: &ResultsArgs) -> Result<ExitCode, Failure> {
    let Some(mut out) = results.stage(COMMAND, "self-test-campaigns", Vec::new())? else {
        return Err(Failure::new(
            "--no-out: there is nowhere to write the campaigns to; leave it out",
        ));
    };
    out.fill(|folder| {
        cases
            .iter()
            .try_for_each(|case| save(case, folder))
            .map_err(Failure::from)
    })?;
    say(&format!("{}\n", out.commit()?.display()))?;
    Ok(ExitCode::SUCCESS)
}

/// Runs the self-test; finished campaigns are kept in the folder, where another run goes on.
pub fn run_self_test(args: &Args, results: &ResultsArgs) -> Result<ExitCode, Failure> {
    let plan = Plan {
        seed: args.seed,
        campaigns: args.campaigns,
        subjects: args
            .terms
            .iter()
            .map(|t| t.parse())
            .collect::<Result<Vec<Subject>, _>>()?,
        without_names: args.without_names,
        flaws: Flaw::listed(&args.instruments)?,
    };
    if plan.without_names && plan.subjects.iter().any(|s| !matches!(s, Subject::Effect(_))) {
        return Err(Failure::new(
            "--terms: none and pair cannot be combined with --without-names; give ids of effects",
        ));
    }
    let cases = plan.cases();
    if cases.is_empty() {
        return Err(Failure::new("--campaigns 0: give a number of campaigns above 0"));
    }
    let threads = match args.threads {
        Some(0) => return Err(Failure::new("--threads 0: give a number above 0")),
        Some(threads) => threads,
        None => std::thread::available_parallelism().map_or(1, usize::from),
    };
    if args.save {
        return save_campaigns(&cases, results);
    }
    let (mut staged, ledger) = results.stage_with_ledger(COMMAND, "self-test", Vec::new(), "trials.jsonl")?;
    let ledger = match ledger {
        None => Ledger::in_memory(),
        Some(path) => Ledger::open(&path)?,
    };
    let progress = Progress::new("self-test", cases.len() as u64);
    let trials = run(&cases, &ledger, threads, &AtomicBool::new(false), &|| progress.add(1))?;
    drop(progress);
    let summary = Summary::of(plan.seed, &trials);
    if let Some(out) = &mut staged {
        out.csv_records("trials.csv", csv_rows::trials(&trials))?;
        out.csv_records("power.csv", csv_rows::power(&summary))?;
        out.csv_records("confusion.csv", csv_rows::confusion(&summary))?;
        out.csv_records("coverage.csv", csv_rows::coverage(&summary))?;
        out.summary("summary.json", Some(plan.seed), &summary)?;
        out.page(&page(&summary, &command_line()))?;
    }
    let mut text = format!("{} campaigns, seed {}\n", summary.trials, summary.seed);
    for (title, table) in tables(&summary) {
        text += &format!("\n{title}\n{table}\n");
    }
    results.publish(staged, &text)?;
    Ok(ExitCode::SUCCESS)
}
