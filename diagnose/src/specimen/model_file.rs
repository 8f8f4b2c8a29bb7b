//! Reads a model file of any kind. This is the only place that knows all kinds of specimen.

use oleo_plant_sim::model_file::InvalidValue;
use oleo_plant_sim::model_file::names::suggestion;
use oleo_plant_sim::specimen::{CylinderModel, DamperModel, DriveModel, GasSpringModel, specimen_name};
use oleo_plant_sim::strut::StrutModel;
use strum::VariantArray;

use super::contract::BelievedModel;
use crate::error::DiagnoseError;
use crate::vocabulary::SpecimenKind;

/// A model file that was read and checked.
pub struct ModelFile {
    /// Name of the specimen.
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
        let head = specimen_name(text, source)?;
        let kind: SpecimenKind = (head.kind.parse()).map_err(|_| unknown(&head.kind).in_file(text, source))?;
        let model: Box<dyn BelievedModel> = match kind {
            SpecimenKind::TwoStageStrut => Box::new(StrutModel::from_toml(text, source)?),
            SpecimenKind::GasSpring => Box::new(GasSpringModel::from_toml(text, source)?),
            SpecimenKind::Cylinder => Box::new(CylinderModel::from_toml(text, source)?),
            SpecimenKind::Damper => Box::new(DamperModel::from_toml(text, source)?),
            SpecimenKind::Drive => Box::new(DriveModel::from_toml(text, source)?),
            SpecimenKind::CoSimulation => return Err(unknown(&head.kind).in_file(text, source).into()),
        };
        model.check_noise().map_err(|invalid| invalid.in_file(text, source))?;
        Ok(Self { name: head.name, model })
    }
}

fn unknown(kind: &str) -> InvalidValue {
    let kinds: Vec<&str> = (SpecimenKind::VARIANTS.iter())
        .filter(|kind| **kind != SpecimenKind::CoSimulation)
        .map(|kind| kind.as_str())
        .collect();
    let what = format!("is {kind:?}: {}", suggestion(kind, &kinds, "kinds"));
    InvalidValue::new("kind", what).inside("specimen")
}
