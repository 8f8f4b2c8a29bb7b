//! A campaign from its opening to its files: where results go, the diagnosis with its progress, what is written and said.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use oleo_diagnose::campaign::CompleteRecordings;
use oleo_diagnose::{Campaign, DiagnoseError, Findings, KeptBack};
use oleo_report::{OutputDirectory, Progress};

use crate::failure::Failure;
use crate::results::{ResultsArgs, command_line};

/// Steps of the progress bar.
const STEPS: u64 = 100;

/// Stages the folder of the results. This is done before the work: Ctrl-C from here on removes the folder and ends with nothing half-written.
pub fn stage(
    results: &ResultsArgs,
    campaign: &Campaign,
    inputs: Vec<PathBuf>,
) -> Result<Option<OutputDirectory>, Failure> {
    let out = results.stage("oleo diagnose", &format!("diagnose-{}", campaign.name), inputs)?;
    if let Some(out) = &out {
        out.refuse(campaign.specimen.model_file())?;
    }
    Ok(out)
}

/// Diagnoses a campaign with a progress bar.
pub fn found(
    campaign: Campaign,
    complete: Option<&CompleteRecordings>,
    kept_back: KeptBack,
    begun: Instant,
    stop: &AtomicBool,
) -> Result<Findings, DiagnoseError> {
    let progress = Progress::new(&campaign.name, STEPS);
    Findings::of(campaign, complete, kept_back, begun, stop, &|phase, part| {
        progress.phase(phase);
        progress.set((part * STEPS as f64) as u64);
    })
}

/// Writes what was found, and says it.
pub fn write(
    results: &ResultsArgs,
    mut out: Option<OutputDirectory>,
    findings: &Findings,
) -> Result<ExitCode, Failure> {
    if let Some(out) = &mut out {
        findings.write(out, None, &command_line())?;
    }
    results.publish(out, &findings.text())?;
    Ok(ExitCode::SUCCESS)
}
