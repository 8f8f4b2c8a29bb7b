//! Whether the gas still carries more on one side than on the other, so that a bend that has been decided on is not over.
//!
//! [`super::cornering`] follows the lateral acceleration, which comes from p1. A p1 that reads wrong puts a bias on it, and so does a
//! bend that lasts so long that it is learnt as a side slope. Either could end cornering in the middle of a bend: the springs would
//! open, and the vehicle would lean much further. How far the first gas of each strut is compressed also tells how the load is
//! shared, and follows from other sensors, the displacement and p4 (`Trusted::load_to_right_m`):
//!
//! ```text
//!   e      = (c_fr + c_rr - c_fl - c_rl) / 2 + K phi / (s k),  lagged by 0.5 s
//!                                              c    compression of the first gas, m of stroke
//!                                              K    stiffness of the anti-roll bars, N m/rad, phi  roll relative to the axles
//!                                              s    distance between left and right struts, k  stiffness of the first gas
//!   mean   of e over 15 s outside of bends, and over 300 s within      uneven load, side slope, offset of a sensor
//!   leans  if |e - mean| > 8 mm
//! ```
//!
//! The bars' share tells a bend from a lean that is only trapped: in a bend struts and bars carry more on the same side, and where the
//! springs were closed while the vehicle swayed, the bars push one way and the struts the other.
//!
//! It only prolongs: a wrong displacement alone neither begins a bend nor ends one. Five minutes are long for a bend; a sensor
//! with an offset that begins within one keeps the vehicle stiff for no longer.

use oleo_interface::Axles;
use oleo_interface::tick::TICK_S_F32;

use crate::filter::LowPass;
use crate::vehicle::VehicleDescription;

/// Ticks from one look at the difference to the next: it changes only when all corners have had their turn.
pub(crate) const TICKS: u8 = 4;
/// Lag of the difference, s: what the road does to it must not count.
const LAG_S: f32 = 0.5;
/// Time constant with which the difference is learnt as the usual one, s, outside of bends.
const USUAL_S: f32 = 15.0;
/// The same within bends.
const USUAL_IN_BENDS_S: f32 = 300.0;
/// Difference beyond the usual one from which the vehicle leans, m. With stiff springs it is that of a steady bend of 1.6 m/s2;
/// a side slope of 10 % makes 5 mm.
const LEANS_M: f32 = 0.008;

/// Absolute pressure of the first gas at the static position, Pa, for its stiffness: that of the vehicle as sold.
const STATIC_PA: f32 = 2.1e6;

/// Filters, and the anti-roll bars' share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parameters {
    bars_m_rad: f32,
    lag: LowPass,
    usual: LowPass,
    usual_in_bends: LowPass,
}

impl Parameters {
    /// From a description that has been checked.
    pub fn new(vehicle: &VehicleDescription) -> Self {
        let Axles { front, rear } = vehicle.anti_roll_stiffness_n_m_rad;
        let spacing_m = 0.5 * (vehicle.strut_spacing_m.front + vehicle.strut_spacing_m.rear);
        let stiffness_n_m = STATIC_PA * vehicle.piston_area_m2 * vehicle.piston_area_m2 / vehicle.gas_volume_1_m3;
        let lag = |time_constant_s| LowPass::sampled(f32::from(TICKS) * TICK_S_F32, time_constant_s);
        Self {
            bars_m_rad: (front + rear) / (spacing_m * stiffness_n_m),
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

    /// One tick, with how much further the first gas is compressed on the right, m, the roll relative to the axles, positive with the
    /// right side down, and whether the vehicle corners; returns whether it leans.
    pub fn step(&mut self, c: &Parameters, struts_m: f32, roll_rad: f32, corners: bool) -> bool {
        self.tick = (self.tick + 1) % TICKS;
        // Not in the tick in which the last corner's turn ends: that one has most to do.
        if self.tick != 1 {
            return self.leans;
        }
        self.look(c, struts_m + c.bars_m_rad * roll_rad, corners);
        self.leans
    }

    /// Whether it has looked in this tick, as it does in each fourth one: a tick with time for what need not be done in every one.
    pub fn has_looked(&self) -> bool {
        self.tick == 1
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
        let (c, mut state) = (Parameters::new(&VehicleDescription::default()), State::INITIAL);
        for _ in 0..ticks(60_000) {
            assert!(!state.step(&c, usual_m, 0.0, false));
        }
        for _ in 0..ticks(2_000) {
            state.step(&c, usual_m + further_m, 0.0, corners);
        }
        let mut second = || (0..ticks(1_000)).all(|_| state.step(&c, usual_m + further_m, 0.0, corners));
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
        let (c, mut state) = (Parameters::new(&VehicleDescription::default()), State::INITIAL);
        for tick in 0..ticks(20_000) {
            let sway_m = 0.02 * libm::sinf(2.0 * core::f32::consts::PI * 1.5 * f32::from(tick) * 0.005);
            assert!(!state.step(&c, sway_m, 0.0, true), "tick {tick}");
        }
    }

    /// The bar of the preset, 8 kN m/rad, against struts of 81 kN/m a metre apart: 1.7 mm for each degree.
    #[test]
    fn a_lean_that_is_trapped_is_no_bend() {
        let c = Parameters::new(&VehicleDescription::default());
        for roll_rad in [0.08_f32, -0.08] {
            let (mut trapped, mut bend) = (State::INITIAL, State::INITIAL);
            trapped.step(&c, 0.0, 0.0, false);
            bend.step(&c, 0.0, 0.0, false);
            let carried_m = 0.1 * roll_rad;
            let mut leans = [false; 2];
            for _ in 0..ticks(5_000) {
                leans[0] = trapped.step(&c, -1.5 * carried_m, roll_rad, true);
                leans[1] = bend.step(&c, carried_m, roll_rad, true);
            }
            assert_eq!(leans, [false, true], "{roll_rad} rad");
        }
    }
}
