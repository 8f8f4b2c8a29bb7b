//! Whether the vehicle corners, told from what the road does to the estimate of lateral acceleration.
//!
//! The lateral acceleration `a` of [`crate::lateral`] stands out of the road when it exceeds a multiple of the error that the
//! road makes at the time. Two things tell how large that error is, and the greater one counts: the running RMS `w` of the road's
//! witness, which a bend does not disturb, over 2 s; and the running RMS `s` of the estimate itself over 15 s, which also knows of
//! wheels that leave the ground, and of a vehicle that sways:
//!
//! ```text
//!   corners            |a| > max(floor, k_w w, k_s s)   in one of the two bands
//!   no longer          |a| < release x that bound       for 1.5 s in all: a lane change crosses zero in between
//! ```
//!
//! A Gaussian error of 1 Hz bandwidth exceeds 3 times its RMS once in 1 km at 60 km/h (Rice's formula), so multiples near 3 give
//! less than one false decision a kilometre.

use crate::estimate::Estimate;
use crate::filter::{LowPass, at_least};
use crate::range::{ConfigurationError, within};
use crate::timing::ticks;

/// Time for which the lateral acceleration must be low before cornering is over.
const HOLD_TICKS: u16 = ticks(1_500);
/// Time before the road is known well enough to tell a bend from it.
const LEARNING_TICKS: u16 = ticks(2_000);
/// Memory of the witness, s.
const WITNESS_MEMORY_S: f32 = 2.0;
/// Memory of the estimate's own running RMS, ticks: it grows to this from the start, and again from the tick in which the estimate
/// begins or ceases to be corrected for the axles' roll.
const OWN_MEMORY_TICKS: f32 = ticks(15_000) as f32;
/// Memory from which it begins, ticks.
const FIRST_OWN_MEMORY_TICKS: f32 = ticks(1_000) as f32;
/// How much slower the own running RMS is learnt within bends.
const SLOWER_IN_BENDS: f32 = 4.0;
/// Largest value that enters the own running mean square, over it: the beginning of a bend must not raise the bound ahead of itself.
/// A Gaussian error exceeds the root of this once in 70 values.
const LARGEST_OVER_OWN: f32 = 6.0;
/// How fast the square of the own multiple grows with the fourth power of the witness over the lift-off value: where wheels leave the
/// ground, peaks are higher over their RMS.
const HEAVIER_TAILS: f32 = 0.125;
/// Least value that enters as it is, over the square of the witness's bound: from zero the mean must be able to grow.
const LARGEST_OVER_WITNESS: f32 = 0.25;

/// Thresholds. See [`strategy::Tuning`](crate::strategy::Tuning) for an example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// Lateral acceleration that counts as cornering on a road that makes no error, m/s2, 0.1 to 5.
    pub floor_m_s2: f32,
    /// Multiple `k_w` of the witness's running RMS, 0.5 to 20, where the estimate is corrected for the axles' roll.
    pub witness_multiple: f32,
    /// The same where it is not.
    pub plain_witness_multiple: f32,
    /// Running RMS of the witness at which wheels begin to leave the ground, m/s2, 0.1 to 100: the error grows faster from there.
    pub lift_off_m_s2: f32,
    /// Multiple `k_s` of the quick estimate's own running RMS, 1 to 20.
    pub own_multiple: f32,
    /// The same for the slow estimate.
    pub slow_own_multiple: f32,
    /// Part of the bound below which it corners no longer, 0.05 to 1.
    pub release_share: f32,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            floor_m_s2: 0.5,       // measured: docs/controller.md
            witness_multiple: 1.0, // measured: docs/controller.md
            plain_witness_multiple: 2.8,
            lift_off_m_s2: 0.67,
            own_multiple: 3.8,
            slow_own_multiple: 4.5,
            release_share: 0.6,
        }
    }
}

impl Tuning {
    /// Whether every value is within its range.
    pub(crate) fn check(&self) -> Result<(), ConfigurationError> {
        let within = |name, value, least, most| within(name, value, least, most);
        within(
            "tuning.strategy.road_and_cornering.cornering.floor_m_s2",
            self.floor_m_s2,
            0.1,
            5.0,
        )?;
        within(
            "tuning.strategy.road_and_cornering.cornering.witness_multiple",
            self.witness_multiple,
            0.5,
            20.0,
        )?;
        within(
            "tuning.strategy.road_and_cornering.cornering.plain_witness_multiple",
            self.plain_witness_multiple,
            0.5,
            20.0,
        )?;
        within(
            "tuning.strategy.road_and_cornering.cornering.lift_off_m_s2",
            self.lift_off_m_s2,
            0.1,
            100.0,
        )?;
        within(
            "tuning.strategy.road_and_cornering.cornering.own_multiple",
            self.own_multiple,
            1.0,
            20.0,
        )?;
        within(
            "tuning.strategy.road_and_cornering.cornering.slow_own_multiple",
            self.slow_own_multiple,
            1.0,
            20.0,
        )?;
        within(
            "tuning.strategy.road_and_cornering.cornering.release_share",
            self.release_share,
            0.05,
            1.0,
        )
    }
}

/// Thresholds, squared, and filters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parameters {
    floor_2: f32,
    witness_2: f32,
    plain_witness_2: f32,
    per_lift_off_2: f32,
    own_2: [f32; 2],
    release_2: f32,
    witness: LowPass,
}

impl Parameters {
    /// From a tuning that has been checked.
    pub fn new(tuning: &Tuning) -> Self {
        let square = |x: f32| x * x;
        Self {
            floor_2: square(tuning.floor_m_s2),
            witness_2: square(tuning.witness_multiple),
            plain_witness_2: square(tuning.plain_witness_multiple),
            per_lift_off_2: 1.0 / square(tuning.lift_off_m_s2),
            own_2: [square(tuning.own_multiple), square(tuning.slow_own_multiple)],
            release_2: square(tuning.release_share),
            witness: LowPass::from_time_constant_s(WITNESS_MEMORY_S),
        }
    }
}

/// Running mean squares of one band, m2/s4.
#[derive(Clone, Copy, Debug, Default)]
struct Band {
    witness: f32,
    own: f32,
}

/// What is remembered.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct State {
    bands: [Band; 2],
    /// Memory of the estimate's own running RMS so far, ticks.
    own_memory: f32,
    corrected: bool,
    /// Ticks since the start; it saturates.
    known: u16,
    /// Ticks for which cornering is held yet.
    hold: u16,
}

impl State {
    /// One tick; returns whether the vehicle corners.
    pub fn step(&mut self, c: &Parameters, estimate: &Estimate) -> bool {
        let lateral = &estimate.lateral;
        let squares = lateral.acceleration_m_s2.squared();
        let witnesses = lateral.witness_m_s2.squared();
        let learning = self.known < LEARNING_TICKS;
        self.known = self.known.saturating_add(1);
        if self.own_memory < OWN_MEMORY_TICKS {
            self.own_memory += 1.0;
        }
        if self.own_memory < FIRST_OWN_MEMORY_TICKS {
            self.own_memory = FIRST_OWN_MEMORY_TICKS;
        }
        if self.corrected != lateral.corrected {
            self.own_memory = FIRST_OWN_MEMORY_TICKS;
        }
        self.corrected = lateral.corrected;
        let own_part = 1.0
            / if self.hold > 0 {
                SLOWER_IN_BENDS * self.own_memory
            } else {
                self.own_memory
            };
        let witness_2 = if lateral.corrected {
            c.witness_2
        } else {
            c.plain_witness_2
        };
        for (band, witness) in self.bands.iter_mut().zip(witnesses) {
            c.witness.step(&mut band.witness, witness);
        }
        let [Band { witness: quick, .. }, _] = self.bands;
        let lift_off = c.per_lift_off_2 * quick;
        let witness_2 = witness_2 * (1.0 + lift_off);
        let heavier_tails = 1.0 + HEAVIER_TAILS * lift_off * lift_off;
        let (mut certain, mut quiet) = (false, true);
        for ((band, square), own_2) in self.bands.iter_mut().zip(squares).zip(c.own_2) {
            let by_witness = witness_2 * band.witness;
            let bound = at_least(by_witness, at_least(own_2 * heavier_tails * band.own, c.floor_2));
            certain |= square > bound;
            quiet &= square < c.release_2 * bound;
            let largest = at_least(LARGEST_OVER_OWN * band.own, LARGEST_OVER_WITNESS * by_witness);
            band.own += own_part * (if learning || square < largest { square } else { largest } - band.own);
        }
        if learning {
            return false;
        }
        if certain {
            self.hold = HOLD_TICKS;
        } else if quiet {
            self.hold = self.hold.saturating_sub(1);
        }
        self.hold > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lateral::{Bands, Lateral};

    /// An estimate whose two bands are alike, m/s2.
    fn estimate(acceleration: f32, witness: f32, corrected: bool) -> Estimate {
        let both = |value| Bands {
            quick: value,
            slow: value,
        };
        Estimate {
            lateral: Lateral {
                acceleration_m_s2: both(acceleration),
                witness_m_s2: both(witness),
                corrected,
            },
            ..Estimate::default()
        }
    }

    /// A sine of an RMS value, m/s2.
    fn sway(tick: usize, rms: f32) -> f32 {
        core::f32::consts::SQRT_2 * rms * libm::sinf(0.05 * tick as f32)
    }

    /// Drives on a road for 20 s and then asks whether a lateral acceleration, m/s2, is a bend.
    fn after_a_road(witness: f32, error: f32, corrected: bool, asked: f32) -> bool {
        let (c, mut state) = (Parameters::new(&Tuning::default()), State::default());
        for tick in 0..4_000 {
            let now = state.step(&c, &estimate(sway(tick, error), sway(tick + 30, witness), corrected));
            assert!(!now, "tick {tick}");
        }
        state.step(&c, &estimate(asked, 0.0, corrected))
    }

    #[test]
    fn a_smooth_road_leaves_the_floor() {
        assert!(!after_a_road(0.0, 0.0, true, 0.49));
        assert!(after_a_road(0.0, 0.0, true, -0.51));
    }

    #[test]
    fn the_witness_raises_the_bound_and_more_so_without_correction() {
        // Class C: 0.3 m/s2 of witness make 0.3 x sqrt(1 + (0.3 / 0.67)^2) = 0.33 corrected and 2.8 times as much otherwise.
        assert!(!after_a_road(0.3, 0.0, true, 0.45));
        assert!(after_a_road(0.3, 0.0, true, 0.55));
        assert!(!after_a_road(0.3, 0.0, false, 0.85));
        assert!(after_a_road(0.3, 0.0, false, 1.0));
    }

    #[test]
    fn a_swaying_vehicle_raises_the_bound() {
        assert!(!after_a_road(0.0, 0.3, true, 1.0));
        assert!(after_a_road(0.0, 0.3, true, 1.3));
    }

    #[test]
    fn cornering_outlasts_the_crossing_of_a_lane_change_and_ends() {
        let (c, mut state) = (Parameters::new(&Tuning::default()), State::default());
        for _ in 0..1_000 {
            state.step(&c, &estimate(0.0, 0.0, true));
        }
        assert!(state.step(&c, &estimate(3.0, 0.0, true)));
        for _ in 1..HOLD_TICKS {
            assert!(state.step(&c, &estimate(0.0, 0.0, true)));
        }
        assert!(!state.step(&c, &estimate(0.0, 0.0, true)));
    }

    #[test]
    fn nothing_is_decided_while_the_road_is_learnt() {
        let (c, mut state) = (Parameters::new(&Tuning::default()), State::default());
        for _ in 0..LEARNING_TICKS {
            assert!(!state.step(&c, &estimate(5.0, 0.0, false)));
        }
    }
}
