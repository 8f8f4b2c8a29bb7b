//! `oleo diagnose` of a vehicle: reads its logs with `oleo_hil`, diagnoses its four struts with `oleo_diagnose`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use oleo_controller::Reading;
use oleo_controller::can::{DISPLACEMENT_STEP_M, PRESSURE_STEP_PA};
use oleo_diagnose::MODEL_FILE;
use oleo_diagnose::vehicle::{self, Drive, Resolution, StrutSamples, VehicleCampaign, VehicleDiagnosis, VehicleModel};
use oleo_hil::drive_log::{self, LogAccount, LoggedDrive};
use oleo_interface::tick::TICK_MS;
use oleo_interface::{Corner, Corners, PressurePoint};
use oleo_report::Progress;

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
            .filter(|p| is_log(p))
            .collect();
        logs.sort();
        if logs.is_empty() {
            return Err(Failure::new(format!(
                "{}: holds no drive; put logs of candump -L (*.log or *.log.gz) beside {MODEL_FILE}",
                folder.display()
            )));
        }
        Ok(Some(Self { model, logs }))
    }
}

fn is_log(path: &Path) -> bool {
    let name = path.file_name().map(|n| n.to_string_lossy().to_ascii_lowercase());
    name.is_some_and(|n| n.ends_with(".log") || n.ends_with(".log.gz"))
}

/// Diagnoses a vehicle.
pub fn run(logs: &Logs, results: &ResultsArgs) -> Result<ExitCode, Failure> {
    let begun = Instant::now();
    let model = VehicleModel::read(&logs.model)?;
    let (mut drives, mut notes) = (Vec::new(), Vec::new());
    for path in &logs.logs {
        let log = drive_log::read(path).map_err(|e| Failure::new(e.to_string()))?;
        let name = name_of(path);
        notes.push(format!("{name}: {}", in_words(&log.account, log.drives.len())));
        for (k, logged) in log.drives.iter().enumerate() {
            let name = if k == 0 {
                name.clone()
            } else {
                format!("{name}, drive {}", k + 1)
            };
            drives.push(drive(name, k == 0, logged));
        }
    }
    let resolution = Resolution {
        displacement_m: DISPLACEMENT_STEP_M.into(),
        pressure_pa: PRESSURE_STEP_PA.into(),
    };
    let source = logs.model.parent().unwrap_or(Path::new(".")).display().to_string();
    let mut campaign = VehicleCampaign::of(model, &drives, resolution, &source)?;
    drop(drives);
    campaign.notes.splice(0..0, notes);
    // Staged before the work: Ctrl-C from here on removes the folder and ends with nothing half-written.
    let folder = logs.model.parent().unwrap_or(Path::new("."));
    let struts = campaign.model.files.values().map(|file| folder.join(file));
    let inputs = (logs.logs.iter().cloned()).chain([logs.model.clone()]).chain(struts);
    let name = format!("diagnose-{}", campaign.model.name);
    let mut out = results.stage("oleo diagnose", &name, inputs.collect())?;
    if let Some(out) = &out {
        for name in campaign.model_files() {
            out.refuse(&name)?;
        }
    }
    let stop = AtomicBool::new(false);
    let progress = Progress::new(&campaign.model.name, STEPS);
    let diagnosis = VehicleDiagnosis::of(&campaign, &stop, &|doing, part| {
        progress.phase(doing);
        progress.set((part * STEPS as f64) as u64);
    })?;
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
    results.publish(out, &text)?;
    Ok(ExitCode::SUCCESS)
}

/// The name of a log without `.log` or `.log.gz`.
fn name_of(path: &Path) -> String {
    let name = path
        .file_name()
        .map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    name.strip_suffix(".log").unwrap_or(name).to_owned()
}

/// What was read of a log, in one sentence.
fn in_words(account: &LogAccount, drives: usize) -> String {
    let longest = account.messages.iter().map(|m| m.longest_gap_ticks).max().unwrap_or(0);
    format!(
        "{drives} drive{}, {} frames of the suspension; {} lost, {} repeated, {} late, {} corrupted, {} out of sequence, longest gap {} ms; \
         {} frames of other devices, {} unreadable lines.",
        if drives == 1 { "" } else { "s" },
        account.total(|m| m.received),
        account.total(|m| m.lost),
        account.total(|m| m.repeated),
        account.total(|m| m.late),
        account.total(|m| m.corrupted),
        account.total(|m| m.out_of_sequence),
        longest * u64::from(TICK_MS),
        account.foreign_frames,
        account.unreadable_lines,
    )
}

/// A logged drive as series, strut by strut.
fn drive(name: String, is_first: bool, logged: &LoggedDrive) -> Drive {
    let number = |reading: Reading| reading.value().map_or(f64::NAN, f64::from);
    let strut = |corner: Corner| StrutSamples {
        displacement_m: logged
            .samples
            .iter()
            .map(|s| number(s.displacement_m[corner]))
            .collect(),
        pressure_pa: PressurePoint::ALL.map(|point| {
            logged
                .samples
                .iter()
                .map(|s| number(s.pressure_pa[corner][point]))
                .collect()
        }),
        valves: logged
            .samples
            .iter()
            .map(|s| s.command.map(|command| command.strut(corner)))
            .collect(),
    };
    Drive {
        name,
        is_first,
        struts: Corners::from_fn(strut),
    }
}
