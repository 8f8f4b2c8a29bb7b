//! Drives the closed loop with a vehicle as it is believed to be and as it was found.

use std::path::Path;

use oleo_diagnose::vehicle::{BodyModel, DRIVES, Driven, Felt, VehicleCampaign, VehicleDiagnosis};
use oleo_hil::metrics::Metrics;
use oleo_hil::run::{self, Parameters};
use oleo_hil::scenario::check::{Figure, Metric};
use oleo_hil::scenario::{self, Scenario};
use oleo_interface::{Corner, Corners};
use oleo_plant_sim::strut::StrutModel;
use rayon::prelude::*;

use crate::failure::Failure;

/// The built-in scenario whose ride counts: straight ahead over Belgian block.
const ROUGH_ROAD: &str = "belgian";
/// The built-in scenario whose roll counts: a lane change on the same road.
const LANE_CHANGE: &str = "lane-change-on-belgian";

/// What the driver feels of what was found. `folder` holds the vehicle's files.
pub fn driven(campaign: &VehicleCampaign, diagnosis: &VehicleDiagnosis, folder: &Path) -> Result<Driven, String> {
    let both = || -> Result<Driven, Failure> {
        let believed = &campaign.model.struts;
        let scenario = |name: &str| scenario_with(campaign, folder, name);
        let mut struts = diagnosis.struts(campaign)?;
        if let Some(balanced) = diagnosis.balanced() {
            balanced.on_struts(believed, &mut struts);
        }
        Ok(Driven {
            rough_road: ROUGH_ROAD.to_owned(),
            lane_change: LANE_CHANGE.to_owned(),
            believed: felt(scenario, |told| told.on_struts(physical(believed)))?,
            found: felt(scenario, |told| {
                let body = diagnosis
                    .balanced()
                    .map_or_else(|| told.vehicle.clone(), |balanced| balanced.on_body(&told.vehicle));
                told.on_struts(physical(&struts)).under(body)
            })?,
        })
    };
    both().map_err(|failure| failure.to_string())
}

/// A built-in scenario with the vehicle that is believed, and its parameters: the controller is told of the believed front left strut.
fn scenario_with(campaign: &VehicleCampaign, folder: &Path, name: &str) -> Result<(Scenario, Parameters), Failure> {
    let mut scenario = scenario::named(name)?;
    if let Some(file) = campaign.model.body.as_ref().and_then(BodyModel::own_file) {
        scenario.vehicle = folder.join(file).display().to_string();
    }
    let strut = campaign.model.struts[Corner::FrontLeft].clone();
    let told = Parameters::read(&scenario)?.telling_of(strut);
    Ok((scenario, told))
}

/// The struts without what a reading suffers.
fn physical(struts: &Corners<StrutModel>) -> Corners<StrutModel> {
    let mut physical = struts.clone();
    physical
        .values_mut()
        .for_each(|strut| strut.effects.retain_sensor_faults(|_| false));
    physical
}

/// What is felt in scenarios, seed by seed, of the vehicle that is made of what the controller is told.
fn felt(
    scenario: impl Fn(&str) -> Result<(Scenario, Parameters), Failure>,
    vehicle: impl Fn(Parameters) -> Parameters,
) -> Result<[Felt; DRIVES], Failure> {
    let read = |name: &str| scenario(name).map(|(scenario, told)| (scenario, vehicle(told)));
    let (rough_road, lane_change) = (read(ROUGH_ROAD)?, read(LANE_CHANGE)?);
    let metrics = |(scenario, vehicle): &(Scenario, Parameters), seed: u64| -> Result<Metrics, Failure> {
        let scenario = Scenario {
            seed,
            ..scenario.clone()
        };
        let outcome = run::both_of(&scenario, vehicle, &mut |_| true)?;
        Ok(Metrics::of(&scenario, &outcome))
    };
    let drive = |seed: u64| -> Result<Felt, Failure> {
        let [driver, rear_left] = metrics(&rough_road, seed)?.seats.map(|seat| seat.weighted_rms_m_s2);
        let Figure::Number(roll_deg) = metrics(&lane_change, seed)?.figure(Metric::MaxRoll) else {
            return Err(Failure::new(format!("{LANE_CHANGE}: the body's roll is not known")));
        };
        Ok(Felt {
            driver_m_s2: driver,
            rear_left_m_s2: rear_left,
            roll_deg,
        })
    };
    let drives = (1..=DRIVES as u64).into_par_iter().map(drive);
    let felt: Vec<Felt> = drives.collect::<Result<_, _>>()?;
    felt.try_into()
        .map_err(|_| Failure::new("the loop was not driven as often as asked".to_owned()))
}
