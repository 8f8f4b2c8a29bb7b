//! Switching of valve 3 at any displacement: when to close and open it, and how much oil its closing traps.
//!
//! The report's first model could change springs at the reference position only. The reason is the oil: closing valve 3 keeps
//! in accumulator 2 whatever oil is in it then, and opening it joins two volumes of different pressure. Both effects follow
//! from the measured pressures (absolute; `k` charge pressure, `V1`, `V2` gas volumes at static position, `A` piston area,
//! isothermal as in the report):
//!
//! ```text
//!   closing   gas left behind        V4 = V2 k / p4
//!             shift of ride height   x_t = (V2 - V4) / A = V2 (1 - k / p4) / A          (+ lower)
//!   opening   common pressure        p = (V1' p1 + V4 p4) / (V1' + V4),  V1' = V1 k / p1
//!             force step             dF = A (p - p1) = A (p4 - p1) V4 / (V1' + V4) = A (p4 - p1) V2 p1 / (V1 p4 + V2 p1)
//! ```
//!
//! The rules for each strut use the pressures extrapolated by 60 ms, to the time at which the valve acts. The struts are looked at in
//! turns, one in each tick: 15 ms are little to a valve that takes 40 to 90 ms.
//!
//! - A valve closes when `|x_t|` is below its bound (8 mm). It waits for that up to 150 ms in handling mode and 1 s for
//!   comfort, and not at all under the roll-over guard.
//! - A valve opens when `|dF|` is below its bound (5 % of the static load) at both struts of the axle, so that left and right
//!   change together. After 1 s it opens anyway, but throttled: valve 2 stays closed, so that the volumes equalise through
//!   damper 2, until p3 and p4 are within 0.2 MPa of each other.
//! - A valve does not move again within 0.5 s, except to close in an emergency.
//! - In a bend a valve closes when its strut has its turn, and opens only to let out a lean that was trapped (`spring/trapped_lean.rs`).
//!
//! The shift that a closing in a bend or an emergency traps has no bound. [`Springs::trapped_shift_m`] reports it, and the next opening
//! releases it.

mod trapped_lean;

use oleo_interface::{Absolute, Axles, Corner, Corners, Gauge, Side, StrutPressures, Valve};

use crate::filter::{Derivative, DerivativeState, at_least};
use crate::plausibility::Trusted;
use crate::plausibility::turn::{TURN_S, next};
use crate::range::{ConfigurationError, within};
use crate::strategy::Urgency;
use crate::timing::ticks;
use crate::valves::{BYPASS2_BITS, SPRING_BITS, ValveCommand};
use crate::vehicle::VehicleDescription;

/// Time over which pressures are extrapolated, s: the middle of the valves' response times of 40 to 90 ms.
const AHEAD_S: f32 = 0.06;
const HANDLING_PATIENCE_TICKS: u32 = ticks(150) as u32;
const COMFORT_PATIENCE_TICKS: u32 = ticks(1_000) as u32;
const DWELL_TICKS: u32 = ticks(500) as u32;
/// Time from one look at a strut's pressures to the next, s.
const OBSERVATION_S: f32 = TURN_S;
/// Time after which p4 follows p1 through an opened valve.
const SETTLE_TICKS: u32 = ticks(200) as u32;
/// Time after which a throttled opening ends even where the pressures stay apart: a sensor's offset must not keep the damper
/// hard for ever.
const LONGEST_THROTTLE_TICKS: u32 = ticks(1_000) as u32;
/// Pressures closer than this count as equal, Pa.
const EQUAL_PA: f32 = 0.2e6;
/// Absolute pressure below which an accumulator counts as empty, Pa.
const LEAST_PA: f32 = 2.0e4;

/// What a person may choose about the spring valves.
///
/// ```
/// use oleo_controller::{Builder, spring};
/// let mut builder = Builder::default();
/// builder.tuning.spring = spring::Tuning { trapped_shift_m: 0.012, ..spring::Tuning::default() };
/// assert!(builder.build().is_ok());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// Largest shift of the ride height that closing valve 3 may trap, m, 1e-4 to 0.1.
    pub trapped_shift_m: f32,
    /// Largest force step on opening valve 3, as a fraction of the static load, 1e-3 to 1.
    pub opening_step_share: f32,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            trapped_shift_m: 0.008,   // assumed
            opening_step_share: 0.05, // assumed
        }
    }
}

impl Tuning {
    /// Whether every value is within its range.
    pub(crate) fn check(&self) -> Result<(), ConfigurationError> {
        within("tuning.spring.trapped_shift_m", self.trapped_shift_m, 1e-4, 0.1)?;
        within("tuning.spring.opening_step_share", self.opening_step_share, 1e-3, 1.0)
    }
}

/// Dimensions, bounds and the filter of the pressures' rates. See [`Springs`] for an example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    piston_area_m2: f32,
    per_piston_area: f32,
    gas_volume_1_m3: f32,
    gas_volume_2_m3: f32,
    pressure_rate: Derivative,
    trapped_shift_m: f32,
    opening_step_share: f32,
}

impl Parameters {
    /// From a description and a tuning that have been checked.
    pub(crate) fn new(vehicle: &VehicleDescription, tuning: &Tuning) -> Self {
        Self {
            piston_area_m2: vehicle.piston_area_m2,
            per_piston_area: 1.0 / vehicle.piston_area_m2,
            gas_volume_1_m3: vehicle.gas_volume_1_m3,
            gas_volume_2_m3: vehicle.gas_volume_2_m3,
            // Slower than the strut speed: 5 kPa steps.
            pressure_rate: Derivative::sampled(OBSERVATION_S, 8.0),
            trapped_shift_m: tuning.trapped_shift_m,
            opening_step_share: tuning.opening_step_share,
        }
    }
}

/// State of one spring valve.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct SpringValve {
    /// Value of [`Springs::now`] at the last change.
    changed_at: u32,
    /// Value of [`Springs::now`] in the last tick before a change was wanted, while one is.
    wanted_since: u32,
    /// Whether the filters have seen a pressure.
    observed: bool,
    p1_rate: DerivativeState,
    p4_rate: DerivativeState,
    opening_step_n: f32,
}

/// State of the four spring valves.
///
/// ```
/// use oleo_controller::plausibility::Trusted;
/// use oleo_controller::spring::Springs;
/// use oleo_controller::strategy::Urgency;
/// use oleo_controller::{Absolute, Configuration, Corners, Gauge, StrutPressures, ValveCommand};
/// let parameters = Configuration::defender110().spring;
/// // Struts at rest under 2 MPa, charged for exactly that.
/// let trusted = Trusted {
///     pressure: Corners::splat(StrutPressures::splat(Gauge(2.0e6))),
///     charge: Corners::splat(Absolute(2_101_325.0)),
///     ..Trusted::default()
/// };
/// let (load_n, wanted) = (Corners::splat(3927.0), ValveCommand::SOFT);
/// let mut springs = Springs::default();
/// // The pressures are equal, so all valves open as soon as they have rested for 0.5 s.
/// let mut tick = || springs.step(&parameters, &trusted, &load_n, wanted, Urgency::Comfort);
/// assert_eq!((0..99).map(|_| tick()).last(), Some(ValveCommand::SAFE));
/// assert_eq!(tick(), ValveCommand::from_word(0b100_100_100_100));
/// ```
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Springs {
    /// Number of ticks so far. It wraps after 248 days; a valve that last moved exactly then rests once more.
    now: u32,
    /// The bits of valve 3 alone, here and in the next two: valves that are open.
    open: u16,
    /// Valves that open throttled through damper 2.
    throttled: u16,
    /// Valves that were wanted elsewhere at the end of the last tick.
    waiting: u16,
    /// The strut whose pressures are the next to be looked at.
    turn: Corner,
    trapped_shift_m: Corners<f32>,
    valves: Corners<SpringValve>,
}

/// The bit of a corner's valve 3 in a command.
const fn bit(corner: Corner) -> u16 {
    1 << ValveCommand::bit(corner, Valve::Spring)
}

impl Default for Springs {
    fn default() -> Self {
        Self::INITIAL
    }
}

impl Springs {
    pub(crate) const INITIAL: Self = Self {
        now: 0,
        open: 0,
        throttled: 0,
        waiting: 0,
        turn: Corner::FrontLeft,
        trapped_shift_m: Corners::splat(0.0),
        valves: Corners::splat(SpringValve::INITIAL),
    };

    /// One tick: returns where valve 3 is to be open; `wanted` says where the strategy wants it open. In both, the bits of the bypass
    /// valves say nothing. In a bend all valves 3 are to close, whatever `wanted` says, but for what lets a lean out. While the mode machine keeps all valves closed, call [`Springs::forced_closed`] instead.
    pub fn step(
        &mut self,
        c: &Parameters,
        trusted: &Trusted,
        static_load_n: &Corners<f32>,
        wanted: ValveCommand,
        urgency: Urgency,
    ) -> ValveCommand {
        let corner = self.observe(c, trusted);
        let wanted = wanted.word() & SPRING_BITS;
        if let Urgency::Bend { outer } = urgency {
            self.let_lean_out(c, static_load_n, corner, outer);
            self.waiting = 0;
        } else if wanted == self.open {
            self.waiting = 0;
        } else {
            self.change(c, static_load_n, wanted, urgency);
        }
        ValveCommand::from_word(self.open)
    }

    /// One tick in which the mode machine keeps all valves closed. Their next opening obeys the rules above.
    pub fn forced_closed(&mut self, c: &Parameters, trusted: &Trusted) {
        self.observe(c, trusted);
        self.waiting = 0;
        if self.open != 0 {
            for (corner, valve) in self.valves.iter_mut() {
                if self.open & bit(corner) != 0 {
                    valve.changed_at = self.now;
                }
            }
            (self.open, self.throttled) = (0, 0);
        }
    }

    /// Called in ticks in which some valve is wanted elsewhere; most ticks have none.
    #[inline(never)]
    fn change(&mut self, c: &Parameters, static_load_n: &Corners<f32>, wanted: u16, urgency: Urgency) {
        for corner in Corner::ALL {
            if self.waiting & bit(corner) == 0 {
                self.valves[corner].wanted_since = self.now.wrapping_sub(1);
            }
        }
        let is_wanted = |corner| wanted & bit(corner) != 0;
        // The valves of an axle that are to open do so together.
        let smooth = Axles::from_fn(|axle| {
            (Side::ALL.map(|side| axle.corner(side)).into_iter())
                .filter(|corner| is_wanted(*corner) && !self.is_open(*corner))
                .all(|corner| self.valves[corner].opening_step_n.abs() <= c.opening_step_share * static_load_n[corner])
        });
        let elsewhere = wanted ^ self.open;
        for corner in Corner::ALL.into_iter().filter(|corner| elsewhere & bit(*corner) != 0) {
            if wanted & bit(corner) != 0 {
                self.open_if_due(corner, smooth[corner.axle()]);
            } else {
                self.close_if_due(c, corner, urgency);
            }
        }
        self.waiting = wanted ^ self.open;
    }

    #[inline(never)]
    fn open_if_due(&mut self, corner: Corner, smooth: bool) {
        if self.since(corner) < DWELL_TICKS {
            return;
        }
        if smooth {
            self.toggle(corner);
        } else if self.waits(corner) >= COMFORT_PATIENCE_TICKS {
            self.toggle(corner);
            self.throttled |= bit(corner);
        }
    }

    #[inline(never)]
    fn close_if_due(&mut self, c: &Parameters, corner: Corner, urgency: Urgency) {
        let patience = match urgency {
            Urgency::Bend { .. } | Urgency::Emergency => 0,
            Urgency::Handling => HANDLING_PATIENCE_TICKS,
            Urgency::Comfort => COMFORT_PATIENCE_TICKS,
        };
        let rested = self.since(corner) >= DWELL_TICKS || urgency == Urgency::Emergency;
        let little_trapped = self.trapped_shift_m[corner].abs() <= c.trapped_shift_m;
        if rested && (self.waits(corner) > patience || little_trapped) {
            self.toggle(corner);
        }
    }

    /// Opens a valve that is closed, or closes one that is open. One copy for all who do: it is rare.
    #[inline(never)]
    fn toggle(&mut self, corner: Corner) {
        self.valves[corner].changed_at = self.now;
        self.throttled &= !bit(corner);
        self.open ^= bit(corner);
    }

    /// Takes over what the pressures of the strut say whose turn it is, and returns its corner.
    #[inline(never)]
    fn observe(&mut self, c: &Parameters, trusted: &Trusted) -> Corner {
        self.now = self.now.wrapping_add(1);
        let corner = self.turn;
        self.turn = next(corner);
        let pressure = &trusted.pressure[corner];
        self.trapped_shift_m[corner] = self.valves[corner].observe(c, pressure, trusted.charge[corner]);
        if self.throttled & bit(corner) != 0 {
            let (since, apart) = (self.since(corner), (pressure.p3 - pressure.p4).abs());
            if apart < EQUAL_PA && since >= SETTLE_TICKS || since >= LONGEST_THROTTLE_TICKS {
                self.throttled &= !bit(corner);
            }
        }
        corner
    }

    /// Corners at which valve 3 opens throttled through damper 2, so that valve 2 is to stay closed.
    pub fn throttled(&self) -> Corners<bool> {
        Corners::from_fn(|corner| self.throttled & bit(corner) != 0)
    }

    /// The signals of the bypass valves, with those of valve 3 as they are to be. Valve 2 stays closed where valve 3 opens throttled,
    /// and also where it is closed: there it has no effect, and a valve that is not energised does not wear.
    pub fn applied_to(&self, bypass: ValveCommand) -> ValveCommand {
        // The bit of valve 2 is next to that of valve 3, below it.
        let bypass2 = (self.open & !self.throttled) >> 1;
        ValveCommand::from_word(bypass.word() & (bypass2 | !BYPASS2_BITS) | self.open)
    }

    /// Whether valve 3 of a corner has been open for so long that p4 follows p1.
    pub fn is_settled_open(&self, corner: Corner) -> bool {
        self.open & !self.throttled & bit(corner) != 0 && self.since(corner) >= SETTLE_TICKS
    }

    /// Shift of the ride height by the oil behind each closed valve 3, m, positive where the corner is lower. Where the valve
    /// is open it is the shift that closing it would trap.
    pub fn trapped_shift_m(&self) -> Corners<f32> {
        self.trapped_shift_m
    }

    const fn is_open(&self, corner: Corner) -> bool {
        self.open & bit(corner) != 0
    }

    /// Ticks since a valve has changed.
    fn since(&self, corner: Corner) -> u32 {
        self.now.wrapping_sub(self.valves[corner].changed_at)
    }

    /// Ticks for which a change of a valve has been wanted, with this one.
    fn waits(&self, corner: Corner) -> u32 {
        self.now.wrapping_sub(self.valves[corner].wanted_since)
    }
}

impl SpringValve {
    const INITIAL: Self = Self {
        changed_at: 0,
        wanted_since: 0,
        observed: false,
        p1_rate: DerivativeState::INITIAL,
        p4_rate: DerivativeState::INITIAL,
        opening_step_n: 0.0,
    };

    /// Takes over what the pressures say, once in [`OBSERVATION_S`]; returns the trapped shift, m.
    fn observe(&mut self, c: &Parameters, pressure: &StrutPressures<Gauge<f32>>, charge: Absolute<f32>) -> f32 {
        if !self.observed {
            self.observed = true;
            self.p1_rate = DerivativeState::at_rest(pressure.p1.pa());
            self.p4_rate = DerivativeState::at_rest(pressure.p4.pa());
        }
        let (v1, v2) = (c.gas_volume_1_m3, c.gas_volume_2_m3);
        let ahead = |p: Gauge<f32>, rate: &mut DerivativeState| {
            let later = p.absolute() + AHEAD_S * c.pressure_rate.step(rate, p.pa());
            at_least(later.pa(), LEAST_PA)
        };
        let p1 = ahead(pressure.p1, &mut self.p1_rate);
        let p4 = ahead(pressure.p4, &mut self.p4_rate);
        let gas = v2 * p1;
        self.opening_step_n = c.piston_area_m2 * (p4 - p1) * gas / (v1 * p4 + gas);
        (v2 - v2 * charge.pa() / p4) * c.per_piston_area
    }
}

#[cfg(test)]
mod tests;
