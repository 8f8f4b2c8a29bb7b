//! Runs a study whole, in part, or from the shards of all its parts. This is the only place that knows the difference.

use std::path::PathBuf;
use std::process::ExitCode;

use oleo_report::OutputDirectory;

use super::arguments::quoted;
use super::file::ShardFile;
use super::folder::ShardFolder;
use super::identity::Identity;
use super::merge::Shards;
use super::part::{Part, ShardArgs};
use super::study::{About, Kept, Study, Work};
use crate::failure::Failure;
use crate::results::{ResultsArgs, command_line, say};

/// A study of any kind.
pub trait AnyStudy {
    /// What it is called, and what it reads.
    fn about(&self) -> About;
    /// Number of its cases.
    fn cases(&self) -> usize;
    /// Runs all cases that its folder does not know, and writes the results.
    fn whole(&self, results: &ResultsArgs) -> Result<ExitCode, Failure>;
    /// Runs a part and writes its shard.
    fn part(&self, part: Part, folder: PathBuf, force: bool, identity: Identity) -> Result<ExitCode, Failure>;
    /// Writes the results from the shards of all parts.
    fn merged(&self, shards: &Shards, results: &ResultsArgs) -> Result<ExitCode, Failure>;
}

/// A study that a command line asks for.
pub struct Request {
    pub study: Box<dyn AnyStudy>,
    pub results: ResultsArgs,
    pub shard: ShardArgs,
}

/// Runs what is asked for. `arguments` are those of the command in one form.
pub fn conduct(
    request: &Request,
    arguments: impl FnOnce() -> Result<Vec<String>, Failure>,
) -> Result<ExitCode, Failure> {
    let Request { study, results, shard } = request;
    let Some(part) = shard.part()? else {
        return study.whole(results);
    };
    let about = study.about();
    let identity = Identity::of(&about, arguments()?)?;
    let (folder, force) = results.of_shards(&about.name)?;
    study.part(part, folder, force, identity)
}

impl<S: Study> AnyStudy for S {
    fn about(&self) -> About {
        Study::about(self)
    }

    fn cases(&self) -> usize {
        Study::cases(self)
    }

    fn whole(&self, results: &ResultsArgs) -> Result<ExitCode, Failure> {
        let about = Study::about(self);
        let inputs = about.inputs.clone();
        let (out, ledger) = results.stage_with_ledger(&about.command, &about.name, inputs, about.ledger)?;
        let ledger = self.ledger(ledger.as_deref().map_or(Kept::Nowhere, Kept::In))?;
        let all: Vec<usize> = (0..Study::cases(self)).collect();
        let outcomes = self.run(&all, &ledger, &Work::on(&about, all.len()))?;
        report(self, outcomes, out, results, &command_line())
    }

    fn part(&self, part: Part, folder: PathBuf, force: bool, identity: Identity) -> Result<ExitCode, Failure> {
        let (about, all) = (Study::about(self), Study::cases(self));
        part.check(all)?;
        let folder = ShardFolder::create(folder)?;
        let path = folder.finished(part);
        // A file that is no whole shard is what an accident left, and is written anew.
        let finished = || ShardFile::read(&path).ok().filter(|_| !force);
        if let Some(difference) = finished().and_then(|there| identity.difference(&there.header.identity)) {
            return Err(Failure::new(format!(
                "{}: {difference}; name another folder with --out, or add --force to replace it",
                path.display()
            )));
        }
        let begun = folder.begin(part, &identity)?;
        // Asked when no other process can finish it any more.
        if finished().is_some() {
            let _ = std::fs::remove_file(&begun.ledger);
            say(&format!("shard {part} is finished already\n{}\n", path.display()))?;
            return Ok(ExitCode::SUCCESS);
        }
        let cases = part.cases(all);
        let ledger = self.ledger(Kept::In(&begun.ledger))?;
        self.run(&cases, &ledger, &Work::on(&about, cases.len()))?;
        let kept = std::fs::read_to_string(&begun.ledger)
            .map_err(|error| Failure::new(format!("{}: cannot be read: {error}", begun.ledger.display())))?;
        let shard = ShardFile::new(identity, part, all, &kept);
        // What the shard holds must give every outcome again: whoever merges it cannot run it.
        read_outcomes(self, &about, &shard.lines, &cases).map_err(|error| {
            Failure::new(format!(
                "shard {part}: a finished run is not as it was kept: {error}; this is a fault of oleo"
            ))
        })?;
        shard.write(&path)?;
        let _ = std::fs::remove_file(&begun.ledger);
        say(&format!(
            "shard {part} is finished: {} of {all} cases\n{}\n",
            cases.len(),
            path.display()
        ))?;
        Ok(ExitCode::SUCCESS)
    }

    fn merged(&self, shards: &Shards, results: &ResultsArgs) -> Result<ExitCode, Failure> {
        let (about, all) = (Study::about(self), Study::cases(self));
        let out = results.stage(&about.command, &about.name, about.inputs.clone())?;
        let mut outcomes: Vec<Option<S::Outcome>> = (0..all).map(|_| None).collect();
        for shard in shards.read() {
            let shard = shard?;
            let part = shard.header.part();
            let cases = part.cases(all);
            let read = read_outcomes(self, &about, &shard.lines, &cases).map_err(|_| {
                Failure::new(format!(
                    "{}: lacks a run of its cases; remove it and run --shard {part} again",
                    shards.path(part).display()
                ))
            })?;
            for (case, outcome) in cases.into_iter().zip(read) {
                outcomes[case] = Some(outcome);
            }
        }
        let outcomes: Vec<S::Outcome> = outcomes.into_iter().flatten().collect();
        let command = format!("oleo {}", quoted(&shards.header.identity.arguments));
        report(self, outcomes, out, results, &command)
    }
}

/// The outcomes of cases from lines of finished runs; nothing is run.
fn read_outcomes<S: Study>(study: &S, about: &About, lines: &str, cases: &[usize]) -> Result<Vec<S::Outcome>, Failure> {
    let ledger = study.ledger(Kept::Text(lines))?;
    study.run(cases, &ledger, &Work::reading(about, cases.len()))
}

fn report<S: Study>(
    study: &S,
    outcomes: Vec<S::Outcome>,
    mut out: Option<OutputDirectory>,
    results: &ResultsArgs,
    command: &str,
) -> Result<ExitCode, Failure> {
    let said = study.report(outcomes, out.as_mut(), command)?;
    results.publish(out, &said.text)?;
    Ok(said.status)
}
