//! A folder of recordings of one specimen, and what is believed about it.

use std::path::{Path, PathBuf};

use oleo_plant_sim::specimen::{CylinderModel, GasSpringModel, specimen_name};
use oleo_plant_sim::strut::StrutModel;
use rayon::prelude::*;

use crate::error::DiagnoseError;
use crate::recording::{ColumnSpec, GapPolicy, Recording, read};
use crate::specimen::Specimen;
use crate::specimen::{cylinder, gas_spring, strut};

/// A campaign, ready to be diagnosed.
pub struct Campaign {
    /// Folder.
    pub folder: PathBuf,
    /// Name in its model file.
    pub name: String,
    /// Specimen with recordings.
    pub specimen: Box<dyn Specimen>,
    /// Remarks about the recordings, one line each.
    pub notes: Vec<String>,
}

/// Name of the belief.
const MODEL_FILE: &str = "model.toml";

impl Campaign {
    /// Reads `model.toml` and every CSV file of a folder, in the order of their names.
    ///
    /// # Errors
    /// One line: which file, where in it, what to do.
    pub fn open(folder: &Path) -> Result<Self, DiagnoseError> {
        let model_path = folder.join(MODEL_FILE);
        if !folder.is_dir() {
            return Err(DiagnoseError::file(
                folder,
                "is not a folder; a campaign is a folder with model.toml and recordings",
            ));
        }
        let text = std::fs::read_to_string(&model_path).map_err(|e| {
            DiagnoseError::file(&model_path, format!("{e}; a campaign needs the model that is believed"))
        })?;
        let source = model_path.display().to_string();
        let head = specimen_name(&text, &source).map_err(DiagnoseError::Model)?;
        let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
            .map_err(|e| DiagnoseError::file(folder, e.to_string()))?
            .filter_map(|entry| entry.ok().map(|e| e.path()))
            .filter(|p| p.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")))
            .collect();
        files.sort();
        if files.is_empty() {
            return Err(DiagnoseError::file(folder, "holds no recording (*.csv)"));
        }
        let (specimen, notes): (Box<dyn Specimen>, Vec<String>) = match head.kind.as_str() {
            "two-stage hydropneumatic strut" => {
                let model = StrutModel::from_toml(&text, &source).map_err(|e| DiagnoseError::Model(e.to_string()))?;
                let (recordings, notes) = read_all(&files, &strut::columns(), GapPolicy::Cut)?;
                let strut = strut::TwoStageStrut::new(model, recordings).map_err(DiagnoseError::Model)?;
                (Box::new(strut), notes)
            }
            "gas spring" => {
                let model = GasSpringModel::from_toml(&text, &source).map_err(DiagnoseError::Model)?;
                let (recordings, notes) = read_all(&files, &gas_spring::columns(), GapPolicy::Cut)?;
                (Box::new(gas_spring::GasSpring::new(model, recordings)), notes)
            }
            "cylinder" => {
                let model = CylinderModel::from_toml(&text, &source).map_err(DiagnoseError::Model)?;
                let (recordings, notes) = read_all(&files, &cylinder::columns(&model), GapPolicy::Keep)?;
                (Box::new(cylinder::Cylinder::new(model, recordings)), notes)
            }
            other => {
                return Err(DiagnoseError::Model(format!(
                    "{source}, key specimen.kind: '{other}' is not known; \
                     'two-stage hydropneumatic strut', 'gas spring' and 'cylinder' are"
                )));
            }
        };
        Ok(Self {
            folder: folder.to_path_buf(),
            name: head.name,
            specimen,
            notes,
        })
    }
}

/// A file that is too short is left out with a note as long as others remain; anything else wrong is an error.
fn read_all(
    files: &[PathBuf],
    specs: &[ColumnSpec],
    gaps: GapPolicy,
) -> Result<(Vec<Recording>, Vec<String>), DiagnoseError> {
    let read: Vec<Result<Recording, DiagnoseError>> = files.par_iter().map(|f| read(f, specs, gaps)).collect();
    let (mut recordings, mut notes, mut last) = (Vec::new(), Vec::new(), None);
    for result in read {
        match result {
            Ok(recording) => {
                notes.extend(recording.notes.iter().map(|n| format!("{}: {n}", recording.name)));
                recordings.push(recording);
            }
            Err(e @ DiagnoseError::File { .. }) => {
                notes.push(format!("left out: {e}"));
                last = Some(e);
            }
            Err(e) => return Err(e),
        }
    }
    match (recordings.is_empty(), last) {
        (true, Some(error)) => Err(error),
        _ => Ok((recordings, notes)),
    }
}
