//! `oleo diagnose` of a vehicle: reads its logs, diagnoses its four struts with `oleo_diagnose`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use oleo_diagnose::MODEL_FILE;
use oleo_diagnose::vehicle::{self, BodyModel, VehicleCampaign, VehicleDiagnosis, VehicleModel};
use oleo_hil::logs::Format;
use oleo_report::Progress;

use super::driven::driven;
use crate::commands::vehicle_log::DatabaseArgs;
use crate::failure::Failure;
use crate::results::{ResultsArgs, command_line};

/// Steps of the progress bar.
const STEPS: u64 = 100;

/// What is diagnosed: the model of a vehicle, and the logs of its drives.
pub struct Logs {
    /// Path of the vehicle's model file.
    pub model: PathBuf,
    /// Paths of the logs, sorted.
    pub logs: Vec<PathBuf>,
}

impl Logs {
    /// The campaign in a folder, if its `model.toml` is that of a vehicle.
    pub fn in_folder(folder: &Path) -> Result<Option<Self>, Failure> {
        let model = folder.join(MODEL_FILE);
        // A folder without a readable model gets the message of a campaign of any kind.
        if !std::fs::read_to_string(&model).is_ok_and(|text| vehicle::is_vehicle(&text)) {
            return Ok(None);
        }
        let entries = std::fs::read_dir(folder).map_err(|e| Failure::new(format!("{}: {e}", folder.display())))?;
        let mut logs: Vec<PathBuf> = entries
            .filter_map(|e| e.ok().map(|e| e.path()))
            .filter(|p| Format::of_name(p).is_some())
            .collect();
        logs.sort();
        if logs.is_empty() {
            return Err(Failure::new(format!(
                "{}: holds no drive; put logs of the bus (*.log of candump -L, *.asc or *.mf4) beside {MODEL_FILE}",
                folder.display()
            )));
        }
        Ok(Some(Self { model, logs }))
    }
}

/// Diagnoses a vehicle.
pub fn run(logs: &Logs, database: &DatabaseArgs, results: &ResultsArgs) -> Result<ExitCode, Failure> {
    let begun = Instant::now();
    let model = VehicleModel::read(&logs.model)?;
    let reader = database.reader()?;
    let (mut drives, mut notes) = (Vec::new(), Vec::new());
    for path in &logs.logs {
        let log = reader.read(path)?;
        let name = log.drives.first().map_or("", |drive| drive.name.as_str());
        notes.push(format!("{name}: {}", log.in_words));
        drives.extend(log.drives);
    }
    let source = logs.model.parent().unwrap_or(Path::new(".")).display().to_string();
    let mut campaign = VehicleCampaign::of(model, &drives, &reader.resolution(), &source)?;
    drop(drives);
    campaign.notes.splice(0..0, notes);
    // Staged before the work: Ctrl-C from here on removes the folder and ends with nothing half-written.
    let folder = logs.model.parent().unwrap_or(Path::new("."));
    let struts = campaign.model.files.values().map(|file| folder.join(file));
    let body = campaign
        .model
        .body
        .as_ref()
        .and_then(BodyModel::own_file)
        .map(|file| folder.join(file));
    let inputs = (logs.logs.iter().cloned())
        .chain([logs.model.clone()])
        .chain(struts)
        .chain(body)
        .chain(database.inputs());
    let name = format!("diagnose-{}", campaign.model.name);
    let mut out = results.stage("oleo diagnose", &name, inputs.collect())?;
    if let Some(out) = &out {
        for name in campaign.model_files() {
            out.refuse(&name)?;
        }
    }
    let stop = AtomicBool::new(false);
    let progress = Progress::new(&campaign.model.name, STEPS);
    let mut diagnosis = VehicleDiagnosis::of(&campaign, &stop, &|doing, part| {
        progress.phase(doing);
        progress.set((part * STEPS as f64) as u64);
    })?;
    if diagnosis.alters_vehicle() {
        progress.phase("driving the closed loop as believed and as found");
        diagnosis.driven = Some(driven(&campaign, &diagnosis, folder));
    }
    drop(progress);
    let runtime_s = begun.elapsed().as_secs_f64();
    if let Some(out) = &mut out {
        out.summary("report.json", None, &vehicle::report(&campaign, &diagnosis, runtime_s))?;
        out.page(&vehicle::page(&campaign, &diagnosis, &command_line(), runtime_s))?;
        for (name, text) in diagnosis.improved(&campaign)? {
            out.write(&name, text)?;
        }
    }
    let mut text = format!(
        "{}: {}. {}\n",
        campaign.model.name,
        diagnosis.verdict(),
        vehicle::headline(&diagnosis)
    );
    if !diagnosis.effects.is_empty() {
        text += &vehicle::effects_table(&diagnosis).to_string();
    }
    if let Some(felt) = &diagnosis.driven {
        text += &format!("\n{}\n", vehicle::driven_in_words(felt));
    }
    results.publish(out, &text)?;
    Ok(ExitCode::SUCCESS)
}
