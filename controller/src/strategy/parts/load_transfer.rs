//! Whether the gas still carries more on one side than on the other, so that a bend that has been decided on is not over.
//!
//! [`super::cornering`] follows the lateral acceleration, which comes from p1. A p1 that reads wrong puts a bias on it, and so does a
//! bend that lasts so long that it is learnt as a side slope. Either could end cornering in the middle of a bend: the springs would
//! open, and the vehicle would lean much further. How far the first gas of each strut is compressed also tells how the load is
//! shared, and follows from other sensors, the displacement and p4 (`Trusted::load_to_right_m`):
//!
//! ```text
//!   e      = (c_fr + c_rr - c_fl - c_rl) / 2,  lagged by 0.5 s         c  compression of the first gas, m of stroke
//!   mean   of e over 15 s outside of bends, and over 300 s within      uneven load, side slope, offset of a sensor
//!   leans  if |e - mean| > 8 mm
//! ```
//!
//! It only prolongs: a wrong displacement alone neither begins a bend nor ends one. Five minutes are long for a bend; a sensor
//! with an offset that begins within one keeps the vehicle stiff for no longer.

use oleo_interface::tick::TICK_S_F32;

use crate::filter::LowPass;

/// Ticks from one look at the difference to the next: it changes only when all corners have had their turn.
const TICKS: u8 = 4;
/// Lag of the difference, s: what the road does to it must not count.
const LAG_S: f32 = 0.5;
/// Time constant with which the difference is learnt as the usual one, s, outside of bends.
const USUAL_S: f32 = 15.0;
/// The same within bends.
const USUAL_IN_BENDS_S: f32 = 300.0;
/// Difference beyond the usual one from which the vehicle leans, m. With stiff springs it is that of a steady bend of 1.6 m/s2;
/// a side slope of 10 % makes 5 mm.
const LEANS_M: f32 = 0.008;

/// Filters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parameters {
    lag: LowPass,
    usual: LowPass,
    usual_in_bends: LowPass,
}

impl Parameters {
    pub fn new() -> Self {
        let lag = |time_constant_s| LowPass::sampled(f32::from(TICKS) * TICK_S_F32, time_constant_s);
        Self {
            lag: lag(LAG_S),
            usual: lag(USUAL_S),
            usual_in_bends: lag(USUAL_IN_BENDS_S),
        }
    }
}

/// What is remembered, m.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct State {
    lagged_m: f32,
    usual_m: f32,
    leans: bool,
    tick: u8,
    started: bool,
}

impl State {
    pub const INITIAL: Self = Self {
        lagged_m: 0.0,
        usual_m: 0.0,
        leans: false,
        tick: 0,
        started: false,
    };

    /// One tick, with the difference `e`, m, and whether the vehicle corners; returns whether it leans.
    pub fn step(&mut self, c: &Parameters, difference_m: f32, corners: bool) -> bool {
        self.tick = (self.tick + 1) % TICKS;
        // Not in the tick in which the last corner's turn ends: that one has most to do.
        if self.tick != 1 {
            return self.leans;
        }
        self.look(c, difference_m, corners);
        self.leans
    }

    #[inline(never)]
    fn look(&mut self, c: &Parameters, difference_m: f32, corners: bool) {
        if !self.started {
            self.started = true;
            self.lagged_m = difference_m;
            self.usual_m = difference_m;
            // The look after the first one is in the next tick.
            self.tick = 0;
        }
        let lagged_m = c.lag.step(&mut self.lagged_m, difference_m);
        let usual = if corners { &c.usual_in_bends } else { &c.usual };
        let usual_m = usual.step(&mut self.usual_m, lagged_m);
        self.leans = (lagged_m - usual_m).abs() > LEANS_M;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::timing::ticks;

    /// After a minute straight ahead with a usual difference, m: how long a further one counts as leaning, s, at most 400.
    fn leans_for_s(usual_m: f32, further_m: f32, corners: bool) -> u16 {
        let (c, mut state) = (Parameters::new(), State::INITIAL);
        for _ in 0..ticks(60_000) {
            assert!(!state.step(&c, usual_m, false));
        }
        for _ in 0..ticks(2_000) {
            state.step(&c, usual_m + further_m, corners);
        }
        let mut second = || (0..ticks(1_000)).all(|_| state.step(&c, usual_m + further_m, corners));
        (0..400).find(|_| !second()).unwrap_or(400)
    }

    #[test]
    fn a_bend_leans_for_minutes_and_uneven_load_does_not() {
        for usual_m in [0.0, 0.02, -0.02] {
            for sign in [1.0, -1.0] {
                // 300 s x ln(20 / 8) = 275 s.
                let bend_s = leans_for_s(usual_m, sign * 0.02, true);
                assert!((265..277).contains(&bend_s), "{bend_s} s");
                assert_eq!(leans_for_s(usual_m, sign * 0.007, true), 0);
                assert!(leans_for_s(usual_m, sign * 0.02, false) < 16);
            }
        }
    }

    #[test]
    fn wheels_that_go_up_and_down_are_no_lean() {
        let (c, mut state) = (Parameters::new(), State::INITIAL);
        for tick in 0..ticks(20_000) {
            let sway_m = 0.02 * libm::sinf(2.0 * core::f32::consts::PI * 1.5 * f32::from(tick) * 0.005);
            assert!(!state.step(&c, sway_m, true), "tick {tick}");
        }
    }
}
