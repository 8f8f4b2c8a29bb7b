//! A campaign: the recordings of one specimen and the given model, from a folder or from memory.

use std::path::{Path, PathBuf};

use oleo_plant_sim::rig::ColumnMap;
use rayon::prelude::*;

use crate::error::DiagnoseError;
use crate::recording::{ColumnSpec, GapPolicy, MIN_SAMPLES, NamedColumn, Recording, of_table, read, read_by};
use crate::specimen::{ModelFile, Specimen};
use crate::units;

/// A campaign, ready to be diagnosed.
pub struct Campaign {
    /// Name of the specimen in its model file.
    pub name: String,
    /// The specimen: its given model and its recordings.
    pub specimen: Box<dyn Specimen>,
    /// Remarks about the recordings, one line each.
    pub notes: Vec<String>,
}

/// Name of the model file of a campaign, and of the improved model among the results.
pub const MODEL_FILE: &str = "model.toml";

/// The part of a campaign that is held out of the fit and predicted.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct KeptBack {
    /// Fraction of every recording, from its start, that is fitted, 0 to 1; `None` means all of it.
    pub fit_until: Option<f64>,
    /// Names (file stems) of recordings that are not fitted at all.
    pub recordings: Vec<String>,
}

impl KeptBack {
    /// Whether nothing is held out.
    #[must_use]
    pub fn is_nothing(&self) -> bool {
        self.fit_until.is_none() && self.recordings.is_empty()
    }

    /// Number of samples of a recording that are fitted.
    #[must_use]
    pub fn fitted_samples(&self, name: &str, samples: usize) -> usize {
        if self.recordings.iter().any(|r| r == name) {
            return 0;
        }
        self.fit_until
            .map_or(samples, |part| (part * samples as f64).round() as usize)
    }
}

impl Campaign {
    /// Reads `model.toml` and every CSV file of a folder, in the order of their names.
    ///
    /// # Errors
    /// One line that says which file is wrong, where, and what to do.
    pub fn open(folder: &Path) -> Result<Self, DiagnoseError> {
        Self::open_by(folder, None)
    }

    /// As [`Self::open`], with the map of the columns of recordings that another program wrote.
    ///
    /// # Errors
    /// As [`Self::open`], and what the map does not fit.
    pub fn open_by(folder: &Path, map: Option<&ColumnMap>) -> Result<Self, DiagnoseError> {
        let (model, recordings, notes) = read_folder(folder, map)?;
        Self::of(model, recordings, notes)
    }

    /// As [`Self::open`], but with only what may be fitted; the second campaign holds every recording whole, with the
    /// same samples, for judging predictions.
    ///
    /// # Errors
    /// The errors of [`Self::open`]; a name that no recording has; too few samples left to fit; no data held out.
    pub fn open_in_part(
        folder: &Path,
        kept_back: &KeptBack,
        map: Option<&ColumnMap>,
    ) -> Result<(Self, CompleteRecordings), DiagnoseError> {
        let (model, whole, notes) = read_folder(folder, map)?;
        Self::in_part(folder, model, whole, notes, kept_back)
    }

    /// The campaign of recordings in memory, each with its name, as that of a folder with the same model and recordings. What is kept
    /// back is not fitted; all recordings are then returned beside the campaign.
    ///
    /// # Errors
    /// The errors of [`Self::open_in_part`]; `model_file` is the name of the model in them.
    pub fn of_tables(
        model_toml: &str,
        model_file: &str,
        tables: &[(String, Vec<NamedColumn>)],
        kept_back: &KeptBack,
    ) -> Result<(Self, Option<CompleteRecordings>), DiagnoseError> {
        let model = ModelFile::read(model_toml, model_file)?;
        let (specs, gaps) = (model.model.columns(), model.model.gap_policy());
        let mut tables: Vec<_> = tables.iter().collect();
        // In the order of files, so that the result is that of a folder to the last bit.
        tables.sort_by_key(|(name, _)| format!("{name}.csv"));
        let read = tables
            .par_iter()
            .map(|(name, table)| of_table(name, table, &specs, gaps))
            .collect();
        let (recordings, notes) = long_enough(read)?;
        let all = Path::new("campaign");
        if recordings.is_empty() {
            return Err(DiagnoseError::file(all, "holds no recording; give at least one"));
        }
        if kept_back.is_nothing() {
            return Ok((Self::of(model, recordings, notes)?, None));
        }
        let (campaign, complete) = Self::in_part(all, model, recordings, notes, kept_back)?;
        Ok((campaign, Some(complete)))
    }

    /// The campaign of a model that was read elsewhere and of recordings (CSV), in the order of their names. What is kept back is not fitted; all
    /// recordings are then returned beside the campaign, with `again`, which reads the model of a text.
    ///
    /// # Errors
    /// The errors of [`Self::open_in_part`].
    pub fn of_files(
        model: ModelFile,
        files: &[PathBuf],
        map: Option<&ColumnMap>,
        kept_back: &KeptBack,
        again: ReadModel,
    ) -> Result<(Self, Option<CompleteRecordings>), DiagnoseError> {
        let (columns, gaps) = (model.model.columns(), model.model.gap_policy());
        let mut files = files.to_vec();
        files.sort();
        let (recordings, notes) = read_all(&files, &columns, gaps, map)?;
        let all = Path::new("the recordings");
        let mut names: Vec<&str> = recordings.iter().map(|recording| recording.name.as_str()).collect();
        names.sort_unstable();
        if let Some(same) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            let what = format!("two have the name {}; rename one of them", same[0]);
            return Err(DiagnoseError::file(all, what));
        }
        if kept_back.is_nothing() {
            return Ok((Self::of(model, recordings, notes)?, None));
        }
        let (campaign, complete) = Self::in_part(all, model, recordings, notes, kept_back)?;
        Ok((campaign, Some(CompleteRecordings { again, ..complete })))
    }

    fn in_part(
        folder: &Path,
        model: ModelFile,
        whole: Vec<Recording>,
        notes: Vec<String>,
        kept_back: &KeptBack,
    ) -> Result<(Self, CompleteRecordings), DiagnoseError> {
        let names = || whole.iter().map(|r| r.name.as_str()).collect::<Vec<_>>().join(", ");
        if let Some(name) = kept_back
            .recordings
            .iter()
            .find(|n| whole.iter().all(|r| r.name != **n))
        {
            let what = format!("holds no recording '{name}' to hold out; it holds: {}", names());
            return Err(DiagnoseError::file(folder, what));
        }
        let mut fitted = Vec::new();
        for recording in &whole {
            let samples = kept_back.fitted_samples(&recording.name, recording.len());
            if samples == 0 {
                continue;
            }
            if samples < MIN_SAMPLES {
                let what = format!(
                    "recording {} would be fitted on {samples} samples, but at least {MIN_SAMPLES} are needed; \
                     fit a larger part or hold the recording out",
                    recording.name
                );
                return Err(DiagnoseError::file(folder, what));
            }
            fitted.push(recording.first(samples));
        }
        if fitted.is_empty() {
            return Err(DiagnoseError::file(
                folder,
                format!("no recording is left to fit; hold out fewer of: {}", names()),
            ));
        }
        let campaign = Self::of(model, fitted, notes)?;
        let again: ReadModel = Box::new(|text| ModelFile::read(text, "improved model"));
        Ok((
            campaign,
            CompleteRecordings {
                recordings: whole,
                again,
            },
        ))
    }

    fn of(file: ModelFile, recordings: Vec<Recording>, mut notes: Vec<String>) -> Result<Self, DiagnoseError> {
        let specimen = file.model.with_recordings(recordings)?;
        units::check(&*specimen)?;
        notes.extend(specimen.remarks());
        Ok(Self {
            name: file.name,
            specimen,
            notes,
        })
    }
}

/// Reads the model of a text, as that of a campaign was read.
pub type ReadModel = Box<dyn Fn(&str) -> Result<ModelFile, DiagnoseError> + Send + Sync>;

/// Every recording of a campaign in full, beside the part that was fitted.
pub struct CompleteRecordings {
    recordings: Vec<Recording>,
    again: ReadModel,
}

impl CompleteRecordings {
    /// The specimen with all recordings and the model of a model file.
    ///
    /// # Errors
    /// As [`Campaign::open`].
    pub fn specimen(&self, model_toml: &str) -> Result<Box<dyn Specimen>, DiagnoseError> {
        let file = (self.again)(model_toml)?;
        file.model.with_recordings(self.recordings.clone())
    }
}

fn read_folder(
    folder: &Path,
    map: Option<&ColumnMap>,
) -> Result<(ModelFile, Vec<Recording>, Vec<String>), DiagnoseError> {
    let model_path = folder.join(MODEL_FILE);
    if !folder.is_dir() {
        return Err(DiagnoseError::file(
            folder,
            "is not a folder; a campaign is a folder with model.toml and recordings",
        ));
    }
    let text = std::fs::read_to_string(&model_path).map_err(|e| {
        DiagnoseError::file(
            &model_path,
            format!("{e}; a campaign needs a model.toml with the model of the specimen"),
        )
    })?;
    let file = ModelFile::read(&text, &model_path.display().to_string())?;
    let (columns, gaps) = (file.model.columns(), file.model.gap_policy());
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .map_err(|e| DiagnoseError::file(folder, e.to_string()))?
        .filter_map(|entry| entry.ok().map(|e| e.path()))
        .filter(|p| p.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")))
        .collect();
    files.sort();
    if files.is_empty() {
        return Err(DiagnoseError::file(
            folder,
            "holds no recording; put the recordings (*.csv) beside model.toml",
        ));
    }
    let (recordings, notes) = read_all(&files, &columns, gaps, map)?;
    Ok((file, recordings, notes))
}

fn read_all(
    files: &[PathBuf],
    specs: &[ColumnSpec],
    gaps: GapPolicy,
    map: Option<&ColumnMap>,
) -> Result<(Vec<Recording>, Vec<String>), DiagnoseError> {
    let one = |file: &PathBuf| match map {
        Some(map) => read_by(file, map, specs, gaps),
        None => read(file, specs, gaps),
    };
    long_enough(files.par_iter().map(one).collect())
}

/// A recording that is too short is left out with a note as long as others remain; anything else wrong is an error.
fn long_enough(read: Vec<Result<Recording, DiagnoseError>>) -> Result<(Vec<Recording>, Vec<String>), DiagnoseError> {
    let (mut recordings, mut notes, mut last) = (Vec::new(), Vec::new(), None);
    for result in read {
        match result {
            Ok(recording) => {
                notes.extend(recording.notes.iter().map(|n| format!("{}: {n}", recording.name)));
                recordings.push(recording);
            }
            Err(e @ DiagnoseError::TooShort { .. }) => {
                notes.push(format!("This recording was left out: {e}"));
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
