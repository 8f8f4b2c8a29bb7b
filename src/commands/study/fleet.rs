//! `oleo study fleet`: diagnoses many campaigns or logs, and counts what is missing where.

mod entry;
mod member;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

use oleo_diagnose::DiagnoseError;
use oleo_diagnose::one_a_thread::one_a_thread;
use oleo_diagnose::vehicle::VehicleModel;
use oleo_report::{Axis, Column, Curves, OutputDirectory, Page, Style, Table, Verdict};
use serde::Serialize;
use serde_json::json;

use crate::commands::vehicle_log::DatabaseArgs;
use crate::failure::Failure;
use crate::results::ResultsArgs;
use crate::shard::{About, Kept, Request, Said, ShardArgs, Study, Work};
use entry::{Entries, Entry};
use member::{Kind, Member};

/// Diagnose every campaign or log of a fleet as oleo diagnose does, and count which effects are missing where
#[derive(clap::Args)]
pub struct Args {
    /// Folder of campaigns (folders with model.toml), or with --vehicle of logs (*.log, *.asc, *.mf4)
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
    /// Model of the vehicles that the logs are of (kind = "vehicle"), beside which the models of its four struts lie
    #[arg(long, value_name = "MODEL.toml")]
    vehicle: Option<PathBuf>,
    #[command(flatten)]
    database: DatabaseArgs,
    /// Number of diagnoses at the same time, one thread each [default: all cores]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    #[command(flatten)]
    results: ResultsArgs,
    #[command(flatten)]
    shard: ShardArgs,
}

/// The study.
struct Fleet {
    kind: Kind,
    members: Vec<Member>,
    inputs: Vec<PathBuf>,
    threads: usize,
}

impl Args {
    /// The study that is asked for.
    pub fn request(self) -> Result<Request, Failure> {
        let threads = match self.threads {
            Some(0) => return Err(Failure::new("--threads 0: give a number above 0")),
            Some(threads) => threads,
            None => std::thread::available_parallelism().map_or(1, usize::from),
        };
        let mut inputs: Vec<PathBuf> = self.database.inputs().collect();
        let mut vehicle = None;
        if let Some(path) = &self.vehicle {
            let model = VehicleModel::read(path)?;
            let folder = path.parent().unwrap_or(Path::new("."));
            inputs.push(path.clone());
            inputs.extend(model.files.values().map(|file| folder.join(file)));
            vehicle = Some(model);
        }
        let kind = Kind {
            vehicle,
            reader: self.database.reader()?,
        };
        let study = Fleet {
            members: kind.members(&self.folder)?,
            kind,
            inputs,
            threads,
        };
        Ok(Request {
            study: Box::new(study),
            results: self.results,
            shard: self.shard,
        })
    }
}

/// A case is a campaign or a log.
impl Study for Fleet {
    type Ledger = Entries;
    type Outcome = Entry;

    fn about(&self) -> About {
        About {
            command: "oleo study fleet".to_owned(),
            name: "study-fleet".to_owned(),
            // What the members read is in their entries: a list of all would be as long as the fleet.
            inputs: self.inputs.clone(),
            ledger: "diagnoses.jsonl",
            steps: 1,
            ends_gracefully: false,
        }
    }

    fn cases(&self) -> usize {
        self.members.len()
    }

    fn ledger(&self, kept: Kept) -> Result<Entries, Failure> {
        match kept {
            Kept::Nowhere => Ok(Entries::in_memory()),
            Kept::In(path) => Entries::open(path),
            Kept::Text(text) => Ok(Entries::of_text(text)),
        }
    }

    fn run(&self, cases: &[usize], entries: &Entries, work: &Work) -> Result<Vec<Entry>, Failure> {
        let members: Vec<&Member> = cases.iter().map(|case| &self.members[*case]).collect();
        let stop = AtomicBool::new(work.stops());
        let one = |member: &&Member| -> Result<Entry, Failure> {
            // Shards say which files they are of, and need not be read again where they are merged.
            let now = match entries.compares_files || !stop.load(Ordering::Relaxed) {
                true => Some(member.sha256()?),
                false => None,
            };
            if let Some(known) = entries.get(&member.name, now.as_deref()) {
                work.done();
                return Ok(known.clone());
            }
            let interrupted = || Failure::from(DiagnoseError::Interrupted);
            let now = now.ok_or_else(interrupted)?;
            let entry = self.kind.diagnose(member, now, &stop);
            // What was stopped has no outcome.
            if stop.load(Ordering::Relaxed) {
                return Err(interrupted());
            }
            entries.keep(&entry)?;
            work.done();
            Ok(entry)
        };
        one_a_thread(&members, self.threads, &stop, &one)
    }

    fn report(&self, entries: Vec<Entry>, out: Option<&mut OutputDirectory>, command: &str) -> Result<Said, Failure> {
        let counts = Counts::of(&entries);
        if let Some(out) = out {
            write(out, &entries, &counts, command)?;
        }
        let mut text = format!("{}\n{}", counts.sentence(), counts.verdict_table());
        if !counts.effects.is_empty() {
            text += &format!("\n{}", counts.effect_table());
        }
        Ok(Said {
            text,
            status: ExitCode::SUCCESS,
        })
    }
}

/// What is said of how many.
struct Counts {
    all: usize,
    verdicts: BTreeMap<String, usize>,
    /// By id and place: the confidences.
    effects: BTreeMap<(String, String), Vec<f64>>,
    failed: Vec<(String, String)>,
}

impl Counts {
    fn of(entries: &[Entry]) -> Self {
        let mut counts = Self {
            all: entries.len(),
            verdicts: BTreeMap::new(),
            effects: BTreeMap::new(),
            failed: Vec::new(),
        };
        for entry in entries {
            if let Some(verdict) = &entry.verdict {
                *counts.verdicts.entry(verdict.clone()).or_default() += 1;
            }
            for effect in &entry.effects {
                let at = (effect.id.clone(), effect.place.clone());
                counts.effects.entry(at).or_default().push(effect.confidence);
            }
            if let Some(why) = &entry.failed {
                counts.failed.push((entry.name.clone(), why.clone()));
            }
        }
        counts
            .effects
            .values_mut()
            .for_each(|values| values.sort_by(f64::total_cmp));
        counts
    }

    /// Effects with their number and the median of their confidence, the most frequent first.
    fn effects(&self) -> Vec<(&str, &str, usize, f64)> {
        let counted = self.effects.iter().map(|((id, place), values)| {
            let median = values.get(values.len() / 2).copied().unwrap_or(0.0);
            (id.as_str(), place.as_str(), values.len(), median)
        });
        let mut all: Vec<_> = counted.collect();
        all.sort_by_key(|(.., count, _)| std::cmp::Reverse(*count));
        all
    }

    fn sentence(&self) -> String {
        let missing = self.verdicts.get("missing_physics").copied().unwrap_or(0);
        let without = match self.failed.len() {
            0 => String::new(),
            failed => format!(" {failed} could not be diagnosed."),
        };
        format!("{missing} of {} lack physics that was found.{without}", self.all)
    }

    fn verdict_table(&self) -> Table {
        let mut table = Table::new([Column::text("Verdict"), Column::number("Number")]);
        for (verdict, count) in &self.verdicts {
            table.row([verdict.clone(), count.to_string()]);
        }
        if !self.failed.is_empty() {
            table.row(["no diagnosis".to_owned(), self.failed.len().to_string()]);
        }
        table
    }

    fn effect_table(&self) -> Table {
        let mut table = Table::new([
            Column::text("Effect"),
            Column::text("Place"),
            Column::number("Number"),
            Column::number("Median confidence"),
        ]);
        for (id, place, count, confidence) in self.effects() {
            table.row([
                id.to_owned(),
                place.to_owned(),
                count.to_string(),
                format!("{confidence:.2}"),
            ]);
        }
        table
    }
}

/// One line of the table of all members.
#[derive(Serialize)]
struct Row<'a> {
    member: &'a str,
    sha256: &'a str,
    verdict: &'a str,
    noise_ratio_calibrated: Option<f64>,
    noise_ratio_improved: Option<f64>,
    effects: String,
    failed: &'a str,
}

fn write(out: &mut OutputDirectory, entries: &[Entry], counts: &Counts, command: &str) -> Result<(), Failure> {
    let rows = entries.iter().map(|entry| {
        let effects = entry
            .effects
            .iter()
            .map(|effect| format!("{}@{}", effect.id, effect.place));
        Row {
            member: &entry.name,
            sha256: &entry.sha256,
            verdict: entry.verdict.as_deref().unwrap_or(""),
            noise_ratio_calibrated: entry.noise_ratio.map(|ratio| ratio[0]),
            noise_ratio_improved: entry.noise_ratio.map(|ratio| ratio[1]),
            effects: effects.collect::<Vec<_>>().join(" "),
            failed: entry.failed.as_deref().unwrap_or(""),
        }
    });
    out.csv_records("members.csv", rows)?;
    let effects: Vec<_> = (counts.effects().into_iter())
        .map(|(id, place, count, confidence)| json!({ "id": id, "place": place, "count": count, "median_confidence": confidence }))
        .collect();
    let failed: Vec<_> = (counts.failed.iter())
        .map(|(name, why)| json!({ "member": name, "why": why }))
        .collect();
    out.summary(
        "summary.json",
        None,
        &json!({
            "members": counts.all,
            "verdicts": counts.verdicts,
            "effects": effects,
            "failed": failed,
        }),
    )?;
    let mut page = Page::new("Diagnosis of a fleet", command);
    let kind = match counts.verdicts.get("consistent") == Some(&counts.all) {
        true => Verdict::Pass,
        false => Verdict::Attention,
    };
    page.verdict(kind, &counts.sentence());
    page.outcome(counts.verdict_table());
    if !counts.effects.is_empty() {
        page.section("Effects").table(counts.effect_table());
    }
    let mut figure = Curves::new("Noise ratios", Axis::new("Held-out noise ratio", "").logarithmic());
    figure.caption("Fraction of the members whose ratio is at most the value below; 1 means that the error is no larger than the noise of the sensors.");
    let panel = figure.panel(Axis::new("Fraction of the members", "").range(0.0, 1.0));
    for (place, name) in ["recalibrated model", "improved model"].into_iter().enumerate() {
        let mut x: Vec<f64> = entries
            .iter()
            .filter_map(|entry| Some(entry.noise_ratio?[place]))
            .collect();
        x.sort_by(f64::total_cmp);
        let y: Vec<f64> = (1..=x.len()).map(|rank| rank as f64 / x.len() as f64).collect();
        panel.series(Style::Step, name, &x, &y);
    }
    page.section("Noise ratios").figure(figure);
    if !counts.failed.is_empty() {
        let mut table = Table::new([Column::text("Member"), Column::text("Why there is no diagnosis")]);
        for (name, why) in &counts.failed {
            table.row([name.clone(), why.clone()]);
        }
        page.section("Without a diagnosis").table(table);
    }
    out.page(&page)?;
    Ok(())
}
