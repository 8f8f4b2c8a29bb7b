//! The files inside an FMU from which its model is made: `resources/fmu.toml` says what it is, beside it are the model files.

use std::path::Path;

use oleo_controller::VehicleDescription;
use oleo_plant_sim::handling::HandlingParameters;
use oleo_plant_sim::strut::StrutModel;
use oleo_plant_sim::vehicle::VehicleParameters;
use serde::{Deserialize, Serialize};

use crate::can_controller::can_controller;
use crate::complaint::Complaint;
use crate::controller::controller;
use crate::controller_parameters::DescriptionFile;
use crate::definition::Definition;
use crate::model::Model;
use crate::strut::strut;
use crate::vehicle::{Start, vehicle};

/// Says what the FMU is.
const SETTINGS: &str = "fmu.toml";
/// The model of a strut.
const STRUT: &str = "strut.toml";
/// Body, axles and tyres of a vehicle.
const VEHICLE: &str = "vehicle.toml";
/// Its steering and links.
const HANDLING: &str = "handling.toml";
/// What the controller knows of its vehicle.
const DESCRIPTION: &str = "vehicle-description.toml";

/// What an FMU is made of.
#[derive(Debug, Clone, PartialEq)]
pub struct Resources {
    settings: Settings,
    /// The other files, each with its text.
    files: Vec<(&'static str, String)>,
}

/// The file that says what the FMU is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
enum Settings {
    Strut {},
    Controller {},
    CanController {},
    Vehicle(Start),
}

impl Settings {
    /// Names of the files beside this one.
    fn files(&self) -> &'static [&'static str] {
        match self {
            Self::Strut {} => &[STRUT],
            Self::Controller {} | Self::CanController {} => &[DESCRIPTION],
            Self::Vehicle(_) => &[VEHICLE, HANDLING, STRUT],
        }
    }
}

impl Resources {
    /// One strut.
    pub fn strut(model: &StrutModel) -> Self {
        Self {
            settings: Settings::Strut {},
            files: vec![(STRUT, model.to_toml())],
        }
    }

    /// The controller of a vehicle.
    ///
    /// # Errors
    /// The description cannot be written as a file.
    pub fn controller(vehicle: VehicleDescription) -> Result<Self, Complaint> {
        let description = toml::to_string(&DescriptionFile::of(vehicle)).map_err(Complaint::new)?;
        Ok(Self {
            settings: Settings::Controller {},
            files: vec![(DESCRIPTION, description)],
        })
    }

    /// The controller of a vehicle as a node on CAN.
    ///
    /// # Errors
    /// The description cannot be written as a file.
    pub fn can_controller(vehicle: VehicleDescription) -> Result<Self, Complaint> {
        Ok(Self {
            settings: Settings::CanController {},
            ..Self::controller(vehicle)?
        })
    }

    /// A vehicle on four struts of one model.
    pub fn vehicle(
        vehicle: &VehicleParameters,
        handling: &HandlingParameters,
        strut: &StrutModel,
        start: Start,
    ) -> Self {
        Self {
            settings: Settings::Vehicle(start),
            files: vec![
                (VEHICLE, vehicle.to_toml()),
                (HANDLING, handling.to_toml()),
                (STRUT, strut.to_toml()),
            ],
        }
    }

    /// The files, each with its text.
    ///
    /// # Errors
    /// The settings cannot be written.
    pub fn files(&self) -> Result<Vec<(&'static str, String)>, Complaint> {
        let settings = toml::to_string(&self.settings).map_err(Complaint::new)?;
        Ok([vec![(SETTINGS, settings)], self.files.clone()].concat())
    }

    /// Reads the files of an unpacked FMU.
    ///
    /// # Errors
    /// A file is missing or is not what it should be.
    pub fn read(folder: &Path) -> Result<Self, Complaint> {
        let text = |file: &str| {
            let path = folder.join(file);
            std::fs::read_to_string(&path).map_err(|error| {
                Complaint::new(format!(
                    "{}: cannot be read: {error}; unpack the FMU again",
                    path.display()
                ))
            })
        };
        let settings: Settings = toml::from_str(&text(SETTINGS)?)
            .map_err(|error| Complaint::new(format!("{}: {error}", folder.join(SETTINGS).display())))?;
        let files = (settings.files().iter())
            .map(|file| Ok((*file, text(file)?)))
            .collect::<Result<_, _>>()?;
        Ok(Self { settings, files })
    }

    /// The definition of the FMU, and its model.
    ///
    /// # Errors
    /// A model file is wrong.
    pub fn build(&self) -> Result<(Definition, Box<dyn Model>), Complaint> {
        match &self.settings {
            Settings::Strut {} => {
                let model = StrutModel::from_toml(self.text(STRUT), STRUT).map_err(Complaint::new)?;
                let (definition, unit) = strut(&model)?;
                Ok((definition, Box::new(unit)))
            }
            Settings::Controller {} => {
                let (definition, unit) = controller(self.description()?);
                Ok((definition, Box::new(unit)))
            }
            Settings::CanController {} => {
                let (definition, unit) = can_controller(self.description()?);
                Ok((definition, Box::new(unit)))
            }
            Settings::Vehicle(start) => {
                let body = VehicleParameters::from_toml(self.text(VEHICLE), VEHICLE).map_err(Complaint::new)?;
                let handling = HandlingParameters::from_toml(self.text(HANDLING), HANDLING).map_err(Complaint::new)?;
                let model = StrutModel::from_toml(self.text(STRUT), STRUT).map_err(Complaint::new)?;
                let (definition, unit) = vehicle(&body, &handling, &model, start)?;
                Ok((definition, Box::new(unit)))
            }
        }
    }

    fn description(&self) -> Result<VehicleDescription, Complaint> {
        let file: DescriptionFile = toml::from_str(self.text(DESCRIPTION))
            .map_err(|error| Complaint::new(format!("{DESCRIPTION}: {error}")))?;
        Ok(file.vehicle())
    }

    fn text(&self, name: &str) -> &str {
        let file = self.files.iter().find(|(file, _)| *file == name);
        file.map_or("", |(_, text)| text)
    }
}
