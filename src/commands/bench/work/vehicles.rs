//! Closed loops of many vehicles, as the studies of the controller run them.

use oleo_hil::comparison::{Bench, DriveCase, Figures, Group, Setting, compare, jobs};
use oleo_interface::tick::TICK_S;
use oleo_plant_sim::study::Records;
use oleo_report::digest;

use super::contract::Work;
use crate::failure::Failure;

/// Class C at 60 km/h, as in the study of random vehicles.
const ROAD: &str = "iso-c";
const SPEED_M_S: f64 = 60.0 / 3.6;
/// Duration of a drive, s.
const DRIVE_S: f64 = 2.0;

/// Vehicles, each with its road.
pub struct Vehicles {
    bench: Bench,
    setting: Setting,
    group: Group,
    driven: Vec<Figures>,
}

impl Vehicles {
    /// Chooses the drives.
    pub fn prepare(vehicles: u64) -> Result<Self, Failure> {
        let bench = Bench::defender110();
        let controller = bench.controller();
        let name = controller.strategy.name();
        let setting = Setting::Controlled(name, Box::new(controller.build()?));
        let cases = (1..=vehicles).map(|seed| DriveCase::straight(ROAD, SPEED_M_S, DRIVE_S, seed));
        Ok(Self {
            bench,
            setting,
            group: Group {
                name: "bench".to_owned(),
                road: ROAD,
                cases: cases.collect(),
            },
            driven: Vec::new(),
        })
    }
}

impl Work for Vehicles {
    fn run(&mut self) -> Result<u64, Failure> {
        let (groups, settings) = (std::slice::from_ref(&self.group), std::slice::from_ref(&self.setting));
        let jobs = jobs(groups, settings);
        self.driven = compare(&self.bench, &jobs, &Records::in_memory(), || {}, || false)?;
        Ok((DRIVE_S / TICK_S).round() as u64 * self.driven.len() as u64)
    }

    fn outcome(&self) -> Result<String, Failure> {
        Ok(digest::of_bytes(format!("{:?}", self.driven).as_bytes()))
    }
}
