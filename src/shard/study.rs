//! What a study must be able to do so that it can be run whole or in parts.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use oleo_report::interrupt::Graceful;
use oleo_report::{OutputDirectory, Progress};

use crate::failure::Failure;

/// What a study is called, and what it reads.
pub struct About {
    /// The command without its options, such as `oleo study robust`.
    pub command: String,
    /// What its folder is called without `--out`.
    pub name: String,
    /// Files that it reads.
    pub inputs: Vec<PathBuf>,
    /// Name of the file of finished runs in the folder of the results.
    pub ledger: &'static str,
    /// Units of progress of a case.
    pub steps: u64,
    /// Whether the first Ctrl-C lets the runs in hand end; otherwise it ends the command at once.
    pub ends_gracefully: bool,
}

/// Where finished runs are kept.
#[derive(Clone, Copy)]
pub enum Kept<'a> {
    /// Forgotten with the program.
    Nowhere,
    /// In a file, to which finished runs are appended.
    In(&'a Path),
    /// Read from this text, and none are added.
    Text(&'a str),
}

/// What a study says at its end.
pub struct Said {
    /// Tables for standard output.
    pub text: String,
    /// Its exit status.
    pub status: ExitCode,
}

/// A study as a list of cases that do not depend on each other.
pub trait Study {
    /// Its finished runs.
    type Ledger;
    /// The outcome of one case.
    type Outcome;

    /// What it is called, and what it reads.
    fn about(&self) -> About;

    /// Number of its cases.
    fn cases(&self) -> usize;

    /// Opens its finished runs.
    fn ledger(&self, kept: Kept) -> Result<Self::Ledger, Failure>;

    /// Runs what the ledger does not know of these cases, and gives the outcomes of all of them in this order.
    fn run(&self, cases: &[usize], ledger: &Self::Ledger, work: &Work) -> Result<Vec<Self::Outcome>, Failure>;

    /// Makes the results of the outcomes of all cases, in their order. `command` is the command line for the page.
    fn report(
        &self,
        outcomes: Vec<Self::Outcome>,
        out: Option<&mut OutputDirectory>,
        command: &str,
    ) -> Result<Said, Failure>;
}

/// The progress of a study, and whether it is to go on.
pub struct Work {
    progress: Progress,
    graceful: Option<Graceful>,
    /// Whether cases may be run that no ledger knows.
    may_run: bool,
}

impl Work {
    /// Work on so many cases of a study.
    pub fn on(about: &About, cases: usize) -> Self {
        let label = about.command.trim_start_matches("oleo ");
        Self {
            progress: Progress::new(label, about.steps * cases as u64),
            graceful: about.ends_gracefully.then(Graceful::begin),
            may_run: true,
        }
    }

    /// Only reads what is known of so many cases.
    pub fn reading(about: &About, cases: usize) -> Self {
        Self {
            may_run: false,
            ..Self::on(about, cases)
        }
    }

    /// One more unit is done.
    pub fn done(&self) {
        self.progress.add(1);
    }

    /// Whether no further run is to be begun.
    pub fn stops(&self) -> bool {
        !self.may_run || self.graceful.as_ref().is_some_and(Graceful::requested)
    }
}
