//! A model with the map to its recordings, and what of it may be off within tolerance.

use std::sync::Arc;

use oleo_plant_sim::model_file::ModelFileError;

use super::fit;
use super::map::Map;
use super::simulator::Simulator;
use crate::parameter::Parameter;
use crate::specimen::hypothesis::Hypothesis;
use crate::specimen::model_file::ModelFile;

/// A model with the map to its recordings.
pub struct CoSimulationModel {
    pub(super) map: Map,
    pub(super) simulator: Arc<dyn Simulator>,
}

impl CoSimulationModel {
    /// A model with a map that fits it. `text` and `file` are those of the map, for messages.
    ///
    /// # Errors
    /// What in the map does not fit the model, with its line.
    pub fn new(map: Map, text: &str, file: &str, simulator: Arc<dyn Simulator>) -> Result<Self, ModelFileError> {
        fit::check(&map, simulator.variables()).map_err(|invalid| invalid.in_file(text, file))?;
        Ok(Self { map, simulator })
    }

    /// As a model file that was read.
    #[must_use]
    pub fn into_model_file(self) -> ModelFile {
        let name = match &self.map.specimen {
            Some(specimen) => specimen.name.clone(),
            None => self.simulator.name().to_owned(),
        };
        ModelFile {
            name,
            model: Box::new(self),
        }
    }

    /// Place of a variable among those of the model. The map was checked, so that it is there.
    pub(super) fn variable(&self, name: &str) -> usize {
        (self.simulator.variables().iter())
            .position(|variable| variable.name == name)
            .unwrap_or_default()
    }

    /// The value of a setting where the map or the model states one.
    pub(super) fn stated(&self, name: &str) -> Option<f64> {
        let own = self.map.parameters.get(name).and_then(|setting| setting.value);
        own.or(self.simulator.variables()[self.variable(name)].start)
    }

    /// What may be off within tolerance: settings, offsets of inputs, offsets of outputs, each in the order of the map.
    pub(super) fn calibrated(&self) -> Vec<(Calibrated<'_>, f64)> {
        let settings = self.map.parameters.iter().filter_map(|(name, setting)| {
            let relative = setting.tolerance.map(|part| (Calibrated::Part(name), part));
            relative.or(setting.tolerance_absolute.map(|size| (Calibrated::Setting(name), size)))
        });
        let inputs = (self.map.inputs.iter())
            .filter_map(|(name, input)| Some((Calibrated::InputOffset(name), input.offset_tolerance?)));
        let outputs = (self.map.outputs.values())
            .filter_map(|output| Some((Calibrated::OutputOffset(&output.column), output.offset_tolerance?)));
        settings.chain(inputs).chain(outputs).collect()
    }

    pub(super) fn calibration(&self) -> Vec<Parameter> {
        (self.calibrated().into_iter())
            .map(|(calibrated, tolerance)| match calibrated {
                Calibrated::Part(name) => Parameter::calibration(format!("{name} (relative)"), tolerance),
                Calibrated::Setting(name) => Parameter::calibration(name, tolerance),
                Calibrated::InputOffset(name) => Parameter::calibration(format!("{name} offset"), tolerance),
                Calibrated::OutputOffset(column) => {
                    Parameter::calibration(format!("{column} offset"), tolerance).on_instrument()
                }
            })
            .collect()
    }

    /// The deviation of a calibrated value in a hypothesis; zero for what is not calibrated.
    pub(super) fn deviation(&self, of: Calibrated, hypothesis: &Hypothesis) -> f64 {
        let position = self.calibrated().iter().position(|(calibrated, _)| *calibrated == of);
        let deviation = position.and_then(|position| hypothesis.calibration.get(position));
        deviation.copied().unwrap_or(0.0)
    }

    /// The value of a setting in a hypothesis.
    pub(super) fn calibrated_value(&self, name: &str, value: f64, hypothesis: &Hypothesis) -> f64 {
        let part = self.deviation(Calibrated::Part(name), hypothesis);
        value * (1.0 + part) + self.deviation(Calibrated::Setting(name), hypothesis)
    }
}

/// What may be off within tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Calibrated<'m> {
    /// A setting, by a part of its value.
    Part(&'m str),
    /// A setting, in its unit.
    Setting(&'m str),
    /// The offset of an input, by its variable.
    InputOffset(&'m str),
    /// The offset of a compared column.
    OutputOffset(&'m str),
}
