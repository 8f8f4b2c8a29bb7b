//! The default strategy with rear dampers that are predicted on roads on which the body heaves: the front wheels have met the road that the rear ones
//! will meet, so that there is something to predict.
//!
//! | | springs | front dampers | rear dampers |
//! |---|---|---|---|
//! | smooth road, or cornering | stiff | high | high |
//! | rough road | soft | low | low |
//! | rough road on which the body heaves | soft | damper 1 high, damper 2 low | the best of three levels on either side, by a forecast |
//!
//! Roads, bends and springs are [`super::road_and_cornering`]'s: a spring valve rests for 0.5 s after a change, which is beyond any forecast.
//! The levels are both bypass valves open, valve 1 closed, and both closed. Every 20 ms, for each corner and level, the force of the strut
//! over the next 160 ms is computed (`parts/forecast.rs`), in which the valves act as late as they are. With `f_i(k)` the force of
//! strut `i` beyond its load in step `k` of length `h`, a combination of levels costs
//!
//! ```text
//!   a(k)  = ( sum f_i / m,  l_y sum y_i f_i / (m i_x^2),  - l_x sum x_i f_i / (m i_y^2) )        heave, roll, pitch
//!   J     = h sum over k of |a - 0.8 LP(a)|^2  +  c |v|^2
//! ```
//!
//! `l_x` and `l_y` are the distances of the seats, `v` the velocities at the end of the forecast and `c` what they cost after it. `LP` is a lag at
//! 4 Hz: what is left passes 0.2 of a slow motion and all of a quick one, a first-order likeness of the weighting `W_b` of BS 6841, which
//! passes 0.4 below 2 Hz and 1 above 5 Hz. The sums over the struts of an axle are shared by all combinations. A corner whose valves have
//! moved keeps them for 100 ms, as `dwell` would, and others change only for a cost that is less by a part.
//!
//! The speed of the road is found under the front wheels (`parts/wheel.rs`), and the rear ones meet it after the delay that
//! `wheelbase.rs` finds. Where no delay is known the road ahead is taken for flat. Forecasts at the front, where it always is, can be
//! switched on and earn nothing (`docs/controller.md`).
//!
//! Bounds: a decision is 12 forecasts of 16 steps and 81 costs of 16 steps, whatever the input is.
//!
//! Sources: predictive semi-active control, M. Canale, M. Milanese and C. Novara, IEEE Trans. Control Syst. Technol. 14 (2006), 1034-1046;
//! preview from the front to the rear axle, R. S. Sharp and D. A. Wilson, Veh. Syst. Dyn. 19 (1990), 255-267; both *recalled*. Model, cost and
//! levels are this project's.

mod cost;

use oleo_interface::{Axle, Corner, Corners, Side, StrutValves};

use self::cost::{Cost, Motions, Sums};
use super::demand::{Decide, Demand};
use super::parts::forecast::{self, Course, LEVELS, STEPS};
use super::parts::semi_active::places_m;
use super::parts::strut_force::{Gases, StrutForce};
use super::parts::wheel::{Acting, Wheel};
use super::road_and_cornering::{self, RoadAndCornering};
use crate::estimate::{Estimate, GRAVITY_M_S2};
use crate::filter::{LeakyIntegrator, LowPass, at_least};
use crate::plausibility::Trusted;
use crate::range::{ConfigurationError, within};
use crate::timing::ticks;
use crate::valves::ValveCommand;
use crate::vehicle::VehicleDescription;
use crate::wheelbase::HISTORY;

/// Ticks from one decision to the next.
const DECISION_TICKS: u8 = 4;
/// Ticks for which a corner keeps its valves after a change, as `dwell` would.
const HOLD_TICKS: u8 = ticks(100) as u8;
/// Level at which the default strategy holds all dampers where the body heaves: valve 1 closed.
const FIRM: u8 = 1;
/// Distances of the seats from the centre of gravity to the side and along, m: RMS of both, vehicle preset.
const SEATS_M: (f32, f32) = (0.4, 0.68);
/// What a person may choose about it. See [`strategy::Tuning`](super::Tuning) for an example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// Road and bends.
    pub road: road_and_cornering::Tuning,
    /// Cost of the velocities at the end of the forecast, 1/s, 0 to 1000.
    pub velocity_cost_per_s: f32,
    /// Part by which a combination must cost less than the present one, 0 to 1.
    pub less_share: f32,
    /// Whether the rear wheels are known to meet the road of the front ones.
    pub preview: bool,
    /// Whether the front dampers are set by the forecast, too.
    pub front: bool,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            road: road_and_cornering::Tuning::default(),
            velocity_cost_per_s: 3.0, // measured: docs/controller.md
            less_share: 0.02,         // measured: docs/controller.md
            preview: true,
            front: false,
        }
    }
}

/// Parameters of the strategy. See [`Decide`] for an example of a strategy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Predictive {
    road: RoadAndCornering,
    strut: StrutForce,
    velocity: LeakyIntegrator,
    slow: LowPass,
    /// Contribution of a force over the mass at each strut to the three motions, at the seats.
    levers: Corners<Motions>,
    places_m: Corners<(f32, f32)>,
    cost: Cost,
    kept_share: f32,
    preview: bool,
    front: bool,
}

/// What the strategy remembers. See [`strategy::State`](super::State) for an example.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State {
    road: road_and_cornering::State,
    wheels: Corners<Wheel>,
    /// Heave, roll and pitch: velocity, m/s and rad/s, and lagged acceleration, m/s2 and rad/s2.
    velocity: Motions,
    slow: Motions,
    /// Level of each corner, the one before, and ticks for which it is kept.
    level: Corners<u8>,
    before: Corners<u8>,
    held: Corners<u8>,
    turn: u8,
    /// Speed of the road under the front wheels in the last ticks, m/s, in rings.
    met_m_s: [Ring; 2],
    now: usize,
}

/// The last ticks of a wheel.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Ring(#[cfg_attr(feature = "serde", serde(with = "serde_big_array::BigArray"))] [f32; HISTORY]);

impl Decide for Predictive {
    type Tuning = Tuning;
    type State = State;
    const INITIAL: State = State {
        road: RoadAndCornering::INITIAL,
        wheels: Corners::splat(Wheel::INITIAL),
        velocity: [0.0; 3],
        slow: [0.0; 3],
        level: Corners::splat(FIRM),
        before: Corners::splat(FIRM),
        held: Corners::splat(0),
        turn: 0,
        met_m_s: [Ring([0.0; HISTORY]); 2],
        now: 0,
    };

    fn check(tuning: &Tuning) -> Result<(), ConfigurationError> {
        RoadAndCornering::check(&tuning.road)?;
        within(
            "tuning.strategy.predictive.velocity_cost_per_s",
            tuning.velocity_cost_per_s,
            0.0,
            1000.0,
        )?;
        within("tuning.strategy.predictive.less_share", tuning.less_share, 0.0, 1.0)
    }

    fn new(vehicle: &VehicleDescription, tuning: &Tuning) -> Self {
        let ((side_m, along_m), places_m) = (SEATS_M, places_m(vehicle));
        let square = |x: f32| x * x;
        Self {
            road: RoadAndCornering::new(vehicle, &tuning.road),
            strut: StrutForce::new(vehicle),
            velocity: LeakyIntegrator::from_corner_hz(0.2),
            slow: LowPass::from_corner_hz(cost::SLOW_HZ),
            levers: places_m.map(|(ahead_m, left_m)| {
                [
                    1.0,
                    side_m * left_m / square(vehicle.roll_gyration_m),
                    -along_m * ahead_m / square(vehicle.pitch_gyration_m),
                ]
            }),
            places_m,
            cost: Cost::new(tuning.velocity_cost_per_s),
            kept_share: 1.0 - tuning.less_share,
            preview: tuning.preview,
            front: tuning.front,
        }
    }

    fn step(&self, state: &mut State, estimate: &Estimate, trusted: &Trusted) -> Demand {
        let demand = self.road.step(&mut state.road, estimate, trusted);
        self.observe(state, estimate, trusted);
        let firm = valves(FIRM);
        if demand.valves != ValveCommand::from_corners(Corners::splat(firm)) {
            // What the forecast begins with when the body begins to heave.
            (state.level, state.before) = (Corners::splat(FIRM), Corners::splat(FIRM));
            state.held = Corners::splat(HOLD_TICKS);
            return demand;
        }
        state.held = state.held.map(|held| held.saturating_sub(1));
        state.turn = state.turn.wrapping_add(1) % DECISION_TICKS;
        if state.turn == 0 {
            self.decide(state, estimate, trusted);
        }
        Demand {
            valves: ValveCommand::from_corners(state.level.map(valves)),
            ..demand
        }
    }
}

/// The valves of a strut with soft springs at a level.
fn valves(level: u8) -> StrutValves<bool> {
    let [first, second] = LEVELS.get(usize::from(level)).copied().unwrap_or([true, true]);
    StrutValves::new(first, second, true)
}

impl Predictive {
    /// Follows body, wheels and road.
    fn observe(&self, state: &mut State, estimate: &Estimate, trusted: &Trusted) {
        let accelerations = [
            estimate.vertical_acceleration_m_s2,
            estimate.roll_acceleration_rad_s2,
            estimate.pitch_acceleration_rad_s2,
        ];
        let motions = state.velocity.iter_mut().zip(&mut state.slow);
        for ((velocity, slow), acceleration) in motions.zip(accelerations) {
            self.velocity.step(velocity, acceleration);
            self.slow.step(slow, acceleration);
        }
        state.now = state.now.wrapping_add(1) % HISTORY;
        let [left, right] = &mut state.met_m_s;
        for (corner, wheel) in state.wheels.iter_mut() {
            let (load_n, displacement_m) = (estimate.static_load_n[corner], trusted.displacement_m[corner]);
            let oil_n = (trusted.pressure[corner].p1.pa() - trusted.p1_offset_pa[corner]) * self.strut.area_m2();
            let acting = Acting {
                strut_n: oil_n + forecast::stop_n(displacement_m) - load_n,
                load_n,
                body_m_s2: over(self.places_m[corner], accelerations),
                body_m_s: over(self.places_m[corner], state.velocity),
                road_m_s: 0.0,
            };
            let met_m_s = wheel.observe(&acting, displacement_m);
            if corner.axle() == Axle::Front {
                let Ring(ring) = if corner.side() == Side::Left {
                    &mut *left
                } else {
                    &mut *right
                };
                if let Some(place) = ring.get_mut(state.now) {
                    *place = met_m_s;
                }
            }
        }
    }

    /// Chooses the levels of the corners that may change.
    #[inline(never)]
    fn decide(&self, state: &mut State, estimate: &Estimate, trusted: &Trusted) {
        let free = Corners::from_fn(|corner| state.held[corner] == 0 && (self.front || corner.axle() == Axle::Rear));
        let courses = self.courses(state, &free, estimate, trusted);
        let weight_n: f32 = estimate.static_load_n.values().sum();
        let sums = Sums::of(&courses, &self.levers, GRAVITY_M_S2 / at_least(weight_n, 1.0));
        let (side_m, along_m) = SEATS_M;
        let at_seats = |[heave, roll, pitch]: Motions| [heave, side_m * roll, along_m * pitch];
        let (velocity, slow) = (at_seats(state.velocity), at_seats(state.slow));
        let cost = |[fl, fr, rl, rr]: [u8; 4]| self.cost.of(&sums, [fl, fr], [rl, rr], velocity, slow);
        let mut best = state.level;
        let mut least = self.kept_share * cost(state.level.into_array());
        for combination in combinations() {
            let fits = (combination.zip(state.level).zip(free).into_array().into_iter())
                .all(|((level, present), free)| free || level == present);
            if fits {
                let cost = cost(combination.into_array());
                if cost < least {
                    (best, least) = (combination, cost);
                }
            }
        }
        for corner in Corner::ALL {
            if state.level[corner] == best[corner] {
                continue;
            }
            state.before[corner] = state.level[corner];
            state.level[corner] = best[corner];
            state.held[corner] = HOLD_TICKS;
        }
    }

    /// What each strut's force will be with each level.
    fn courses(
        &self,
        state: &State,
        free: &Corners<bool>,
        estimate: &Estimate,
        trusted: &Trusted,
    ) -> Corners<[Course; LEVELS.len()]> {
        Corners::from_fn(|corner| {
            let now = forecast::Corner {
                wheel: state.wheels[corner],
                gases: Gases::measured(&trusted.pressure[corner], trusted.charge[corner]),
                load_n: estimate.static_load_n[corner],
                body_m_s: over(self.places_m[corner], state.velocity),
                levels: [state.before[corner].into(), state.level[corner].into()],
                // A forecast step is two ticks.
                since: i16::from(HOLD_TICKS.saturating_sub(state.held[corner])) / 2,
                road_m_s: match estimate.axle_delay_ticks {
                    Some(delay) if self.preview && corner.axle() == Axle::Rear => state.ahead(corner.side(), delay),
                    _ => [0.0; STEPS],
                },
            };
            now.courses(&self.strut, free[corner])
        })
    }
}

/// All combinations of the levels of four corners.
fn combinations() -> impl Iterator<Item = Corners<u8>> {
    let levels = LEVELS.len() as u8;
    let axle = move || (0..levels).flat_map(move |left| (0..levels).map(move |right| (left, right)));
    axle().flat_map(move |(fl, fr)| axle().map(move |(rl, rr)| Corners::from_array([fl, fr, rl, rr])))
}

impl State {
    /// Speed of the road under a rear wheel in the steps to come, m/s: that under the front one, a delay before; zero where the front
    /// one has not met it yet.
    fn ahead(&self, side: Side, delay_ticks: u8) -> [f32; STEPS] {
        let [left, right] = &self.met_m_s;
        let Ring(ring) = if side == Side::Left { left } else { right };
        let after = |ticks: usize| {
            let ago = usize::from(delay_ticks).checked_sub(ticks)?;
            ring.get((self.now + HISTORY).checked_sub(ago)? % HISTORY).copied()
        };
        let mut ahead = [0.0; STEPS];
        for (step, speed) in ahead.iter_mut().enumerate() {
            let both = [after(2 * step + 1), after(2 * step + 2)];
            *speed = 0.5 * both.into_iter().flatten().sum::<f32>();
        }
        ahead
    }
}

/// A motion of the body at a place ahead of and to the left of its centre of gravity.
fn over((ahead_m, left_m): (f32, f32), [heave, roll, pitch]: Motions) -> f32 {
    heave + left_m * roll - ahead_m * pitch
}

#[cfg(test)]
mod tests;
