//! A whole diagnosis, from the files of the recordings to the report.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use oleo_diagnose::recording::Recording;
use oleo_diagnose::specimen::strut::columns;
use oleo_diagnose::{Campaign, Findings, KeptBack, MODEL_FILE};
use oleo_report::digest;

use super::contract::Work;
use super::rig;
use crate::failure::Failure;

/// A campaign in a folder.
pub struct Samples {
    folder: PathBuf,
    improved_toml: String,
}

impl Samples {
    /// Writes the model and the recordings.
    pub fn prepare(samples: u64, scratch: &Path) -> Result<Self, Failure> {
        let folder = scratch.join(format!("campaign-{samples}"));
        std::fs::create_dir_all(&folder)?;
        std::fs::write(folder.join(MODEL_FILE), rig::believed().to_toml())?;
        for recording in rig::recordings(samples)? {
            write(&folder.join(format!("{}.csv", recording.name)), &recording)?;
        }
        Ok(Self {
            folder,
            improved_toml: String::new(),
        })
    }
}

impl Work for Samples {
    fn run(&mut self) -> Result<u64, Failure> {
        let campaign = Campaign::open(&self.folder)?;
        let stop = AtomicBool::new(false);
        let findings = Findings::of(campaign, None, KeptBack::default(), Instant::now(), &stop, &|_, _| {})?;
        std::hint::black_box(findings.report());
        self.improved_toml.clone_from(&findings.diagnosis.model_toml);
        Ok(findings.diagnosis.simulated as u64)
    }

    fn outcome(&self) -> Result<String, Failure> {
        Ok(digest::of_bytes(self.improved_toml.as_bytes()))
    }
}

fn write(path: &Path, recording: &Recording) -> Result<(), Failure> {
    let mut table = csv::Writer::from_path(path)?;
    let names = columns();
    table.write_record(std::iter::once("time_s").chain(names.iter().map(|column| column.name.as_str())))?;
    for (k, time) in recording.time_s.iter().enumerate() {
        let row = std::iter::once(time).chain(recording.columns.iter().map(|column| &column[k]));
        table.write_record(row.map(f64::to_string))?;
    }
    table.flush()?;
    Ok(())
}
