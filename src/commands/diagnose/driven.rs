//! Drives the closed loop with the struts of a vehicle as they are believed to be and as they were found.

use std::path::Path;

use oleo_diagnose::vehicle::{BodyModel, Driven, Felt, VehicleCampaign, VehicleDiagnosis};
use oleo_hil::metrics::Metrics;
use oleo_hil::run::{self, Parameters};
use oleo_hil::scenario;
use oleo_hil::scenario::check::{Figure, Metric};
use oleo_interface::{Corner, Corners};
use oleo_plant_sim::strut::StrutModel;

use crate::failure::Failure;

/// The built-in scenario whose ride counts: straight ahead over Belgian block.
const ROUGH_ROAD: &str = "belgian";
/// The built-in scenario whose roll counts: a lane change on the same road.
const LANE_CHANGE: &str = "lane-change-on-belgian";

/// What the driver feels of what was found. `folder` holds the vehicle's files.
pub fn driven(campaign: &VehicleCampaign, diagnosis: &VehicleDiagnosis, folder: &Path) -> Result<Driven, String> {
    let both = || -> Result<Driven, Failure> {
        let believed = &campaign.model.struts;
        let vehicle = (campaign.model.body.as_ref())
            .and_then(BodyModel::own_file)
            .map(|file| folder.join(file));
        let felt = |struts: &Corners<StrutModel>| felt(struts, &believed[Corner::FrontLeft], vehicle.as_deref());
        Ok(Driven {
            rough_road: ROUGH_ROAD.to_owned(),
            lane_change: LANE_CHANGE.to_owned(),
            believed: felt(believed)?,
            found: felt(&diagnosis.struts(campaign)?)?,
        })
    };
    both().map_err(|failure| failure.to_string())
}

/// What is felt on these struts. The controller is told of one strut, as of every vehicle.
fn felt(struts: &Corners<StrutModel>, told: &StrutModel, vehicle: Option<&Path>) -> Result<Felt, Failure> {
    // What a reading suffers is not the strut's.
    let mut physical = struts.clone();
    physical
        .values_mut()
        .for_each(|strut| strut.effects.retain_sensor_faults(|_| false));
    let metrics = |name: &str| -> Result<Metrics, Failure> {
        let mut scenario = scenario::named(name)?;
        if let Some(path) = vehicle {
            scenario.vehicle = path.display().to_string();
        }
        let parameters = Parameters::read(&scenario)?
            .on_struts(physical.clone())
            .telling_of(told.clone());
        let outcome = run::both_of(&scenario, &parameters, &mut |_| true)?;
        Ok(Metrics::of(&scenario, &outcome))
    };
    let (rough_road, lane_change) = (metrics(ROUGH_ROAD)?, metrics(LANE_CHANGE)?);
    let [driver, rear_left] = rough_road.seats.map(|seat| seat.weighted_rms_m_s2);
    let Figure::Number(roll_deg) = lane_change.figure(Metric::MaxRoll) else {
        return Err(Failure::new(format!("{LANE_CHANGE}: the body's roll is not known")));
    };
    Ok(Felt {
        driver_m_s2: driver,
        rear_left_m_s2: rear_left,
        roll_deg,
    })
}
