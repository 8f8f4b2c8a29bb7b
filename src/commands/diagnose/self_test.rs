//! `oleo diagnose --self-test`: measures how good the diagnosis is on campaigns whose answers are known.

use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

use oleo_diagnose::selftest::{Case, Flaw, Ledger, Plan, Subject, Summary, Trial, csv_rows, page, run, save, tables};
use oleo_report::OutputDirectory;

use crate::failure::Failure;
use crate::results::{ResultsArgs, say};
use crate::shard::{About, Kept, Request, Said, ShardArgs, Study, Work, conduct};

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
    /// Conceal only these, separated by commas: ids of effects, none (the model is complete), pair (two effects), triple (three
    /// effects), periodic (a law without a name that swings in time, in six places and three sizes), two_laws (two laws
    /// without a name at different places), wrong_number (a number of the model that is another than believed) or unfamiliar (a
    /// law without a name whose shape no textbook has) [default: all but the last five, which would change what the first N
    /// campaigns of a seed are]
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
    #[command(flatten)]
    shard: ShardArgs,
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
pub fn run_self_test(args: Args, results: ResultsArgs, arguments: Arguments) -> Result<ExitCode, Failure> {
    if args.save {
        if args.shard.is_given() {
            return Err(Failure::new(
                "--shard: --save runs nothing that could be divided; leave one of them out",
            ));
        }
        return save_campaigns(&args.study()?.cases, &results);
    }
    conduct(&args.request(results)?, arguments)
}

/// What gives the arguments of the command.
pub type Arguments = fn() -> Result<Vec<String>, Failure>;

impl Args {
    /// The self-test as a study.
    pub fn request(self, results: ResultsArgs) -> Result<Request, Failure> {
        Ok(Request {
            study: Box::new(self.study()?),
            results,
            shard: self.shard,
        })
    }

    /// Whether a part of the cases is asked for.
    pub fn is_divided(&self) -> bool {
        self.shard.is_given()
    }

    fn study(&self) -> Result<SelfTest, Failure> {
        let plan = Plan {
            seed: self.seed,
            campaigns: self.campaigns,
            subjects: self
                .terms
                .iter()
                .map(|t| t.parse())
                .collect::<Result<Vec<Subject>, _>>()?,
            without_names: self.without_names,
            flaws: Flaw::listed(&self.instruments)?,
        };
        if plan.without_names && plan.subjects.iter().any(|s| !matches!(s, Subject::Effect(_))) {
            return Err(Failure::new(
                "--terms: none, pair, triple, periodic, two_laws and wrong_number cannot be combined with --without-names; give ids of effects",
            ));
        }
        let cases = plan.cases();
        if cases.is_empty() {
            return Err(Failure::new("--campaigns 0: give a number of campaigns above 0"));
        }
        let threads = match self.threads {
            Some(0) => return Err(Failure::new("--threads 0: give a number above 0")),
            Some(threads) => threads,
            None => std::thread::available_parallelism().map_or(1, usize::from),
        };
        Ok(SelfTest {
            seed: plan.seed,
            cases,
            threads,
        })
    }
}

/// The self-test as a study: a case is a campaign.
struct SelfTest {
    seed: u64,
    cases: Vec<Case>,
    threads: usize,
}

impl Study for SelfTest {
    type Ledger = Ledger;
    type Outcome = Trial;

    fn about(&self) -> About {
        About {
            command: COMMAND.to_owned(),
            name: "self-test".to_owned(),
            inputs: Vec::new(),
            ledger: "trials.jsonl",
            steps: 1,
            ends_gracefully: false,
        }
    }

    fn cases(&self) -> usize {
        self.cases.len()
    }

    fn ledger(&self, kept: Kept) -> Result<Ledger, Failure> {
        Ok(match kept {
            Kept::Nowhere => Ledger::in_memory(),
            Kept::In(path) => Ledger::open(path)?,
            Kept::Text(text) => Ledger::of_text(text),
        })
    }

    fn run(&self, cases: &[usize], ledger: &Ledger, work: &Work) -> Result<Vec<Trial>, Failure> {
        let chosen: Vec<Case> = cases.iter().map(|case| self.cases[*case].clone()).collect();
        let stop = AtomicBool::new(work.stops());
        Ok(run(&chosen, ledger, self.threads, &stop, &|| work.done())?)
    }

    fn report(&self, trials: Vec<Trial>, out: Option<&mut OutputDirectory>, command: &str) -> Result<Said, Failure> {
        let summary = Summary::of(self.seed, &trials);
        if let Some(out) = out {
            out.csv_records("trials.csv", csv_rows::trials(&trials))?;
            out.csv_records("power.csv", csv_rows::power(&summary))?;
            out.csv_records("confusion.csv", csv_rows::confusion(&summary))?;
            out.csv_records("coverage.csv", csv_rows::coverage(&summary))?;
            out.summary("summary.json", Some(self.seed), &summary)?;
            out.page(&page(&summary, command))?;
        }
        let mut text = format!("{} campaigns, seed {}\n", summary.trials, summary.seed);
        for (title, table) in tables(&summary) {
            text += &format!("\n{title}\n{table}\n");
        }
        Ok(Said {
            text,
            status: ExitCode::SUCCESS,
        })
    }
}
