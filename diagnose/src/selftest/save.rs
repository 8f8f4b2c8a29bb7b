//! A simulated campaign as a folder like any other, to look into with `oleo diagnose` and `oleo predict`.

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

/// Writes `model.toml`, the recordings, and what is concealed (`answer.json`) into a folder of the case's name.
///
/// # Errors
/// A campaign that cannot be simulated, or a folder that cannot be written.
pub fn save(case: &Case, into: &Path) -> Result<(), DiagnoseError> {
    let campaign = generate(&case.name, &case.hidden)?;
    let folder = into.join(folder_name(case));
    let unseen = folder.join("unseen");
    std::fs::create_dir_all(&unseen).map_err(|e| DiagnoseError::file(&unseen, e.to_string()))?;
    write(&folder.join("model.toml"), &campaign.given.to_toml())?;
    let ids: Vec<EffectId> = case.hidden.iter().map(|(id, _)| *id).collect();
    let answer = serde_json::json!({
        "name": case.name, "hidden": ids, "sizes": campaign.sizes, "truth": campaign.truth,
    });
    write(&folder.join("answer.json"), &format!("{answer:#}\n"))?;
    for (recordings, to) in [(&campaign.recordings, &folder), (&campaign.unseen, &unseen)] {
        for recording in recordings {
            write(&to.join(format!("{}.csv", recording.name)), &table(recording))?;
        }
    }
    Ok(())
}

fn write(path: &Path, text: &str) -> Result<(), DiagnoseError> {
    std::fs::write(path, text).map_err(|e| DiagnoseError::file(path, e.to_string()))
}

fn table(recording: &Recording) -> String {
    let mut text = String::from("time_s");
    columns().iter().for_each(|c| text += &format!(",{}", c.name));
    for (k, time) in recording.time_s.iter().enumerate() {
        text += &format!("\n{time}");
        recording.columns.iter().for_each(|c| text += &format!(",{}", c[k]));
    }
    text + "\n"
}
