//! Builds the road, the struts and the vehicle of a scenario before the clock starts.

use std::sync::Arc;

use oleo_interface::tick::TICK_S;
use oleo_interface::{Corners, StrutValves};
use oleo_plant_sim::road;
use oleo_plant_sim::strut::{Strut, StrutModel};
use oleo_plant_sim::vehicle::{RideVehicle, VehicleParameters};

use super::error::RunError;
use crate::scenario::Scenario;
use crate::scenario::file::DEFENDER;

/// The plant's parts, made before the clock starts.
pub struct Plant {
    pub(super) parameters: VehicleParameters,
    pub(super) vehicle: RideVehicle,
}

impl Plant {
    /// Makes road, struts and vehicle of a scenario.
    ///
    /// # Errors
    /// A file is missing or wrong, or the parts do not fit together.
    pub fn build(scenario: &Scenario) -> Result<Self, RunError> {
        let read = |path: &str| {
            std::fs::read_to_string(path).map_err(|source| RunError::Unreadable {
                path: path.into(),
                source,
            })
        };
        let parameters = match scenario.vehicle.as_str() {
            DEFENDER => VehicleParameters::defender110(),
            path => VehicleParameters::from_toml(&read(path)?, path)?,
        };
        let step_s = parameters.solver.step_s;
        let steps = TICK_S / step_s;
        if (steps - steps.round()).abs() > 1e-9 * steps || steps < 0.5 {
            return Err(RunError::Step {
                vehicle: scenario.vehicle.clone(),
                step_s,
            });
        }
        let model = match scenario.strut.as_str() {
            DEFENDER => None,
            path => Some(StrutModel::from_toml(&read(path)?, path)?),
        };
        // Each strut is charged for the load that it carries, as in a workshop.
        let mut struts = Vec::with_capacity(4);
        for load_n in parameters.static_strut_load_n().into_array() {
            let model = match &model {
                None => StrutModel::defender110(load_n),
                Some(model) => {
                    let mut charged = model.clone();
                    charged.cylinder.static_pressure_pa = load_n / model.piston_area_m2();
                    charged
                }
            };
            struts.push(Strut::at_rest(&model, StrutValves::default())?);
        }
        let Ok(struts) = <[Strut; 4]>::try_from(struts) else {
            unreachable!("four loads make four struts")
        };
        let road: Arc<dyn road::Road> =
            road::from_name_or_path(&scenario.road, scenario.road_length_m(), scenario.seed)?;
        let vehicle = RideVehicle::new(&parameters, Corners::from_array(struts), road, scenario.speed_m_s)?;
        Ok(Self { parameters, vehicle })
    }
}
