//! A model file of any kind: the one place that knows all kinds of specimen.

use oleo_plant_sim::specimen::{CylinderModel, GasSpringModel, specimen_name};
use oleo_plant_sim::strut::StrutModel;
use strum::VariantArray;

use super::contract::BelievedModel;
use super::kind::SpecimenKind;
use crate::error::DiagnoseError;

/// A model file that was read and checked.
pub struct ModelFile {
    /// Name of the individual.
    pub name: String,
    /// What is believed of it.
    pub model: Box<dyn BelievedModel>,
}

impl ModelFile {
    /// Reads a model file; `source` names it in messages.
    ///
    /// # Errors
    /// One line: source, line or key, what is wrong, what to do.
    pub fn read(text: &str, source: &str) -> Result<Self, DiagnoseError> {
        let head = specimen_name(text, source).map_err(DiagnoseError::Model)?;
        let kind: SpecimenKind = (head.kind.parse()).map_err(|_| unknown(&head.kind, source))?;
        let model: Box<dyn BelievedModel> = match kind {
            SpecimenKind::TwoStageStrut => {
                Box::new(StrutModel::from_toml(text, source).map_err(|e| DiagnoseError::Model(e.to_string()))?)
            }
            SpecimenKind::GasSpring => Box::new(GasSpringModel::from_toml(text, source).map_err(DiagnoseError::Model)?),
            SpecimenKind::Cylinder => Box::new(CylinderModel::from_toml(text, source).map_err(DiagnoseError::Model)?),
        };
        Ok(Self { name: head.name, model })
    }
}

fn unknown(kind: &str, source: &str) -> DiagnoseError {
    let known: Vec<String> = SpecimenKind::VARIANTS.iter().map(|k| format!("'{k}'")).collect();
    DiagnoseError::Model(format!(
        "{source}, key specimen.kind: '{kind}' is not known; use one of {}",
        known.join(", ")
    ))
}
