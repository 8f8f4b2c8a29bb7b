//! Model and drives of a vehicle put together: a strut with its recordings at every corner.

use oleo_interface::{Corner, Corners};
use oleo_plant_sim::strut::StrutModel;

use super::bridge::bridge;
use super::drive::{Drive, Resolution};
use super::model::VehicleModel;
use super::stretch::{BridgedDrive, choose};
use crate::campaign::{Campaign, MODEL_FILE};
use crate::error::DiagnoseError;
use crate::specimen::strut::TwoStageStrut;

/// A rounded reading is off by at most half a step, and its error is even within: variance step^2 / 12.
const VARIANCE_OF_ROUNDING: f64 = 1.0 / 12.0;

/// A vehicle ready to be diagnosed.
pub struct VehicleCampaign {
    /// The model files as they are believed.
    pub model: VehicleModel,
    /// Each strut with its recordings.
    pub corners: Corners<Campaign>,
    /// What was used of the drives, one sentence each.
    pub notes: Vec<String>,
}

impl VehicleCampaign {
    /// Puts the model of a vehicle and its drives together. `source` names the drives in messages.
    ///
    /// # Errors
    /// Drives of which nothing can be used; a strut that cannot be at rest.
    pub fn of(
        model: VehicleModel,
        drives: &[Drive],
        resolution: Resolution,
        source: &str,
    ) -> Result<Self, DiagnoseError> {
        let bridged: Vec<BridgedDrive> = (drives.iter())
            .map(|drive| BridgedDrive {
                name: drive.name.clone(),
                is_first: drive.is_first,
                struts: drive.struts.each_ref().map(bridge),
            })
            .collect();
        let chosen = choose(&bridged);
        let campaign = |corner: Corner| {
            let recordings = chosen.recordings[corner].clone();
            if recordings.is_empty() {
                let why = chosen
                    .notes
                    .first()
                    .map_or_else(String::new, |note| format!(" ({note})"));
                return Err(DiagnoseError::file(
                    source,
                    format!(
                        "nothing of the {} strut can be used{why}; log drives that begin at rest, for at least a minute",
                        corner.name()
                    ),
                ));
            }
            let strut = as_read(&model.struts[corner], resolution);
            let specimen = TwoStageStrut::in_vehicle(strut, recordings).map_err(DiagnoseError::Model)?;
            Ok(Campaign {
                folder: source.into(),
                name: format!("{} strut", corner.name()),
                specimen: Box::new(specimen),
                notes: vec![],
            })
        };
        let [a, b, c, d] = Corner::ALL.map(campaign);
        Ok(Self {
            corners: Corners::from_array([a?, b?, c?, d?]),
            model,
            notes: chosen.notes,
        })
    }

    /// Names of the files in which the improved model is written: the struts', and `model.toml`.
    #[must_use]
    pub fn model_files(&self) -> Vec<String> {
        let struts = self.model.distinct_files().into_array();
        std::iter::once(MODEL_FILE.to_owned()).chain(struts).collect()
    }
}

/// A strut whose readings are rounded besides being noisy.
fn as_read(strut: &StrutModel, resolution: Resolution) -> StrutModel {
    let mut strut = strut.clone();
    for (column, noise) in &mut strut.noise {
        let step = match column.as_str() {
            "displacement_m" => resolution.displacement_m,
            "force_N" => 0.0,
            _ => resolution.pressure_pa,
        };
        *noise = (*noise * *noise + VARIANCE_OF_ROUNDING * step * step).sqrt();
    }
    strut
}
