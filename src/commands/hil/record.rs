//! `oleo hil --record`: the struts of a run as campaigns for `oleo diagnose`.

use oleo_hil::run::Outcome;
use oleo_hil::scenario::Scenario;
use oleo_hil::strut_recording::StrutRecording;
use oleo_interface::Corner;
use oleo_report::OutputDirectory;

use crate::failure::Failure;

/// The corners whose struts are recorded.
#[derive(Clone)]
pub struct Recorded(pub Vec<Corner>);

/// Reads the name of a corner, or `all`.
pub fn recorded(text: &str) -> Result<Recorded, String> {
    if text == "all" {
        return Ok(Recorded(Corner::ALL.to_vec()));
    }
    Corner::named(text)
        .map(|corner| Recorded(vec![corner]))
        .ok_or_else(|| format!("give {} or all", Corner::ALL.map(Corner::name).join(", ")))
}

/// Writes the campaign of one strut, and says what to do with it.
pub fn record(
    out: &mut OutputDirectory,
    scenario: &Scenario,
    outcome: &Outcome,
    corner: Corner,
) -> Result<String, Failure> {
    let StrutRecording { columns, model } = StrutRecording::of(scenario, outcome, corner);
    let columns: Vec<(&str, &[f64])> = (columns.iter())
        .map(|(name, values)| (name.as_str(), values.as_slice()))
        .collect();
    let folder = corner.name();
    out.csv(&format!("{folder}/{}.csv", scenario.name), &columns)?;
    out.write(&format!("{folder}/model.toml"), model.to_toml())?;
    let campaign = out.destination().join(folder);
    Ok(format!(
        "{} recorded; next: oleo diagnose {}\n",
        folder,
        campaign.display()
    ))
}
