//! What the files of a scenario say of its vehicle: body, axles, steering, struts.

use oleo_controller::VehicleDescription;
use oleo_interface::{Corners, StrutValves};
use oleo_plant_sim::handling::HandlingParameters;
use oleo_plant_sim::strut::{Strut, StrutModel};
use oleo_plant_sim::vehicle::VehicleParameters;

use super::error::RunError;
use crate::description::describe;
use crate::scenario::Scenario;
use crate::scenario::file::DEFENDER;

/// Parameters of a vehicle that carries nothing.
pub struct Parameters {
    /// Body, axles, tyres, as the controller is told.
    pub vehicle: VehicleParameters,
    /// Steering, links, driver.
    pub handling: HandlingParameters,
    /// Those of the vehicle that drives.
    pub(super) driven: VehicleParameters,
    /// The strut that the controller is told of, charged for some load.
    strut: StrutModel,
    /// The struts that the vehicle stands on, charged for some load.
    struts: Corners<StrutModel>,
}

impl Parameters {
    /// Reads the files that a scenario names.
    ///
    /// # Errors
    /// A file is missing or wrong.
    pub fn read(scenario: &Scenario) -> Result<Self, RunError> {
        let text = |path: &str| {
            std::fs::read_to_string(path).map_err(|source| RunError::Unreadable {
                path: path.into(),
                source,
            })
        };
        let model = |name: &str| -> Result<StrutModel, RunError> {
            Ok(match name {
                DEFENDER => StrutModel::defender110(1.0),
                path => StrutModel::from_toml(&text(path)?, path)?,
            })
        };
        let strut = model(&scenario.strut)?;
        let vehicle = match scenario.vehicle.as_str() {
            DEFENDER => VehicleParameters::defender110(),
            path => VehicleParameters::from_toml(&text(path)?, path)?,
        };
        Ok(Self {
            struts: Corners::try_from_fn(|corner| match &scenario.strut_at[corner] {
                Some(name) => model(name),
                None => Ok(strut.clone()),
            })?,
            strut,
            driven: vehicle.clone(),
            vehicle,
            handling: match scenario.handling.as_str() {
                DEFENDER => HandlingParameters::defender110(),
                path => HandlingParameters::from_toml(&text(path)?, path)?,
            },
        })
    }

    /// The same vehicle on other struts, of which the controller is not told.
    pub fn on_struts(self, struts: Corners<StrutModel>) -> Self {
        Self { struts, ..self }
    }

    /// The same struts under another body and on other axles, of which the controller is not told.
    pub fn under(self, driven: VehicleParameters) -> Self {
        Self { driven, ..self }
    }

    /// The same vehicle with a controller that is told of another strut.
    pub fn telling_of(self, strut: StrutModel) -> Self {
        Self { strut, ..self }
    }

    /// What the controller knows of the vehicle.
    pub fn description(&self) -> VehicleDescription {
        describe(&self.vehicle, &self.handling, &self.strut)
    }

    /// The models of the four struts, each charged for the load (N) that it carries, as in a workshop.
    pub fn charged(&self, load_n: Corners<f64>) -> Corners<StrutModel> {
        Corners::from_fn(|corner| self.struts[corner].clone().charged_for(load_n[corner]))
    }

    /// Four struts at rest; all valves closed.
    ///
    /// # Errors
    /// A strut that cannot be charged for its load.
    pub fn at_rest(charged: &Corners<StrutModel>) -> Result<Corners<Strut>, RunError> {
        Corners::try_from_fn(|corner| Ok(Strut::at_rest(&charged[corner], StrutValves::default())?))
    }
}
