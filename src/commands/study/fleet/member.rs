//! The members of a fleet, and the diagnosis of one of them.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use oleo_diagnose::diagnosis::Effect;
use oleo_diagnose::vehicle::{VehicleCampaign, VehicleDiagnosis, VehicleModel, is_vehicle};
use oleo_diagnose::{Campaign, Findings, KeptBack, MODEL_FILE};
use oleo_hil::logs::Format;
use oleo_report::digest;

use super::entry::{Entry, Found};
use crate::commands::vehicle_log::Reader;
use crate::failure::Failure;

/// A campaign, or a log of a vehicle.
pub struct Member {
    /// Name of the folder or the file.
    pub name: String,
    path: PathBuf,
}

/// How the members of a fleet are diagnosed.
pub struct Kind {
    /// The model of all vehicles, whose logs the members are. Without it each member is a folder with a model of its own.
    pub vehicle: Option<VehicleModel>,
    /// Reads the logs.
    pub reader: Reader,
}

impl Kind {
    /// The members in a folder, by name.
    pub fn members(&self, folder: &Path) -> Result<Vec<Member>, Failure> {
        let wrong = |what: String| Failure::new(format!("{}: {what}", folder.display()));
        let entries =
            std::fs::read_dir(folder).map_err(|error| wrong(format!("cannot be read as a folder: {error}")))?;
        let is_member = |path: &Path| match &self.vehicle {
            None => path.join(MODEL_FILE).is_file(),
            Some(_) => Format::of_name(path).is_some(),
        };
        let mut members = Vec::new();
        for entry in entries {
            let path = entry.map_err(|error| wrong(error.to_string()))?.path();
            if is_member(&path) {
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                members.push(Member { name, path });
            }
        }
        if members.is_empty() {
            return Err(wrong(match &self.vehicle {
                None => format!(
                    "holds no campaign; give a folder of folders with recordings and {MODEL_FILE}, or add --vehicle MODEL.toml if it holds logs"
                ),
                Some(_) => "holds no log (*.log of candump -L, *.asc or *.mf4)".to_owned(),
            }));
        }
        members.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(members)
    }

    /// The diagnosis of a member. What is wrong with its files is an outcome too.
    pub fn diagnose(&self, member: &Member, sha256: String, stop: &AtomicBool) -> Entry {
        let mut entry = Entry {
            name: member.name.clone(),
            sha256,
            verdict: None,
            noise_ratio: None,
            effects: Vec::new(),
            failed: None,
        };
        let diagnosed = match &self.vehicle {
            Some(model) => self.logs(model.clone(), std::slice::from_ref(&member.path), stop, &mut entry),
            None => self.folder(&member.path, stop, &mut entry),
        };
        if let Err(failure) = diagnosed {
            entry.failed = Some(failure.to_string());
        }
        entry
    }

    /// A folder with recordings, or with logs of a vehicle.
    fn folder(&self, folder: &Path, stop: &AtomicBool, entry: &mut Entry) -> Result<(), Failure> {
        let model = folder.join(MODEL_FILE);
        if !std::fs::read_to_string(&model).is_ok_and(|text| is_vehicle(&text)) {
            return campaign(folder, stop, entry);
        }
        let files = std::fs::read_dir(folder)?.map(|file| Ok(file?.path()));
        let mut logs = files.collect::<std::io::Result<Vec<_>>>()?;
        logs.retain(|path| Format::of_name(path).is_some());
        logs.sort();
        self.logs(VehicleModel::read(&model)?, &logs, stop, entry)
    }

    /// The logs of one vehicle.
    fn logs(&self, model: VehicleModel, logs: &[PathBuf], stop: &AtomicBool, entry: &mut Entry) -> Result<(), Failure> {
        let mut drives = Vec::new();
        for path in logs {
            drives.extend(self.reader.read(path)?.drives);
        }
        let source = entry.name.clone();
        let campaign = VehicleCampaign::of(model, &drives, &self.reader.resolution(), &source)?;
        drop(drives);
        let diagnosis = VehicleDiagnosis::of(&campaign, stop, &|_, _| {})?;
        entry.verdict = Some(diagnosis.verdict().to_string());
        let ratios = diagnosis.corners.values().map(|corner| {
            let selection = &corner.selection;
            [selection.calibrated_ratio, selection.improved_ratio]
        });
        let worst = ratios.fold([0.0_f64; 2], |worst, ratio| {
            [worst[0].max(ratio[0]), worst[1].max(ratio[1])]
        });
        entry.noise_ratio = Some(finite(worst));
        entry.effects = found(diagnosis.effects.iter().map(|effect| &effect.effect));
        Ok(())
    }
}

impl Member {
    /// SHA-256 of its files together.
    pub fn sha256(&self) -> Result<String, Failure> {
        let mut files = match self.path.is_dir() {
            true => std::fs::read_dir(&self.path)?
                .map(|entry| Ok(entry?.path()))
                .collect::<std::io::Result<_>>()?,
            false => vec![self.path.clone()],
        };
        files.sort();
        let of_file = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            format!("{name}\n{}\n", digest::of_file(path).unwrap_or_default())
        };
        let together: String = files.iter().map(of_file).collect();
        Ok(digest::of_bytes(together.as_bytes()))
    }
}

fn found<'a>(effects: impl Iterator<Item = &'a Effect>) -> Vec<Found> {
    effects
        .map(|effect| Found {
            id: effect.id.to_string(),
            place: effect.place.to_string(),
            confidence: effect.confidence,
        })
        .collect()
}

/// JSON knows no infinity: what does not fit at all is as bad as can be said.
fn finite(ratios: [f64; 2]) -> [f64; 2] {
    ratios.map(|ratio| if ratio.is_finite() { ratio } else { 1e9 })
}

fn campaign(folder: &Path, stop: &AtomicBool, entry: &mut Entry) -> Result<(), Failure> {
    let nothing = KeptBack {
        fit_until: None,
        recordings: Vec::new(),
    };
    let findings = Findings::of(Campaign::open(folder)?, None, nothing, Instant::now(), stop, &|_, _| {})?;
    let diagnosis = &findings.diagnosis;
    entry.verdict = Some(diagnosis.verdict().to_string());
    let selection = &diagnosis.selection;
    entry.noise_ratio = Some(finite([selection.calibrated_ratio, selection.improved_ratio]));
    entry.effects = found(diagnosis.effects.iter());
    Ok(())
}
