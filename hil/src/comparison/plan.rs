//! Which drives are compared: straight ahead on rough roads for the ride, lane changes and steps of steer for the roll.

use oleo_plant_sim::course::{DriverStyle, LaneChange};

use super::case::DriveCase;

/// Steering angle at the front wheels in the step of steer, rad: 4 m/s2 at 60 km/h.
const STEP_RAD: f64 = 0.06;

/// How much is compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// First seed of roads and sensors.
    pub first_seed: u64,
    /// Number of seeds.
    pub seeds: u64,
    /// Duration of a drive straight ahead, s.
    pub straight_s: f64,
    /// Whether only classes C and Belgian block, one speed each, and two manoeuvres are driven.
    pub quick: bool,
}

/// Drives that differ by their seed only.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Road, manoeuvre and speed, in words.
    pub name: String,
    /// Name of the road.
    pub road: &'static str,
    /// One case for each seed.
    pub cases: Vec<DriveCase>,
}

impl Group {
    fn new(road: &'static str, extent: &Extent, case: impl Fn(u64) -> DriveCase) -> Self {
        let seeds = extent.first_seed..extent.first_seed + extent.seeds;
        let cases: Vec<DriveCase> = seeds.map(case).collect();
        let name = cases.first().map_or_else(String::new, |case| {
            let km_h = 3.6 * case.manoeuvre.initial_speed_m_s();
            format!("{} on {road}, {km_h:.0} km/h", case.manoeuvre_name())
        });
        // On a flat road the seed moves the sensors' noise only, and one is as good as eight.
        let count = if road == "flat" { 1 } else { cases.len() };
        Self {
            name,
            road,
            cases: cases.into_iter().take(count).collect(),
        }
    }

    /// Whether the drives are straight ahead.
    pub fn is_straight(&self) -> bool {
        self.cases.first().is_some_and(DriveCase::is_straight)
    }
}

/// All groups, the straight drives first.
pub fn groups(extent: &Extent) -> Vec<Group> {
    let (rough, all): (&[&'static str], &[&'static str]) = if extent.quick {
        (&["iso-c", "belgian"], &["flat", "iso-c"])
    } else {
        (
            &["iso-b", "iso-c", "iso-d", "iso-e", "belgian"],
            &["flat", "iso-b", "iso-c", "iso-d", "iso-e", "belgian"],
        )
    };
    let speeds_km_h: &[f64] = if extent.quick { &[60.0] } else { &[40.0, 60.0, 80.0] };
    let mut groups = Vec::new();
    for road in rough {
        for km_h in speeds_km_h {
            let case = |seed| DriveCase::straight(road, km_h / 3.6, extent.straight_s, seed);
            groups.push(Group::new(road, extent, case));
        }
    }
    let lane_changes = [
        (LaneChange::Severe, 60.0),
        (LaneChange::Severe, 80.0),
        (LaneChange::ObstacleAvoidance, 60.0),
    ];
    for road in all {
        let lane_changes = lane_changes.iter().skip(if extent.quick { 2 } else { 0 });
        for (kind, km_h) in lane_changes {
            let case = |seed| DriveCase::lane_change(road, *kind, km_h / 3.6, DriverStyle::Eased, seed);
            groups.push(Group::new(road, extent, case));
        }
        let case = |seed| DriveCase::step_steer(road, 60.0 / 3.6, STEP_RAD, seed);
        groups.push(Group::new(road, extent, case));
    }
    groups
}
