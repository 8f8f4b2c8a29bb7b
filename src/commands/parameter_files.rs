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

/// Name in the results, and text of what is built in.
pub const VEHICLE: (&str, &str) = ("vehicle.toml", VehicleParameters::DEFENDER110_TOML);
pub const HANDLING: (&str, &str) = ("handling.toml", HandlingParameters::DEFENDER110_TOML);
pub const STRUT: (&str, &str) = ("strut.toml", StrutModel::DEFENDER110_TOML);

/// Puts parameters that were used into the results, so that they can be given back: the given file, or what is built in.
pub fn keep(
    out: &mut OutputDirectory,
    (name, built_in): (&str, &str),
    given: Option<impl AsRef<Path>>,
) -> Result<(), Failure> {
    let text = match given {
        Some(path) => read(path.as_ref(), "parameters")?.0,
        None => built_in.to_owned(),
    };
    Ok(out.write(name, text)?)
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
