//! `oleo diagnose`: finds the physics that a model leaves out.

mod campaign;
mod driven;
mod foreign;
mod self_test;
mod vehicle;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use campaign::{found, stage, write};
use oleo_diagnose::{Campaign, KeptBack};

use super::column_map::column_map;
use super::vehicle_log::DatabaseArgs;
use crate::failure::Failure;
use crate::results::ResultsArgs;
use crate::shard::Request;
use crate::shard::arguments::of_this_process;

/// Find the physics that a model leaves out: its place, its law, its parameters, and how much the model improves with it.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  oleo diagnose campaign --out found\n  oleo diagnose --self-test --campaigns 70 --out power\n\n\
    A campaign is a folder with recordings (*.csv) and model.toml, the model of the specimen as you believe it to be. \
    The command writes three files into DIR: report.json, report.html (opens offline) and model.toml, the improved model. \
    oleo predict accepts the improved model unchanged; oleo rig and oleo hil accept it if the specimen is a strut. The exit \
    status is 0 whatever the verdict.\n\n\
    A vehicle (kind = \"vehicle\" in model.toml) is diagnosed from logs of its bus: text of candump -L (*.log), \
    Vector ASC (*.asc), both also with .gz, or ASAM MDF 4 (*.mf4):\n  \
    oleo diagnose drives --out found                           a folder with model.toml, four strut files and logs\n  \
    oleo diagnose a.log b.log --vehicle model.toml --out found\n  \
    oleo diagnose a.mf4 --vehicle model.toml --dbc car.dbc --signals map.toml   a log with messages of another database\n\n\
    Somebody else's model, an FMU for co-simulation, is diagnosed with a map of its variables to the columns of recordings (docs/fmu.md):\n  \
    oleo diagnose --fmu model.fmu --map map.toml a.csv b.csv --out found\n\n\
    To test the improved model on data that it was not fitted to, hold part of the data out:\n  \
    oleo diagnose gas-spring --fit-until 0.5 --out found       fits the first half of every recording\n  \
    oleo diagnose cylinder --hold-out 5bar --out found         fits all recordings except 5bar.csv\n\
    The noise ratios of every model on both parts are printed, and are in report.json under kept_back.\n\n\
    The self-test stores every finished campaign in DIR/trials.jsonl. Repeat an interrupted self-test with the same DIR, \
    and it resumes there. After a new build of oleo, use a new DIR."
)]
pub struct Args {
    /// Folder with model.toml and the recordings (*.csv, or *.log, *.asc, *.mf4 of a vehicle); with --vehicle the logs themselves, with --fmu the recordings
    #[arg(value_name = "CAMPAIGN|LOG|RECORDING", required_unless_present = "self_test")]
    campaign: Vec<PathBuf>,
    /// Model of a vehicle (kind = "vehicle"), beside which the models of its four struts lie
    #[arg(long, value_name = "MODEL.toml", conflicts_with_all = ["fit_until", "hold_out", "self_test"])]
    vehicle: Option<PathBuf>,
    /// Fit only this fraction at the beginning of every recording (0.05 to 0.95), and predict the rest
    #[arg(long, value_name = "FRACTION", value_parser = part)]
    fit_until: Option<f64>,
    /// Recording (file name without .csv) that is not fitted but predicted; may be repeated
    #[arg(long, value_name = "NAME")]
    hold_out: Vec<String>,
    /// Map of the columns of recordings that another program wrote: separator, decimal commas, titles and units (docs/diagnose.md)
    #[arg(long, value_name = "MAP.toml", conflicts_with_all = ["vehicle", "self_test"])]
    columns: Option<PathBuf>,
    #[command(flatten)]
    foreign: foreign::ForeignArgs,
    #[command(flatten)]
    database: DatabaseArgs,
    #[command(flatten)]
    results: ResultsArgs,
    #[command(flatten)]
    self_test: self_test::Args,
}

fn part(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(part) if (0.05..=0.95).contains(&part) => Ok(part),
        _ => Err("give a fraction of the recording from 0.05 to 0.95, such as 0.5".into()),
    }
}

/// Runs the command.
pub fn run(args: Args) -> Result<ExitCode, Failure> {
    let Some(folder) = args.campaign.first() else {
        if args.database.is_given() {
            return Err(Failure::new(
                "--dbc and --signals: the self-test reads no logs; leave the options out",
            ));
        }
        return self_test::run_self_test(args.self_test, args.results, || of_this_process::<Args>("diagnose"));
    };
    if args.self_test.is_divided() {
        return Err(Failure::new(
            "--shard: one campaign is one case; leave it out, or see oleo study fleet for a folder of campaigns",
        ));
    }
    let kept_back = KeptBack {
        fit_until: args.fit_until,
        recordings: args.hold_out.clone(),
    };
    if let Some(fmu) = &args.foreign.fmu {
        let recordings = foreign::Recordings {
            files: &args.campaign,
            kept_back,
            columns: args.columns.as_deref(),
        };
        if args.database.is_given() {
            return Err(Failure::new(
                "--dbc and --signals: an FMU is compared with columns; convert the log with oleo convert, or leave the options out",
            ));
        }
        return foreign::run(fmu, args.foreign.map.as_deref(), &recordings, &args.results);
    }
    if let Some(logs) = args.logs(folder)? {
        return vehicle::run(&logs, &args.database, &args.results);
    }
    let begun = Instant::now();
    let map = args.columns.as_deref().map(column_map).transpose()?;
    let (campaign, complete) = if kept_back.is_nothing() {
        (Campaign::open_by(folder, map.as_ref())?, None)
    } else {
        let (campaign, complete) = Campaign::open_in_part(folder, &kept_back, map.as_ref())?;
        (campaign, Some(complete))
    };
    let mut inputs = inputs(folder);
    inputs.extend(args.columns.clone());
    let out = stage(&args.results, &campaign, inputs)?;
    let stop = AtomicBool::new(false);
    let findings = found(campaign, complete.as_ref(), kept_back, begun, &stop)?;
    write(&args.results, out, &findings)
}

impl Args {
    /// The self-test, if one is asked for: what else there is to diagnose has no cases.
    pub fn request(self) -> Result<Request, Failure> {
        match self.self_test.self_test {
            true => self.self_test.request(self.results),
            false => Err(Failure::new(
                "oleo diagnose: one campaign is one case and has no shards; give oleo diagnose --self-test, or oleo study fleet",
            )),
        }
    }

    /// The logs of a vehicle, if one is to be diagnosed.
    fn logs(&self, first: &Path) -> Result<Option<vehicle::Logs>, Failure> {
        if let Some(model) = &self.vehicle {
            if let Some(twice) = given_twice(&self.campaign) {
                return Err(Failure::new(format!(
                    "{}: is given twice, and what it holds would count twice; give each log once",
                    twice.display()
                )));
            }
            return Ok(Some(vehicle::Logs {
                model: model.clone(),
                logs: self.campaign.clone(),
            }));
        }
        if let Some(second) = self.campaign.get(1) {
            return Err(Failure::new(format!(
                "{}: is a second campaign; diagnose one folder at a time, or add --vehicle MODEL.toml if these are logs of a vehicle",
                second.display()
            )));
        }
        let logs = vehicle::Logs::in_folder(first)?;
        if logs.is_none() && self.database.is_given() {
            return Err(Failure::new(format!(
                "{}: is no campaign of a vehicle; leave --dbc and --signals out, or add --vehicle MODEL.toml if this is a log",
                first.display()
            )));
        }
        if logs.is_some() && self.columns.is_some() {
            return Err(Failure::new(
                "--columns: the logs of a vehicle have no columns; leave the option out, and see --signals",
            ));
        }
        if logs.is_some() && (self.fit_until.is_some() || !self.hold_out.is_empty()) {
            return Err(Failure::new(
                "--fit-until and --hold-out: no part of a vehicle's drives can be held out yet; leave the options out"
                    .to_owned(),
            ));
        }
        Ok(logs)
    }
}

/// The first of some files that is there under an earlier name, or the same one.
fn given_twice(files: &[PathBuf]) -> Option<&PathBuf> {
    let places: Vec<Option<PathBuf>> = files.iter().map(|file| file.canonicalize().ok()).collect();
    let is_before = |k: &usize| places[*k].is_some() && places[..*k].contains(&places[*k]);
    (0..files.len()).find(is_before).map(|k| &files[k])
}

/// The models and recordings of a campaign, by name.
fn inputs(folder: &Path) -> Vec<PathBuf> {
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let read = |path: &PathBuf| path.extension().is_some_and(|kind| kind == "csv" || kind == "toml");
    let mut inputs: Vec<PathBuf> = files.map(|entry| entry.path()).filter(read).collect();
    inputs.sort();
    inputs
}
