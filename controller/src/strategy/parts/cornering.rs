//! Whether the vehicle corners, told from what the road does to the estimate of lateral acceleration.
//!
//! The lateral acceleration `a` of [`crate::lateral`], quick and slow, stands out of the road when it exceeds a multiple of the error
//! that the road makes at the time. Two things tell how large that error is, and the greater one counts: the running RMS `w` of the
//! road's witness, which a bend does not disturb, over 2 s; and the running RMS `s` of the estimate itself over 15 s, which also knows
//! of wheels that leave the ground, and of a vehicle that sways. With `l` the square of the quick witness over its lift-off value:
//!
//! ```text
//!   bounds             b_q = max(floor, k_w w_q sqrt(1 + l),      k_q s_q sqrt(1 + 0.01 l^2))
//!                      b_s = max(floor, k_w w_s sqrt(1 + l / 2),  k_s s_s sqrt(1 + 0.0004 l^2))
//!   measure            m   = e_q (a_q / b_q)^2 + e_s (a_s / b_s)^2            if both are to the same side
//!                          = max(e_q (a_q / b_q)^2, e_s (a_s / b_s)^2) / 2    if not
//!                            e_q = 1.2, e_s = 0.6
//!   suspects           m (1 + 0.03 l) > 0.7
//!   corners            m > 1:    for 0.4 s at least
//!                      m > 1.6^2: until |a_q| < 0.6 b_q and |a_s| < 0.6 b_s, and the gas carries both sides alike
//!                      (`load_transfer`), for 1.5 s in all
//! ```
//!
//! The errors of the two bands are only weakly correlated, so that both together tell a bend sooner than each alone. The quick band
//! counts for more, because it is the first to know of a bend: where the slow one leads, a road has swayed the vehicle. A lane change
//! crosses zero in between, hence 1.5 s. It also exceeds the bounds by far soon after its beginning, which a false decision hardly
//! ever does, and so a false one costs little ride. docs/controller.md says where the multiples come
//! from.

use oleo_interface::Side;

use crate::estimate::Estimate;
use crate::filter::{LowPass, at_least};
use crate::lateral::Bands;
use crate::range::{ConfigurationError, within};
use crate::timing::ticks;

/// Time for which the lateral acceleration must be low before cornering is over.
const HOLD_TICKS: u16 = ticks(1_500);
/// The same while the measure has not exceeded [`STRONG`] yet.
const WEAK_HOLD_TICKS: u16 = ticks(400);
/// Measure from which a decision is beyond doubt.
const STRONG: f32 = 1.6 * 1.6;
/// Shares of the quick and of the slow band in the measure.
const QUICK_SHARE: f32 = 1.2;
const SLOW_SHARE: f32 = 0.6;
/// Part of the measure that counts where the two bands point to opposite sides.
const OPPOSED: f32 = 0.5;
/// Measure from which a bend is suspected, and how much more a measure counts for that with the square of the witness over the lift-off
/// value: the rougher the road, the later a decision and the less a suspicion costs.
const SUSPICION: f32 = 0.7;
const SUSPICION_GROWTH: f32 = 0.03;
/// Time before the road is known well enough to tell a bend from it. Uneven load is learnt as long as this (`estimate`), and is a bend
/// to the estimate until it is known.
const LEARNING_TICKS: u16 = ticks(2_500);
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
const LARGEST_OVER_OWN: f32 = 2.2;
/// How fast the squares of the own multiples, of the quick and of the slow estimate, grow with the fourth power of the witness over the
/// lift-off value: where wheels leave the ground, peaks are higher over their RMS.
const HEAVIER_TAILS: [f32; 2] = [0.01, 0.0004];
/// How much of the growth of the quick error from lift-off on the slow error has.
const SLOW_LIFT_OFF: f32 = 0.5;
/// Least value that enters as it is, over the square of the witness's bound: from zero the mean must be able to grow.
const LARGEST_OVER_WITNESS: f32 = 0.5;

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
            floor_m_s2: 0.3,       // measured: docs/controller.md
            witness_multiple: 0.6, // tuned: docs/controller.md
            plain_witness_multiple: 3.9,
            lift_off_m_s2: 0.5,
            own_multiple: 3.6,
            slow_own_multiple: 4.9,
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
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Band {
    witness: f32,
    own: f32,
}

/// What is remembered.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct State {
    bands: [Band; 2],
    /// How far the memory of the estimate's own running RMS has grown beyond the first one, ticks.
    further_memory: f32,
    corrected: bool,
    /// Ticks since the start; it saturates.
    known: u16,
    /// Ticks for which cornering is held yet.
    hold: u16,
    /// Whether the body is pushed to the right, as the last decision had it.
    to_right: bool,
}

/// Whether the vehicle corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cornering {
    /// It does not.
    No,
    /// A bend is suspected that has not been decided on.
    Suspected,
    /// It does, and the body is pushed to this side.
    Yes(Side),
}

impl State {
    pub const INITIAL: Self = Self {
        bands: [Band { witness: 0.0, own: 0.0 }; 2],
        further_memory: 0.0,
        corrected: false,
        known: 0,
        hold: 0,
        to_right: false,
    };

    /// One tick, with whether the gas says that the vehicle leans; returns whether it corners.
    pub fn step(&mut self, c: &Parameters, estimate: &Estimate, leans: bool) -> Cornering {
        let lateral = &estimate.lateral;
        let squares = lateral.acceleration_m_s2.squared();
        let witnesses = lateral.witness_m_s2.squared();
        let learning = self.known < LEARNING_TICKS;
        self.known = self.known.saturating_add(1);
        if self.corrected != lateral.corrected {
            self.further_memory = 0.0;
        }
        self.corrected = lateral.corrected;
        let own_memory = FIRST_OWN_MEMORY_TICKS + self.further_memory;
        if own_memory < OWN_MEMORY_TICKS {
            self.further_memory += 1.0;
        }
        let own_part = 1.0
            / if self.hold > 0 {
                SLOWER_IN_BENDS * own_memory
            } else {
                own_memory
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
        let witness_2 = [1.0 + lift_off, 1.0 + SLOW_LIFT_OFF * lift_off].map(|growth| growth * witness_2);
        let [quick_own_2, slow_own_2] = c.own_2;
        let [quick_tails, slow_tails] = HEAVIER_TAILS;
        let lift_off_2 = lift_off * lift_off;
        let own_2 = [
            quick_own_2 * (1.0 + quick_tails * lift_off_2),
            slow_own_2 * (1.0 + slow_tails * lift_off_2),
        ];
        let mut bounds = [0.0; 2];
        for ((((band, square), witness_2), own_2), bound) in self
            .bands
            .iter_mut()
            .zip(squares)
            .zip(witness_2)
            .zip(own_2)
            .zip(&mut bounds)
        {
            let by_witness = witness_2 * band.witness;
            *bound = at_least(by_witness, at_least(own_2 * band.own, c.floor_2));
            let largest = at_least(LARGEST_OVER_OWN * band.own, LARGEST_OVER_WITNESS * by_witness);
            band.own += own_part * (if learning || square < largest { square } else { largest } - band.own);
        }
        if learning {
            return Cornering::No;
        }
        let ([quick, slow], [quick_bound, slow_bound]) = (squares, bounds);
        let Bands { quick: a, slow: b } = lateral.acceleration_m_s2;
        // Multiplied by both bounds, so that nothing is divided.
        let (quick, slow, one) = (quick * slow_bound, slow * quick_bound, quick_bound * slow_bound);
        let (of_quick, of_slow) = (QUICK_SHARE * quick, SLOW_SHARE * slow);
        let measure = if a * b > 0.0 {
            of_quick + of_slow
        } else {
            OPPOSED * at_least(of_quick, of_slow)
        };
        if measure > one {
            let hold = if measure > STRONG * one {
                HOLD_TICKS
            } else {
                WEAK_HOLD_TICKS
            };
            self.hold = self.hold.max(hold);
            self.to_right = a > 0.0;
        } else if quick < c.release_2 * one && slow < c.release_2 * one && !leans {
            self.hold = self.hold.saturating_sub(1);
        }
        if self.hold > 0 {
            Cornering::Yes(if self.to_right { Side::Right } else { Side::Left })
        } else if measure + SUSPICION_GROWTH * lift_off * measure > SUSPICION * one {
            Cornering::Suspected
        } else {
            Cornering::No
        }
    }
}

#[cfg(test)]
mod tests;
