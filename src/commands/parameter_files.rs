//! Vehicle and handling parameters, from files or built in.

use std::path::PathBuf;

use oleo_plant_sim::handling::HandlingParameters;
use oleo_plant_sim::vehicle::VehicleParameters;

use crate::failure::Failure;

/// Reads the given files, and uses the built-in defender110 if a file is not given.
pub fn parameters(
    vehicle: Option<&PathBuf>,
    handling: Option<&PathBuf>,
) -> Result<(VehicleParameters, HandlingParameters), Failure> {
    let read = |path: &PathBuf| {
        let name = path.display().to_string();
        let text = std::fs::read_to_string(path)
            .map_err(|error| Failure::new(format!("{name}: cannot read the parameters: {error}; check the path")))?;
        Ok::<_, Failure>((text, name))
    };
    let vehicle = match vehicle {
        Some(path) => {
            let (text, name) = read(path)?;
            VehicleParameters::from_toml(&text, &name)?
        }
        None => VehicleParameters::defender110(),
    };
    let handling = match handling {
        Some(path) => {
            let (text, name) = read(path)?;
            HandlingParameters::from_toml(&text, &name)?
        }
        None => HandlingParameters::defender110(),
    };
    Ok((vehicle, handling))
}
