//! What the recordings of a damper or a drive excite.

use oleo_plant_sim::specimen::SmoothedMotion;

use super::extent::{Extent, range};
use crate::recording::Recording;
use crate::vocabulary::{Column, Site};

/// The motion must be this many times its noise before anything can be tested.
const LEAST_MOVE: f64 = 20.0;
/// Motion in one direction must reach this part of the speed in the other before friction can be tested.
const LEAST_RETURN: f64 = 0.02;
/// Where nothing moves, speeds, strokes and accelerations are taken to be this large (SI), so that they can be divided by.
const LEAST_SIZE: f64 = 1e-9;
/// Likewise for the range of the force, N.
const LEAST_FORCE_N: f64 = 1e-6;

/// The channels of a mechanism: which column moves it, and which is compared.
pub struct Channels {
    /// Place of all effects that are not in an instrument.
    pub site: Site,
    /// Index of the force among the columns.
    pub force: usize,
    /// Index of the displacement or position among the columns.
    pub motion: usize,
    /// The compared column, the second.
    pub compared: Column,
    /// Standard deviation of the displacement or position, m.
    pub motion_noise_m: f64,
    /// Whether the simulation begins with what the compared instrument shows.
    pub begins_with_instrument: bool,
    /// Mass that the model has, kg; zero for a damper.
    pub mass_kg: f64,
}

/// Ranges over all recordings of a damper or a drive.
pub struct Mechanism {
    /// Place of all effects that are not in an instrument.
    pub site: Site,
    /// The column whose instrument may have a fault.
    pub compared: Column,
    /// Whether the simulation begins with what the compared instrument shows.
    pub begins_with_instrument: bool,
    /// Mass that the model has, kg; zero for a damper.
    pub mass_kg: f64,
    /// Half of the range of the force, N.
    pub force_n: f64,
    /// Range of the displacement, m.
    pub stroke_m: f64,
    /// Largest displacement, m, compression positive.
    pub farthest_m: f64,
    /// Largest speed, m/s.
    pub speed_m_s: f64,
    /// Largest acceleration, m/s2.
    pub acceleration_m_s2: f64,
    /// Ranges of the columns, duration and sampling interval.
    pub extent: Extent,
    /// Why nothing can be tested.
    pub still: Option<String>,
    /// Why friction cannot be told from a constant force.
    pub one_way: Option<String>,
}

impl Mechanism {
    /// Goes through all recordings once.
    #[must_use]
    pub fn of(channels: Channels, recordings: &[Recording], motions: &[SmoothedMotion]) -> Self {
        let extent = Extent::of(recordings);
        let over = |of: fn(&SmoothedMotion) -> &Vec<f64>| {
            let all: Vec<f64> = motions.iter().flat_map(of).copied().collect();
            range(&all)
        };
        let ((_, farthest), (slow, fast), (brake, push)) = (
            over(|m| &m.displacement_m),
            over(|m| &m.speed_m_s),
            over(|m| &m.acceleration_m_s2),
        );
        let stroke = extent.spread(channels.motion);
        let still = stroke < LEAST_MOVE * channels.motion_noise_m.max(LEAST_SIZE);
        let (forth, back) = (fast.max(0.0), (-slow).max(0.0));
        let one_way = forth.min(back) < LEAST_RETURN * forth.max(back);
        Self {
            force_n: (0.5 * extent.spread(channels.force)).max(LEAST_FORCE_N),
            stroke_m: stroke.max(LEAST_SIZE),
            farthest_m: farthest,
            speed_m_s: forth.max(back).max(LEAST_SIZE),
            acceleration_m_s2: push.max(-brake).max(LEAST_SIZE),
            extent,
            still: still.then(|| "nothing moves by more than noise; record strokes in both directions".to_owned()),
            one_way: one_way
                .then(|| "the recordings move in one direction only; record strokes in both directions".to_owned()),
            site: channels.site,
            compared: channels.compared,
            begins_with_instrument: channels.begins_with_instrument,
            mass_kg: channels.mass_kg,
        }
    }
}
