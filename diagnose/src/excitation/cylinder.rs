//! What the recordings of a cylinder excite.

use oleo_plant_sim::specimen::{CylinderModel, SmoothedMotion};

use super::extent::{Extent, range, spread};
use crate::recording::Recording;

/// The piston must move by this many times the displacement's noise before anything can be tested.
const LEAST_MOVE: f64 = 20.0;
/// Pressing forces must differ by this fraction of the largest before growth with pressure can be tested.
const LEAST_PRESSURES: f64 = 0.3;

/// Where nothing moves, speeds, strokes and pressing forces are taken to be this large (SI), so that they can be divided by.
const LEAST_SIZE: f64 = 1e-9;
/// Likewise for the range of the force, N.
const LEAST_FORCE_N: f64 = 1e-6;

/// Ranges over all recordings of a cylinder.
pub struct Cylinder {
    /// Range of the force, N.
    pub force_n: f64,
    /// Range of the displacement, m.
    pub stroke_m: f64,
    /// Largest speed in all recordings, m/s.
    pub speed_m_s: f64,
    /// Largest acceleration in all recordings, m/s2.
    pub acceleration_m_s2: f64,
    /// Largest mean pressing force of a recording, N.
    pub pressing_n: f64,
    /// Ranges of the columns, duration and sampling interval.
    pub extent: Extent,
    /// Why nothing can be tested.
    pub still: Option<String>,
    /// Why growth with pressure cannot be tested.
    pub one_pressure: Option<String>,
}

impl Cylinder {
    /// Goes through all recordings once.
    #[must_use]
    pub fn of(model: &CylinderModel, recordings: &[Recording], motions: &[SmoothedMotion]) -> Self {
        let extent = Extent::of(recordings);
        let largest = |of: fn(&SmoothedMotion) -> &Vec<f64>| {
            (motions.iter().flat_map(of))
                .fold(0.0_f64, |a, v| a.max(v.abs()))
                .max(LEAST_SIZE)
        };
        let pressing: Vec<Vec<f64>> = recordings.iter().map(|r| pressing(model, r)).collect();
        let means: Vec<f64> = pressing
            .iter()
            .map(|p| p.iter().sum::<f64>() / p.len() as f64)
            .collect();
        let (low, high) = range(&means);
        let within = pressing.iter().map(|p| spread(p)).fold(0.0, f64::max);
        let x_noise = model.noise.get("displacement_m").copied().unwrap_or(0.0);
        let still = extent.spread(0) < LEAST_MOVE * x_noise.max(LEAST_SIZE);
        let one_pressure = high - low + within < LEAST_PRESSURES * high;
        Self {
            force_n: extent.spread(1).max(LEAST_FORCE_N),
            stroke_m: extent.spread(0).max(LEAST_SIZE),
            speed_m_s: largest(|m| &m.speed_m_s),
            acceleration_m_s2: largest(|m| &m.acceleration_m_s2),
            pressing_n: high.max(LEAST_SIZE),
            extent,
            still: still.then(|| "the piston does not move; record strokes in both directions".to_owned()),
            one_pressure: one_pressure
                .then(|| "the recordings contain only one pressure; record the same strokes at half and at twice the pressure".to_owned()),
        }
    }
}

/// Sum of the chambers' pressures on their areas at every sample, N, all counted positive: what presses the seals.
#[must_use]
pub fn pressing(model: &CylinderModel, recording: &Recording) -> Vec<f64> {
    let chambers = || model.chamber.iter().zip(&recording.columns[2..]);
    (0..recording.len())
        .map(|k| chambers().map(|(c, p)| (c.area_m2 * p[k].max(0.0)).abs()).sum())
        .collect()
}
