//! Parameters of the vehicle, its handling and its struts, from files or built in.

use std::path::{Path, PathBuf};

use oleo_interface::Corners;
use oleo_plant_sim::handling::HandlingParameters;
use oleo_plant_sim::model_file::ModelFileError;
use oleo_plant_sim::strut::StrutModel;
use oleo_plant_sim::vehicle::VehicleParameters;
use oleo_report::{OutputDirectory, OutputError};

use crate::scenario::file::DEFENDER;
use crate::scenario::{Scenario, kept_as};

/// Parameters as they were read, once, so that results hold what was used.
pub struct Parameters {
    /// Body, axles, seats.
    pub vehicle: VehicleParameters,
    /// Steering, tyres, brakes, driver.
    pub handling: HandlingParameters,
    /// Charged for the load that its file says.
    pub strut: StrutModel,
    vehicle_text: String,
    handling_text: String,
    strut_text: String,
    /// Texts of the models of struts that differ.
    strut_at_text: Corners<Option<String>>,
}

impl Parameters {
    /// Reads the given files, and uses the built-in defender110 if a file is not given.
    ///
    /// # Errors
    /// A file cannot be read, or is wrong; one line with file, line and key.
    pub fn read(
        vehicle: Option<&PathBuf>,
        handling: Option<&PathBuf>,
        strut: Option<&PathBuf>,
    ) -> Result<Self, ModelFileError> {
        let given = |path: Option<&PathBuf>, what: &str, built_in: &str| match path {
            Some(path) => read(path, what),
            None => Ok((built_in.to_owned(), "presets".to_owned())),
        };
        let (vehicle_text, vehicle) = given(vehicle, "parameters", VehicleParameters::DEFENDER110_TOML)?;
        let (handling_text, handling) = given(handling, "parameters", HandlingParameters::DEFENDER110_TOML)?;
        let (strut_text, strut) = given(strut, "model", StrutModel::DEFENDER110_TOML)?;
        Ok(Self {
            vehicle: VehicleParameters::from_toml(&vehicle_text, &vehicle)?,
            handling: HandlingParameters::from_toml(&handling_text, &handling)?,
            strut: StrutModel::from_toml(&strut_text, &strut)?,
            vehicle_text,
            handling_text,
            strut_text,
            strut_at_text: Corners::default(),
        })
    }

    /// The same with the struts of a scenario that differ from the others.
    ///
    /// # Errors
    /// A file cannot be read.
    pub fn with_struts_of(self, scenario: &Scenario) -> Result<Self, ModelFileError> {
        let strut_at_text = Corners::try_from_fn(|corner| match scenario.strut_at[corner].as_deref() {
            None => Ok(None),
            Some(DEFENDER) => Ok(Some(StrutModel::DEFENDER110_TOML.to_owned())),
            Some(path) => read(Path::new(path), "model").map(|(text, _)| Some(text)),
        })?;
        Ok(Self { strut_at_text, ..self })
    }

    /// Puts the parameters of vehicle and handling into the results, so that they can be given back.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn keep_vehicle(&self, out: &mut OutputDirectory) -> Result<(), OutputError> {
        out.write("vehicle.toml", &self.vehicle_text)?;
        out.write("handling.toml", &self.handling_text)
    }

    /// Puts all of them into the results.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn keep(&self, out: &mut OutputDirectory) -> Result<(), OutputError> {
        self.keep_vehicle(out)?;
        out.write("strut.toml", &self.strut_text)?;
        for (corner, text) in self.strut_at_text.iter() {
            if let Some(text) = text {
                out.write(&kept_as(corner), text)?;
            }
        }
        Ok(())
    }
}

/// The strut in a model file, charged for the load that the file says.
///
/// # Errors
/// As [`Parameters::read`].
pub fn strut(path: &Path) -> Result<StrutModel, ModelFileError> {
    let (text, name) = read(path, "model")?;
    StrutModel::from_toml(&text, &name)
}

/// Text and name of a file of `what`.
///
/// # Errors
/// The file cannot be read.
pub fn read(path: &Path, what: &str) -> Result<(String, String), ModelFileError> {
    let name = path.display().to_string();
    match std::fs::read_to_string(path) {
        Ok(text) => Ok((text, name)),
        Err(error) => {
            let what = format!("cannot read the {what}: {error}; check the path");
            Err(ModelFileError::new(&name, None, &what))
        }
    }
}
