//! `oleo diagnose`: from recordings and a model to what the model left out.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use oleo_diagnose::problem::Problem;
use oleo_diagnose::{Campaign, Diagnosis, json, page};
use oleo_report::{OutputDirectory, Progress};

use crate::failure::Failure;

/// Find the physics that a model left out: where, what, with which numbers, and how much better the model becomes.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  oleo diagnose campaign --out found\n\n\
    A campaign is a folder with model.toml (what is believed) and recordings (*.csv). Written to DIR: report.json,\n\
    report.html (opens offline) and model.toml, the improved model, which oleo predict, rig and hil run as it is.\n\
    Exit status 0 whatever the verdict.")]
pub struct Args {
    /// Folder with model.toml and the recordings
    #[arg(value_name = "CAMPAIGN")]
    campaign: PathBuf,
    /// Folder to write
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Steps of the progress bar.
const STEPS: u64 = 100;

/// Runs the command.
pub fn run(args: Args) -> Result<ExitCode, Failure> {
    let begun = Instant::now();
    let campaign = Campaign::open(&args.campaign)?;
    // Staged before the work: Ctrl-C from here on removes the folder and ends with nothing half-written.
    let mut out = OutputDirectory::stage(&args.out)?;
    let stop = AtomicBool::new(false);
    let problem = Problem::new(&*campaign.specimen, &stop);
    let progress = Progress::new(&campaign.name, STEPS);
    let diagnosis = Diagnosis::of(&campaign, &problem, &|_, part| {
        progress.set((part * STEPS as f64) as u64)
    })?;
    drop(progress);
    let runtime_s = begun.elapsed().as_secs_f64();
    let command = format!("oleo diagnose {} --out {}", args.campaign.display(), args.out.display());
    out.json("report.json", &json::report(&campaign, &diagnosis, runtime_s))?;
    out.page(&page::page(&campaign, &diagnosis, &command, runtime_s))?;
    out.write("model.toml", &diagnosis.model_toml)?;
    out.commit()?;
    let mut text = format!(
        "{}: {} (held-out noise ratio {:.2} before, {:.2} after)\n",
        campaign.name,
        diagnosis.verdict(),
        diagnosis.selection.noise_ratio.0,
        diagnosis.selection.noise_ratio.1
    );
    if !diagnosis.effects.is_empty() {
        text += &page::effects_table(&diagnosis).to_string();
    }
    if let Some(next) = &diagnosis.next_experiment {
        text += &format!("\n{next}\n");
    }
    let _ = std::io::Write::write_all(&mut std::io::stdout(), text.as_bytes());
    Ok(ExitCode::SUCCESS)
}
