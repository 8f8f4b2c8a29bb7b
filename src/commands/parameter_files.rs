//! Parameters of the vehicle, its handling and its struts, from files or built in.

use std::path::{Path, PathBuf};

use oleo_plant_sim::handling::HandlingParameters;
use oleo_plant_sim::strut::StrutModel;
use oleo_plant_sim::vehicle::VehicleParameters;

use oleo_report::OutputDirectory;

use crate::failure::Failure;

/// Reads the given files, and uses the built-in defender110 if a file is not given.
pub fn parameters(
    vehicle: Option<&PathBuf>,
    handling: Option<&PathBuf>,
) -> Result<(VehicleParameters, HandlingParameters), Failure> {
    let vehicle = match vehicle {
        Some(path) => {
            let (text, name) = read(path, "parameters")?;
            VehicleParameters::from_toml(&text, &name)?
        }
        None => VehicleParameters::defender110(),
    };
    let handling = match handling {
        Some(path) => {
            let (text, name) = read(path, "parameters")?;
            HandlingParameters::from_toml(&text, &name)?
        }
        None => HandlingParameters::defender110(),
    };
    Ok((vehicle, handling))
}

/// The strut in a model file, charged for the load that the file says.
pub fn strut(path: &Path) -> Result<StrutModel, Failure> {
    let (text, name) = read(path, "model")?;
    Ok(StrutModel::from_toml(&text, &name)?)
}

/// Puts the parameters that were used into the results, so that they can be given back: each given file, or what is built in.
pub fn keep(
    out: &mut OutputDirectory,
    vehicle: Option<&Path>,
    handling: Option<&Path>,
    strut: Option<&Path>,
) -> Result<(), Failure> {
    for (name, given, built_in) in [
        ("vehicle.toml", vehicle, VehicleParameters::DEFENDER110_TOML),
        ("handling.toml", handling, HandlingParameters::DEFENDER110_TOML),
        ("strut.toml", strut, StrutModel::DEFENDER110_TOML),
    ] {
        match given {
            Some(path) => out.write(name, read(path, "parameters")?.0)?,
            None => out.write(name, built_in)?,
        }
    }
    Ok(())
}

/// Text and name of a file of `what`.
pub fn read(path: &Path, what: &str) -> Result<(String, String), Failure> {
    let name = path.display().to_string();
    match std::fs::read_to_string(path) {
        Ok(text) => Ok((text, name)),
        Err(error) => Err(Failure::new(format!(
            "{name}: cannot read the {what}: {error}; check the path"
        ))),
    }
}
