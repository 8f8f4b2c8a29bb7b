//! Parameters of the vehicle, its handling and its struts, from files or built in.

use std::path::{Path, PathBuf};

use oleo_plant_sim::handling::HandlingParameters;
use oleo_plant_sim::model_file::ModelFileError;
use oleo_plant_sim::strut::StrutModel;
use oleo_plant_sim::vehicle::VehicleParameters;
use oleo_report::{OutputDirectory, OutputError};

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
        })
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
        out.write("strut.toml", &self.strut_text)
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
