//! Builds the road, the struts and the vehicle of a scenario before the clock starts.

use oleo_interface::tick::TICK_S;
use oleo_interface::{Axle, Corners};
use oleo_plant_sim::course::Drive;
use oleo_plant_sim::road;
use oleo_plant_sim::strut::StrutModel;
use oleo_plant_sim::vehicle::StrutElement;
use oleo_plant_sim::vehicle::{RideVehicle, VehicleParameters};

use super::error::RunError;
use super::parameters::Parameters;
use crate::scenario::Scenario;
use crate::vehicle::{Assembly, Vehicle};

/// The loaded vehicle of a scenario at its start.
///
/// # Errors
/// A file is missing or wrong, or the parts do not fit together.
pub fn vehicle(scenario: &Scenario) -> Result<Vehicle, RunError> {
    begin(scenario, &Parameters::read(scenario)?)
}

/// The same vehicle on four struts that differ, of which the controller is not told. Each is charged for the load that it carries.
///
/// # Errors
/// As [`vehicle`].
pub fn vehicle_on(scenario: &Scenario, struts: Corners<StrutModel>) -> Result<Vehicle, RunError> {
    begin(scenario, &Parameters::read(scenario)?.on_struts(struts))
}

pub(super) fn begin(scenario: &Scenario, parameters: &Parameters) -> Result<Vehicle, RunError> {
    let loaded = carried(scenario, &parameters.driven);
    let step_s = loaded.solver.step_s;
    let steps = TICK_S / step_s;
    if (steps - steps.round()).abs() > 1e-9 * steps || steps < 0.5 {
        return Err(RunError::Step {
            vehicle: scenario.vehicle.clone(),
            step_s,
        });
    }
    let charged = parameters.charged(loaded.static_strut_load_n());
    let struts = Parameters::at_rest(&charged)?;
    let unit_m = scenario
        .imu
        .as_ref()
        .map(|imu| from_centre_of(&loaded, &parameters.vehicle, imu.place_m()));
    let outline_m = parameters.handling.outline.corners_m(&loaded);
    let surface = |length_m: f64| road::from_name_or_path(&scenario.road, length_m, scenario.seed);
    let Some(settings) = &scenario.course else {
        let road = surface(scenario.road_length_m())?;
        let measured_m = road.measured_length_m();
        let model = RideVehicle::new(&loaded, struts, road, scenario.speed_m_s)?;
        let assembly = Assembly {
            parameters: loaded,
            struts: charged,
            outline_m,
        };
        let vehicle = Vehicle::on_road(model, assembly).with_inertial_unit_at(unit_m);
        return Ok(vehicle.over_measured(measured_m));
    };
    let manoeuvre = settings
        .manoeuvre(scenario.speed_m_s, Some(scenario.duration_s()))
        .map_err(RunError::Course)?;
    let course = settings.course(manoeuvre, surface(settings.road_length_m(&manoeuvre, &loaded))?);
    let drive = Drive::begin(&course, &loaded, &parameters.handling, struts.map(StrutElement::new))?;
    let assembly = Assembly {
        parameters: loaded,
        struts: charged,
        outline_m,
    };
    let vehicle = Vehicle::on_course(drive, assembly).with_inertial_unit_at(unit_m);
    Ok(vehicle.over_measured(course.road.measured_length_m()))
}

/// The vehicle that drives: with its load, and with what nobody is told.
fn carried(scenario: &Scenario, empty: &VehicleParameters) -> VehicleParameters {
    let mut vehicle = scenario.load.at_ride_height(empty);
    if let Some(payload) = &scenario.payload {
        vehicle = payload.on(&vehicle, empty);
    }
    match scenario.broken_anti_roll_link {
        Some(Axle::Front) => vehicle.front_axle.anti_roll_stiffness_n_m_rad = 0.0,
        Some(Axle::Rear) => vehicle.rear_axle.anti_roll_stiffness_n_m_rad = 0.0,
        None => {}
    }
    vehicle
}

/// A place of the body that is counted from its centre of mass in running order, counted from where that is with the load, m.
fn from_centre_of(loaded: &VehicleParameters, empty: &VehicleParameters, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let back_m = loaded.body_cg_behind_front_axle_m() - empty.body_cg_behind_front_axle_m();
    let up_m = loaded.body_cg_height_m() - empty.body_cg_height_m();
    [x + back_m, y, z - up_m]
}
