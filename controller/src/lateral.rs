//! Lateral acceleration of the body from the struts' forces and displacements, and what the road alone adds to it.
//!
//! The moment balance of the sprung mass about its roll axis, solved for the input, holds whatever the valves do:
//!
//! ```text
//!   a_y = LP[ i_x^2 / h  phi''  +  g (- sum y F + k_f phi_f + k_r phi_r) / (sum W  h)  -  g phi ],  bias removed
//! ```
//!
//! with the symbols of [`crate::estimate`]. Two errors are left, because the body's roll `phi` is measured relative to the
//! axles, and the axles roll with the road. The term `g phi` is small. The term `phi''` is large on a rough road: at 60 km/h on
//! class C it makes 0.2 m/s2 RMS below 1.5 Hz.
//!
//! The road tells how large that error is. Twisting the body's underside, left wheel up in front and down at the rear, is something
//! that only a road does; a bend rolls both axles alike. So the same filter over the twist, half the difference of the axles'
//! roll, makes a *witness*: its running RMS is that of the error to within 0.6 to 1.1 on classes B to E at 40 to 80 km/h, whatever
//! the vehicle is doing (`docs/controller.md`).
//!
//! And most of that error can be taken out, once it is known how much later the rear axle meets what the front axle met
//! (`wheelbase`). With `w_f` and `w_r` the axles' roll on the road, the twist is `w_f - w_r`, and `w_r` is `w_f` of `D` ticks ago:
//!
//! ```text
//!   w_f(n) = (w_f - w_r)(n) + r w_f(n - D),   r = min(n / (n + D), 0.92)
//! ```
//!
//! with `n` the ticks since `D` has been known.
//!
//! The same recursion holds for everything that follows linearly from the roll of the axles, so it is done behind the low-pass,
//! with the witness for the twist. What `w_f` was when it began is not known. `r` below 1 lets that be forgotten, and a small one at first
//! soon: after `k` delays a part of `1 / (k + 1)` of it is left, where 0.92 from the first would leave `0.92^k`, which is a half after
//! eight. A road whose period is the wheelbase stays hidden. The correction halves the error on classes B to D.
//!
//! LP is a Bessel low-pass of fourth order: least delay for its steepness, and no overshoot. What tells a bend from the road soonest
//! is not `a_y` itself. With `e` the correction of the axles' roll and `a` the sum without it, the *quick* output is
//!
//! ```text
//!   q = (1 - s) (a + e) + s M_0.15(a) + c M_0.8(e),   s = 0.77, c = 3.7
//! ```
//!
//! with `M_t` the mean over `t` seconds (a lag). The smoothing takes out what the road makes above 1 Hz. The last term is road
//! below 1 Hz. There it pulls the vehicle sideways by its slope, which the first term does not know of, and by the tyres that the
//! rolling axles drag along; that is a lateral acceleration, but no bend. Both shares are Fisher's linear discriminant of bends from
//! roads (`docs/controller.md`). Where no delay is known, as on a flat road, `q = a`. A further, *slow* output has one more section
//! behind `a + e`: on surfaces on which wheels leave the ground only the slow one can tell a bend from the road.
//!
//! Source: Newton and Euler at small angles; poles of the Bessel filter: Zverev, Handbook of Filter Synthesis (1967), table of
//! normalised frequencies and quality factors for -3 dB at 1.

use crate::filter::{LowPass, SecondOrder, SecondOrderState};
use crate::range::{ConfigurationError, within};
use crate::timing::ticks;
use crate::wheelbase::HISTORY;

/// Largest lateral offset that is learnt as uneven load, side slope or sensor bias, m/s2. The bound keeps a long bend from
/// being learnt.
const MAX_BIAS_M_S2: f32 = 1.2;
/// Time constant with which the bias is learnt, s. A side slope of 10 % pulls by 1 m/s2; it is no bend after a few of these.
const BIAS_S: f32 = 15.0;
/// Natural frequencies of the Bessel filter's two sections over its corner frequency, and their damping ratios.
const BESSEL_4: [(f32, f32); 2] = [(1.4302, 0.9580), (1.6034, 0.6207)];
/// Natural frequency of the further section of the slow output over the corner frequency of the quick one, and its damping ratio.
const SLOW: (f32, f32) = (0.611, 0.8);
/// Time for which the recursion must run before its unknown beginning is forgotten.
const SETTLING_TICKS: u16 = ticks(1_000);
/// Time in which the correction fades in: a step would look like a bend.
const FADING_TICKS: u16 = ticks(750);
/// Time after the fading in which the slow output follows.
const FOLLOWING_TICKS: u16 = ticks(500);
/// How much of the road `D` ticks ago is kept at most.
const MOST_KEPT: f32 = 0.92;
/// Time constant of the mean of the sum in the quick output, s.
const SMOOTHED_S: f32 = 0.15;
/// Time constant of the mean of the correction in the quick output, s.
const DRAGGED_S: f32 = 0.8;

/// What a person may choose about the estimate of lateral acceleration.
///
/// ```
/// let mut builder = oleo_controller::Builder::default();
/// builder.tuning.estimate.lateral.corner_hz = 0.0;
/// assert_eq!(builder.build().unwrap_err().name, "tuning.estimate.lateral.corner_hz");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// Corner frequency of the low-pass, Hz, 0.1 to 5.
    pub corner_hz: f32,
    /// Share of the smoothed sum in the quick output, 0 to 1.
    pub smoothed_share: f32,
    /// How much of the mean of the correction is added to the quick output, 0 to 10.
    pub dragged_share: f32,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            corner_hz: 1.8, // measured, as the shares: docs/controller.md
            smoothed_share: 0.77,
            dragged_share: 3.7,
        }
    }
}

impl Tuning {
    /// Whether every value is within its range.
    pub(crate) fn check(&self) -> Result<(), ConfigurationError> {
        within("tuning.estimate.lateral.corner_hz", self.corner_hz, 0.1, 5.0)?;
        within("tuning.estimate.lateral.smoothed_share", self.smoothed_share, 0.0, 1.0)?;
        within("tuning.estimate.lateral.dragged_share", self.dragged_share, 0.0, 10.0)
    }
}

/// Filters and the ratio `i_x^2 / h`, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parameters {
    sections: [SecondOrder; 2],
    slow: SecondOrder,
    smoothed: LowPass,
    smoothed_share: f32,
    dragged: LowPass,
    dragged_share: f32,
    inertia_per_arm_m: f32,
    bias: LowPass,
}

impl Parameters {
    /// From a tuning that has been checked, and `i_x^2 / h`, m.
    pub fn new(tuning: &Tuning, inertia_per_arm_m: f32) -> Self {
        let section = |(ratio, damping): (f32, f32)| SecondOrder::new(ratio * tuning.corner_hz, damping);
        Self {
            sections: BESSEL_4.map(section),
            slow: section(SLOW),
            smoothed: LowPass::from_time_constant_s(SMOOTHED_S),
            smoothed_share: tuning.smoothed_share,
            dragged: LowPass::from_time_constant_s(DRAGGED_S),
            dragged_share: tuning.dragged_share,
            inertia_per_arm_m,
            bias: LowPass::from_time_constant_s(BIAS_S),
        }
    }
}

/// A quantity behind the quick low-pass and behind the slow one, m/s2. See [`Lateral`] for an example.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bands {
    /// Behind the Bessel filter; of the acceleration, the sum that tells a bend from the road soonest.
    pub quick: f32,
    /// Behind one section more.
    pub slow: f32,
}

impl Bands {
    /// Both squared, m2/s4.
    pub(crate) fn squared(self) -> [f32; 2] {
        [self.quick * self.quick, self.slow * self.slow]
    }
}

/// Lateral acceleration and the road's witness.
///
/// ```
/// use oleo_controller::plausibility::Trusted;
/// use oleo_controller::{Configuration, Corners, Gauge, StrutPressures, estimate};
/// let parameters = Configuration::defender110().estimate;
/// let mut state = estimate::State::default();
/// let with = |left_pa: f32, right_pa: f32| Trusted {
///     pressure: Corners::from_array([left_pa, right_pa, left_pa, right_pa].map(|p| StrutPressures::splat(Gauge(p)))),
///     ..Trusted::default()
/// };
/// // Uneven load is learnt in the first seconds.
/// for _ in 0..500 {
///     state.step(&parameters, &with(2.0e6, 2.0e6));
/// }
/// // Load moves to the right: a left turn. Both outputs see it, and nothing twists the vehicle.
/// let lateral = (0..200).map(|_| state.step(&parameters, &with(1.8e6, 2.2e6)).lateral).last().unwrap();
/// assert!(lateral.acceleration_m_s2.quick > 1.0 && lateral.acceleration_m_s2.slow > 1.0);
/// assert_eq!(lateral.witness_m_s2.quick, 0.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lateral {
    /// Whether the axles' roll on the road has been taken out of `acceleration_m_s2`.
    pub corrected: bool,
    /// Lateral acceleration, m/s2, to the left positive.
    pub acceleration_m_s2: Bands,
    /// What the twist of the road would be as lateral acceleration, m/s2: as large as the error of an `acceleration_m_s2` that
    /// has not been corrected.
    pub witness_m_s2: Bands,
}

/// States of the filters.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct State {
    body: Bessel,
    twist: Bessel,
    body_slow: SecondOrderState,
    twist_slow: SecondOrderState,
    smoothed: f32,
    dragged: f32,
    /// Twice the front axle's share of the error in the last ticks, m/s2, in a ring.
    #[cfg_attr(feature = "serde", serde(with = "serde_big_array::BigArray"))]
    front: [f32; HISTORY],
    now: usize,
    /// Ticks for which the delay has been known; it saturates.
    known: u16,
    bias: f32,
    started: bool,
}

impl State {
    pub const INITIAL: Self = Self {
        body: Bessel::INITIAL,
        twist: Bessel::INITIAL,
        body_slow: SecondOrderState::INITIAL,
        twist_slow: SecondOrderState::INITIAL,
        smoothed: 0.0,
        dragged: 0.0,
        front: [0.0; HISTORY],
        now: 0,
        known: 0,
        bias: 0.0,
        started: false,
    };
}

/// States of the fourth-order low-pass.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Bessel([SecondOrderState; 2]);

impl Bessel {
    const INITIAL: Self = Self([SecondOrderState::INITIAL; 2]);

    fn at_rest(c: &Parameters, x: f32, u: f32) -> Self {
        let [first, second] = &c.sections;
        Self([first.at_rest(x, u), second.at_rest(x, 0.0)])
    }

    fn step(&mut self, c: &Parameters, x: f32, u: f32) -> f32 {
        let ([first, second], Self([one, two])) = (&c.sections, self);
        let y = first.step(one, x, u);
        second.low_pass(two, y)
    }
}

impl State {
    /// One tick, from the sum of moments over the mass and the roll arm, less `g phi`, m/s2, the roll of the body relative to
    /// the front and to the rear axle, rad, and the delay of the rear axle, ticks, if it is known.
    pub fn step(
        &mut self,
        c: &Parameters,
        quasi_static_m_s2: f32,
        front_rad: f32,
        rear_rad: f32,
        delay: Option<u8>,
    ) -> Lateral {
        let half = 0.5 * c.inertia_per_arm_m;
        let (roll, twist) = (half * (front_rad + rear_rad), half * (rear_rad - front_rad));
        if !self.started {
            self.started = true;
            self.body = Bessel::at_rest(c, quasi_static_m_s2, roll);
            self.twist = Bessel::at_rest(c, 0.0, twist);
            self.body_slow = c.slow.at_rest(quasi_static_m_s2, 0.0);
            self.smoothed = quasi_static_m_s2;
        }
        let plain = self.body.step(c, quasi_static_m_s2, roll);
        let witness = self.twist.step(c, 0.0, twist);
        let (faded, error) = self.axles(witness, delay);
        let sum = plain + error;
        let smoothed = c.smoothed.step(&mut self.smoothed, plain);
        let dragged = c.dragged.step(&mut self.dragged, error);
        let quick = sum + faded * c.smoothed_share * (smoothed - sum) + c.dragged_share * dragged;
        let slow = c.slow.low_pass(&mut self.body_slow, sum);
        let bias = c.bias.step(&mut self.bias, sum.clamp(-MAX_BIAS_M_S2, MAX_BIAS_M_S2));
        Lateral {
            corrected: self.known >= SETTLING_TICKS + FADING_TICKS + FOLLOWING_TICKS,
            acceleration_m_s2: Bands {
                quick: quick - bias,
                slow: slow - bias,
            },
            witness_m_s2: Bands {
                quick: witness,
                slow: c.slow.low_pass(&mut self.twist_slow, witness),
            },
        }
    }

    /// How far the correction has been faded in, from 0 to 1, and what has to be added for the axles' roll on the road, m/s2: half of
    /// the front axle's share and half of the rear one's, which together are the front one's less the witness.
    fn axles(&mut self, witness_m_s2: f32, delay: Option<u8>) -> (f32, f32) {
        let ago = |ticks: usize| self.now.wrapping_sub(ticks) % HISTORY;
        let known = f32::from(self.known);
        let kept = delay.and_then(|delay| {
            let before = self.front.get(ago(delay.into()))?;
            let part = known / (known + f32::from(delay));
            Some(if part < MOST_KEPT { part } else { MOST_KEPT } * before)
        });
        let front = 2.0 * witness_m_s2 + kept.unwrap_or(0.0);
        if let Some(place) = self.front.get_mut(ago(0)) {
            *place = front;
        }
        self.now = self.now.wrapping_add(1) % HISTORY;
        self.known = if delay.is_some() {
            self.known.saturating_add(1)
        } else {
            0
        };
        let faded = self.known.saturating_sub(SETTLING_TICKS).min(FADING_TICKS);
        let faded = f32::from(faded) * (1.0 / FADING_TICKS as f32);
        (faded, faded * (front - witness_m_s2))
    }
}

#[cfg(test)]
impl State {
    /// A state whose memory was damaged, as no input can do.
    pub fn damaged() -> Self {
        Self {
            started: true,
            bias: f32::NAN,
            ..Self::INITIAL
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use core::f32::consts::PI;
    use oleo_interface::tick::TICK_S_F32 as TICK_S;

    /// RMS of the quick estimate and of the witness over the last 5 s on a road whose front axle rolls by 0.5 degrees at a
    /// frequency and whose rear axle follows 33 ticks later, under a body that stays upright.
    fn on_a_wavy_road(frequency_hz: f32, delay: Option<u8>) -> (f32, f32) {
        let sum = Tuning {
            smoothed_share: 0.0,
            dragged_share: 0.0,
            ..Tuning::default()
        };
        let (c, mut state) = (Parameters::new(&sum, 1.5), State::INITIAL);
        let axle = |tick: usize| 0.0087 * libm::sinf(2.0 * PI * frequency_hz * tick as f32 * TICK_S);
        let (mut error_2, mut witness_2) = (0.0, 0.0);
        for tick in 0..4_000 {
            // Relative to an axle that rolls, an upright body rolls the other way.
            let lateral = state.step(&c, 0.0, -axle(tick + 33), -axle(tick), delay);
            if tick >= 3_000 {
                error_2 += lateral.acceleration_m_s2.quick * lateral.acceleration_m_s2.quick;
                witness_2 += lateral.witness_m_s2.quick * lateral.witness_m_s2.quick;
            }
        }
        (libm::sqrtf(error_2 / 1_000.0), libm::sqrtf(witness_2 / 1_000.0))
    }

    #[test]
    fn a_known_delay_takes_the_roll_of_the_axles_out() {
        for frequency_hz in [0.7, 1.0, 1.5, 2.0] {
            let (plain, witness) = on_a_wavy_road(frequency_hz, None);
            let (corrected, same) = on_a_wavy_road(frequency_hz, Some(33));
            assert!(
                corrected < 0.25 * plain,
                "{frequency_hz} Hz: {corrected} of {plain} m/s2"
            );
            assert!(
                witness > 0.1 * plain && witness == same,
                "{frequency_hz} Hz: {witness} of {plain} m/s2"
            );
        }
    }

    #[test]
    fn a_bend_is_seen_and_makes_no_witness() {
        let (c, mut state) = (Parameters::new(&Tuning::default(), 1.5), State::INITIAL);
        let mut last = Lateral::default();
        // A vehicle that leans by 2 degrees at once: both axles see the same.
        for tick in 0..400 {
            let bend = f32::from(u8::from(tick >= 100));
            last = state.step(&c, 4.0 * bend, 0.035 * bend, 0.035 * bend, None);
            assert!(last.witness_m_s2.quick.abs() < 1e-4, "{last:?}");
        }
        assert!((last.acceleration_m_s2.quick - 4.0).abs() < 0.4, "{last:?}");
        assert!((last.acceleration_m_s2.slow - 4.0).abs() < 0.4, "{last:?}");
    }

    /// A load that moves at once, on a road without roll and with a known delay: the mean lags, and the shares make one.
    #[test]
    fn the_quick_output_is_the_sum_and_its_mean() {
        let after = |smoothed_share: f32, ticks: usize, delay: Option<u8>| {
            let tuning = Tuning {
                smoothed_share,
                ..Tuning::default()
            };
            let (c, mut state) = (Parameters::new(&tuning, 1.5), State::INITIAL);
            (0..1_000).for_each(|_| _ = state.step(&c, 0.0, 0.0, 0.0, delay));
            let last = (0..ticks).map(|_| state.step(&c, 1.0, 0.0, 0.0, delay)).last();
            last.map_or(0.0, |lateral| lateral.acceleration_m_s2.quick)
        };
        for ticks in [40, 80, 160] {
            let [sum, mean, half] = [0.0, 1.0, 0.5].map(|share| after(share, ticks, Some(33)));
            assert!(
                (half - 0.5 * (sum + mean)).abs() < 1e-5 && mean < sum,
                "{sum} {mean} {half}"
            );
            assert_eq!(after(1.0, ticks, None), sum, "nothing to smooth without a correction");
        }
        assert!((after(1.0, 200, Some(33)) - after(0.0, 200, Some(33))).abs() < 0.03);
    }

    /// On a road that rolls by one side slope for ever, the twist is zero and what the front axle rolls by is not known. It is
    /// taken for zero, and a wrong guess is forgotten: after `k` delays 1 / (k + 1) of it is left.
    #[test]
    fn an_unknown_beginning_is_soon_forgotten() {
        let (delay, mut state) = (20_u8, State::INITIAL);
        for _ in 0..HISTORY {
            state.axles(0.5, None);
        }
        let fronts: [f32; 13] = core::array::from_fn(|_| {
            (0..delay).for_each(|_| _ = state.axles(0.0, Some(delay)));
            state.front[(state.now + HISTORY - 1) % HISTORY]
        });
        for (delays, front) in fronts.iter().enumerate() {
            // The factor grows within a delay; the last tick of a delay has that of the tick before the next.
            let left: f32 = (0..=delays)
                .map(|k| (k as f32 * 20.0 + 19.0) / (k as f32 * 20.0 + 39.0))
                .map(|r| r.min(0.92))
                .product();
            assert!((front - left).abs() < 1e-5, "{delays}: {front} instead of {left}");
        }
        // With 0.92 from the beginning, 0.61 would be left after these six delays.
        assert!(fronts[5] < 0.25);
    }

    #[test]
    fn a_side_slope_is_forgotten() {
        let (c, mut state) = (Parameters::new(&Tuning::default(), 1.5), State::INITIAL);
        state.step(&c, 0.0, 0.0, 0.0, None);
        let mut last = Lateral::default();
        for _ in 0..12_000 {
            last = state.step(&c, 1.0, 0.0, 0.0, None);
        }
        assert!(last.acceleration_m_s2.quick.abs() < 0.05, "{last:?}");
    }

    /// With only the plain sum: no smoothing, no drag.
    const PLAIN: Tuning = Tuning {
        corner_hz: 1.8,
        smoothed_share: 0.0,
        dragged_share: 0.0,
    };

    #[test]
    fn the_filters_begin_at_rest() {
        let (c, mut state) = (Parameters::new(&Tuning::default(), 1.5), State::INITIAL);
        for _ in 0..40 {
            let Bands { quick, slow } = state.step(&c, 0.8, 0.02, 0.02, None).acceleration_m_s2;
            assert!(
                (quick - 0.8).abs() < 0.02 && (slow - 0.8).abs() < 0.02,
                "{quick}, {slow} m/s2"
            );
        }
    }

    /// A body that rolls as a sine of 0.4 Hz: `i^2 / h` times the roll acceleration, at a quarter of the corner frequency.
    #[test]
    fn roll_acceleration_counts_by_the_gyration_over_the_arm() {
        let (frequency_hz, roll_rad) = (0.4, 0.05);
        let omega = 2.0 * PI * frequency_hz;
        for inertia_per_arm_m in [1.5, 0.7] {
            let (c, mut state) = (Parameters::new(&PLAIN, inertia_per_arm_m), State::INITIAL);
            let mut largest = 0.0_f32;
            for tick in 0..6_000 {
                let roll = roll_rad * libm::sinf(omega * tick as f32 * TICK_S);
                let lateral = state.step(&c, 0.0, roll, roll, None);
                if tick > 4_000 {
                    largest = largest.max(lateral.acceleration_m_s2.quick.abs());
                }
            }
            let expected = inertia_per_arm_m * omega * omega * roll_rad;
            assert!(
                (largest / expected - 1.0).abs() < 0.05,
                "{largest} m/s2, expected {expected}"
            );
        }
    }

    /// What stays is learnt in 15 s, and both outputs forget it alike.
    #[test]
    fn the_bias_is_taken_off_both_outputs() {
        let (c, mut state) = (Parameters::new(&PLAIN, 1.5), State::INITIAL);
        let mut last = Lateral::default();
        for _ in 0..3_000 {
            last = state.step(&c, 1.0, 0.0, 0.0, None);
        }
        for output in [last.acceleration_m_s2.quick, last.acceleration_m_s2.slow] {
            assert!((output - libm::expf(-1.0)).abs() < 0.01, "{last:?}");
        }
    }

    /// 1 s until the beginning is forgotten, 0.75 s in which it fades in, and 0.5 s for the slow output.
    #[test]
    fn the_estimate_counts_as_corrected_after_2_25_s() {
        let (c, mut state) = (Parameters::new(&Tuning::default(), 1.5), State::INITIAL);
        let mut corrected = |delay| state.step(&c, 0.0, 0.0, 0.0, delay).corrected;
        for _ in 0..2 {
            assert!((1..450).all(|_| !corrected(Some(33))));
            assert!(corrected(Some(33)) && corrected(Some(33)));
            assert!(!corrected(None), "the delay is not known any more");
        }
    }

    /// The mean of the correction over 0.8 s enters the quick output with its share.
    #[test]
    fn the_drag_of_the_axles_is_the_mean_of_the_correction() {
        let quick = |dragged_share: f32, delay: Option<u8>| {
            let tuning = Tuning { dragged_share, ..PLAIN };
            let (c, mut state) = (Parameters::new(&tuning, 1.5), State::INITIAL);
            let axle = |tick: usize| 0.01 * libm::sinf(2.0 * PI * 0.7 * tick as f32 * TICK_S);
            (0..2_000)
                .map(|tick| {
                    state
                        .step(&c, 0.0, -axle(tick + 33), -axle(tick), delay)
                        .acceleration_m_s2
                        .quick
                })
                .collect::<std::vec::Vec<_>>()
        };
        let (without, plain) = (quick(0.0, Some(33)), quick(0.0, None));
        let (mut mean, mut difference, mut size) = (0.0_f32, 0.0_f32, 0.0_f32);
        for (tick, with) in quick(3.7, Some(33)).into_iter().enumerate() {
            let correction = without[tick] - plain[tick];
            mean += (correction - mean) * (1.0 - libm::expf(-TICK_S / 0.8));
            // Biases are learnt from the sum without the drag, and the plain one has another.
            if tick > 1_000 {
                difference = difference.max((with - without[tick] - 3.7 * mean).abs());
                size = size.max((3.7 * mean).abs());
            }
        }
        assert!(
            size > 0.05 && difference < 0.1 * size,
            "off by {difference} of {size} m/s2"
        );
    }
}
