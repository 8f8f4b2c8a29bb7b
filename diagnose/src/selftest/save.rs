//! Writes a simulated campaign as a folder that `oleo diagnose` and `oleo predict` can read.

use std::path::Path;

use super::generate::generate;
use super::plan::Case;
use crate::error::DiagnoseError;
use crate::recording::Recording;
use crate::specimen::strut::columns;
use crate::vocabulary::EffectId;

/// Name of the folder of a case: its name, with what file systems dislike replaced.
fn folder_name(case: &Case) -> String {
    case.name.replace([':', '.'], "_")
}

/// Writes `model.toml`, the recordings, and what is concealed (`answer.json`, `unseen/complete.toml`) into a folder of the case's name.
///
/// # Errors
/// A campaign that cannot be simulated, or a folder that cannot be written.
pub fn save(case: &Case, into: &Path) -> Result<(), DiagnoseError> {
    let campaign = generate(&case.name, &case.hidden, &case.variants, case.flaw)?;
    let folder = into.join(folder_name(case));
    let unseen = folder.join("unseen");
    std::fs::create_dir_all(&unseen).map_err(|e| DiagnoseError::file(&unseen, e.to_string()))?;
    write(&folder.join("model.toml"), &campaign.given.to_toml())?;
    write(&unseen.join("complete.toml"), &campaign.complete.to_toml())?;
    let ids: Vec<EffectId> = case.hidden.iter().map(|(id, _)| *id).collect();
    let answer = serde_json::json!({
        "name": case.name, "hidden": ids, "sizes": campaign.sizes, "truth": campaign.truth,
        "instruments": case.flaw,
    });
    write(&folder.join("answer.json"), &format!("{answer:#}\n"))?;
    for (recordings, to) in [(&campaign.recordings, &folder), (&campaign.unseen, &unseen)] {
        for recording in recordings {
            write_table(&to.join(format!("{}.csv", recording.name)), recording)?;
        }
    }
    Ok(())
}

fn write(path: &Path, text: &str) -> Result<(), DiagnoseError> {
    std::fs::write(path, text).map_err(|e| DiagnoseError::file(path, e.to_string()))
}

fn write_table(path: &Path, recording: &Recording) -> Result<(), DiagnoseError> {
    let fail = |e: csv::Error| DiagnoseError::file(path, e.to_string());
    let mut table = csv::Writer::from_path(path).map_err(fail)?;
    let specs = columns();
    // A column without a reading is not recorded.
    let recorded: Vec<(&str, &Vec<f64>)> = (specs.iter().map(|c| c.name.as_str()).zip(&recording.columns))
        .filter(|(_, column)| column.iter().any(|v| v.is_finite()))
        .collect();
    let header = std::iter::once("time_s").chain(recorded.iter().map(|(name, _)| *name));
    table.write_record(header).map_err(fail)?;
    for (k, time) in recording.time_s.iter().enumerate() {
        let row = std::iter::once(time).chain(recorded.iter().map(|(_, column)| &column[k]));
        table.write_record(row.map(f64::to_string)).map_err(fail)?;
    }
    table.flush().map_err(|e| DiagnoseError::file(path, e.to_string()))
}
