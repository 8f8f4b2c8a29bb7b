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
//!             force step             dF = A (p - p1) = A (p4 - p1) V4 / (V1' + V4)
//! ```
//!
//! The rules for each strut use the pressures extrapolated by 60 ms, to the time at which the valve acts. The pressures of the front
//! and of the rear axle are looked at in every second tick, in turns: 5 ms are little to a valve that takes 40 to 90 ms.
//!
//! - A valve closes when `|x_t|` is below its bound (8 mm). It waits for that up to 150 ms in handling mode and 1 s for
//!   comfort, and not at all under the roll-over guard.
//! - A valve opens when `|dF|` is below its bound (5 % of the static load) at both struts of the axle, so that left and right
//!   change together. After 1 s it opens anyway, but throttled: valve 2 stays closed, so that the volumes equalise through
//!   damper 2, until p3 and p4 are within 0.2 MPa of each other.
//! - A valve does not move again within 0.5 s, except to close in an emergency.
//!
//! The shift that a closing in an emergency traps has no bound. [`Springs::trapped_shift_m`] reports it, and the next opening
//! releases it.

use oleo_interface::tick::TICK_S_F32;
use oleo_interface::{Absolute, Axle, Corner, Corners, Gauge, Side, StrutPressures, Valve};

use crate::filter::{Derivative, DerivativeState, at_least};
use crate::plausibility::Trusted;
use crate::range::{ConfigurationError, within};
use crate::strategy::Urgency;
use crate::timing::ticks;
use crate::valves::ValveCommand;
use crate::vehicle::VehicleDescription;

/// Time over which pressures are extrapolated, s: the middle of the valves' response times of 40 to 90 ms.
const AHEAD_S: f32 = 0.06;
const HANDLING_PATIENCE_TICKS: u16 = ticks(150);
const COMFORT_PATIENCE_TICKS: u16 = ticks(1_000);
const DWELL_TICKS: u16 = ticks(500);
/// Time from one look at an axle's pressures to the next, s.
const OBSERVATION_S: f32 = 2.0 * TICK_S_F32;
/// Time after which p4 follows p1 through an opened valve.
const SETTLE_TICKS: u16 = ticks(200);
/// Time after which a throttled opening ends even where the pressures stay apart: a sensor's offset must not keep the damper
/// hard for ever.
const LONGEST_THROTTLE_TICKS: u16 = ticks(1_000);
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
#[derive(Clone, Copy, Debug, Default)]
struct SpringValve {
    open: bool,
    throttled: bool,
    /// Number of ticks since the last change; it saturates.
    since: u16,
    /// Number of ticks for which a change has been wanted; it saturates.
    waiting: u16,
    /// Whether the filters have seen a pressure.
    observed: bool,
    p1_rate: DerivativeState,
    p4_rate: DerivativeState,
    trapped_shift_m: f32,
    opening_step_n: f32,
}

/// State of the four spring valves.
///
/// ```
/// use oleo_controller::plausibility::Trusted;
/// use oleo_controller::spring::Springs;
/// use oleo_controller::strategy::Urgency;
/// use oleo_controller::{Absolute, Configuration, Corners, Gauge, StrutPressures};
/// let parameters = Configuration::defender110().spring;
/// // Struts at rest under 2 MPa, charged for exactly that.
/// let trusted = Trusted {
///     pressure: Corners::splat(StrutPressures::splat(Gauge(2.0e6))),
///     charge: Corners::splat(Absolute(2_101_325.0)),
///     ..Trusted::default()
/// };
/// let (load_n, wanted) = (Corners::splat(3927.0), Corners::splat(true));
/// let mut springs = Springs::default();
/// // The pressures are equal, so all valves open as soon as they have rested for 0.5 s.
/// let mut tick = || springs.step(&parameters, &trusted, &load_n, wanted, Urgency::Comfort);
/// assert_eq!((0..99).map(|_| tick()).last(), Some(Corners::splat(false)));
/// assert_eq!(tick(), Corners::splat(true));
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Springs {
    valves: Corners<SpringValve>,
    /// Whether the pressures of the rear axle are the next to be looked at.
    rear_is_next: bool,
}

impl Springs {
    /// One tick: returns whether valve 3 is to be open at each corner; `wanted` says where the strategy wants it open. While
    /// the mode machine keeps all valves closed, call [`Springs::forced_closed`] instead.
    pub fn step(
        &mut self,
        c: &Parameters,
        trusted: &Trusted,
        static_load_n: &Corners<f32>,
        wanted: Corners<bool>,
        urgency: Urgency,
    ) -> Corners<bool> {
        self.observe(c, trusted, wanted);
        let axles = self.valves.each_mut().zip(wanted).zip(*static_load_n).by_axle();
        for (((left, left_wanted), left_load_n), ((right, right_wanted), right_load_n)) in axles.into_array() {
            // The valves of an axle that are to open do so together.
            let smooth = (!left_wanted || left.opens_smoothly(c, left_load_n))
                && (!right_wanted || right.opens_smoothly(c, right_load_n));
            for (valve, wanted) in [(left, left_wanted), (right, right_wanted)] {
                if wanted {
                    valve.open_if_due(smooth);
                } else {
                    valve.close_if_due(c, urgency);
                }
            }
        }
        self.valves.map(|valve| valve.open)
    }

    /// One tick in which the mode machine keeps all valves closed. Their next opening obeys the rules above.
    pub fn forced_closed(&mut self, c: &Parameters, trusted: &Trusted) {
        self.observe(c, trusted, Corners::splat(false));
        for valve in self.valves.values_mut() {
            if valve.open {
                valve.change(false);
            }
        }
    }

    fn observe(&mut self, c: &Parameters, trusted: &Trusted, wanted: Corners<bool>) {
        for (valve, wanted) in self.valves.each_mut().zip(wanted).into_array() {
            valve.wait(wanted);
        }
        let axle = if self.rear_is_next { Axle::Rear } else { Axle::Front };
        self.rear_is_next = !self.rear_is_next;
        for corner in Side::ALL.map(|side| axle.corner(side)) {
            self.valves[corner].observe(c, &trusted.pressure[corner], trusted.charge[corner]);
        }
    }

    /// Corners at which valve 3 opens throttled through damper 2, so that valve 2 is to stay closed.
    pub fn throttled(&self) -> Corners<bool> {
        self.valves.each_ref().map(|valve| valve.throttled)
    }

    /// The signals of the bypass valves, with those of valve 3 as they are to be. Valve 2 stays closed where valve 3 opens throttled,
    /// and also where it is closed: there it has no effect, and a valve that is not energised does not wear.
    pub fn applied_to(&self, bypass: ValveCommand) -> ValveCommand {
        let (mut open, mut closed) = (0, 0);
        for (corner, valve) in self.valves.iter() {
            let bit = |valve| 1 << ValveCommand::bit(corner, valve);
            if valve.open {
                open |= bit(Valve::Spring);
            }
            if !valve.open || valve.throttled {
                closed |= bit(Valve::Bypass2);
            }
        }
        ValveCommand::from_word((bypass.word() | open) & !closed)
    }

    /// Whether valve 3 of a corner has been open for so long that p4 follows p1.
    pub fn is_settled_open(&self, corner: Corner) -> bool {
        let valve = &self.valves[corner];
        valve.open && valve.since >= SETTLE_TICKS && !valve.throttled
    }

    /// Shift of the ride height by the oil behind each closed valve 3, m, positive where the corner is lower. Where the valve
    /// is open it is the shift that closing it would trap.
    pub fn trapped_shift_m(&self) -> Corners<f32> {
        self.valves.each_ref().map(|valve| valve.trapped_shift_m)
    }
}

impl SpringValve {
    fn change(&mut self, open: bool) {
        self.open = open;
        self.since = 0;
        self.waiting = 0;
        self.throttled = false;
    }

    /// One tick of waiting, or of rest.
    fn wait(&mut self, wanted: bool) {
        self.since = self.since.saturating_add(1);
        self.waiting = if wanted == self.open {
            0
        } else {
            self.waiting.saturating_add(1)
        };
    }

    /// Takes over what the pressures say, once in [`OBSERVATION_S`].
    fn observe(&mut self, c: &Parameters, pressure: &StrutPressures<Gauge<f32>>, charge: Absolute<f32>) {
        if !self.observed {
            self.observed = true;
            self.p1_rate = DerivativeState::at_rest(pressure.p1.pa());
            self.p4_rate = DerivativeState::at_rest(pressure.p4.pa());
        }
        let (v1, v2) = (c.gas_volume_1_m3, c.gas_volume_2_m3);
        let ahead = |p: Gauge<f32>, rate: &mut DerivativeState| {
            let later = p.absolute() + AHEAD_S * c.pressure_rate.step(rate, p.pa());
            Absolute(at_least(later.pa(), LEAST_PA))
        };
        let p1 = ahead(pressure.p1, &mut self.p1_rate);
        let p4 = ahead(pressure.p4, &mut self.p4_rate);
        let gas4 = v2 * charge.pa() / p4.pa();
        self.trapped_shift_m = (v2 - gas4) * c.per_piston_area;
        if !self.open {
            let gas1 = v1 * charge.pa() / p1.pa();
            self.opening_step_n = c.piston_area_m2 * (p4 - p1) * gas4 / at_least(gas1 + gas4, f32::MIN_POSITIVE);
        }
        if self.throttled
            && ((pressure.p3 - pressure.p4).abs() < EQUAL_PA && self.since >= SETTLE_TICKS
                || self.since >= LONGEST_THROTTLE_TICKS)
        {
            self.throttled = false;
        }
    }

    fn opens_smoothly(&self, c: &Parameters, static_load_n: f32) -> bool {
        self.open || self.opening_step_n.abs() <= c.opening_step_share * static_load_n
    }

    fn open_if_due(&mut self, smooth: bool) {
        if self.open || self.since < DWELL_TICKS {
            return;
        }
        if smooth {
            self.change(true);
        } else if self.waiting >= COMFORT_PATIENCE_TICKS {
            self.change(true);
            self.throttled = true;
        }
    }

    fn close_if_due(&mut self, c: &Parameters, urgency: Urgency) {
        let patience = match urgency {
            Urgency::Emergency => 0,
            Urgency::Handling => HANDLING_PATIENCE_TICKS,
            Urgency::Comfort => COMFORT_PATIENCE_TICKS,
        };
        let rested = self.since >= DWELL_TICKS || urgency == Urgency::Emergency;
        if self.open && rested && (self.waiting > patience || self.trapped_shift_m.abs() <= c.trapped_shift_m) {
            self.change(false);
        }
    }
}
