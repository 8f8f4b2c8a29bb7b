//! Random vehicles under the controller of the nominal one: what a load, a climate, a worn strut and poor sensors make of it.

use oleo_plant_sim::course::{DriverStyle, Ending, LaneChange};
use oleo_plant_sim::study::Records;
use oleo_plant_sim::variation::Variation;
use rayon::prelude::*;
use serde::Serialize;

use super::bench::Bench;
use super::case::DriveCase;
use super::compare::{CompareError, run_once};
use super::figures::Figures;
use super::setting::Setting;

/// Seed of the variations; the case's own number chooses among them.
const SEED: u64 = 1;
/// Speed of all drives, m/s.
const SPEED_M_S: f64 = 60.0 / 3.6;
/// Duration of the drive straight ahead, s.
const STRAIGHT_S: f64 = 12.0;

/// A random vehicle with the controller, against the same vehicle with its valves held.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VariedResult {
    /// Number of the variation: [`Variation::draw`] with it gives the vehicle again.
    pub case: u64,
    /// Weighted RMS on class C over that with all valves open.
    pub ride_ratio_to_soft: f64,
    /// Peak roll in the lane change of ISO 3888-2 on a flat road over that with all valves closed; not a number where the stiff vehicle
    /// rolls over itself.
    pub roll_ratio_to_stiff: f64,
    /// The same on class C.
    pub roll_ratio_to_stiff_rough: f64,
    /// Whether the vehicle rolls over although it stands with all valves closed.
    pub rolls_over: bool,
}

fn drives(seed: u64) -> [DriveCase; 3] {
    let lane_change =
        |road| DriveCase::lane_change(road, LaneChange::ObstacleAvoidance, SPEED_M_S, DriverStyle::Eased, seed);
    [
        DriveCase::straight("iso-c", SPEED_M_S, STRAIGHT_S, seed),
        lane_change("flat"),
        lane_change("iso-c"),
    ]
}

/// Drives the variations of these numbers. The result does not depend on the number of threads.
///
/// # Errors
/// A vehicle that cannot be driven, a file that cannot be written, or `stop`.
pub fn robust(
    nominal: &Bench,
    controlled: &Setting,
    vehicles: &[u64],
    records: &Records,
    done: impl Fn() + Sync,
    stop: impl Fn() -> bool + Sync,
) -> Result<Vec<VariedResult>, CompareError> {
    let one = |&case: &u64| {
        let bench = nominal.varied(&Variation::draw(SEED, case));
        // Every vehicle has a road of its own.
        let [straight, flat, rough] = drives(case);
        let run = |drive: &DriveCase, setting: &Setting| -> Result<Figures, CompareError> {
            let figures = run_once(&bench, &format!("vehicle {case}"), drive, setting, records, &stop)?;
            done();
            Ok(figures)
        };
        let over = |figures: &Figures| matches!(figures.ending, Ending::RolledOver(_));
        let felt = run(&straight, controlled)?.weighted_rms_m_s2 / run(&straight, &Setting::SOFT)?.weighted_rms_m_s2;
        let roll = |drive: &DriveCase| -> Result<(f64, bool), CompareError> {
            let (mine, stiff) = (run(drive, controlled)?, run(drive, &Setting::STIFF)?);
            let ratio = if over(&stiff) {
                f64::NAN
            } else {
                mine.peak_roll_deg / stiff.peak_roll_deg
            };
            Ok((ratio, over(&mine) && !over(&stiff)))
        };
        let ((flat, flat_over), (rough, rough_over)) = (roll(&flat)?, roll(&rough)?);
        Ok(VariedResult {
            case,
            ride_ratio_to_soft: felt,
            roll_ratio_to_stiff: flat,
            roll_ratio_to_stiff_rough: rough,
            rolls_over: flat_over || rough_over,
        })
    };
    vehicles.par_iter().map(one).collect()
}

/// Number of drives of each variation.
pub const DRIVES: u64 = 6;
