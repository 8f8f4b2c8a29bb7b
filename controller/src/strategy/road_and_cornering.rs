//! Stiff on a smooth road, soft on a rough one, stiff again as soon as the vehicle corners.
//!
//! | | springs | dampers |
//! |---|---|---|
//! | smooth road, or cornering | stiff | high |
//! | rough road | soft | low |
//! | rough road on which the body heaves | soft | damper 1 high, damper 2 low |
//! | rough road, a bend is suspected | soft | high |
//!
//! On a smooth road nothing has to be decided in time, because the vehicle is stiff already. On a rough one it becomes stiff as
//! soon as the lateral acceleration stands out of what the road does ([`super::parts::cornering`]), and at once: a lean that the closing
//! springs trap is smaller than the one that a later closing would find, and the road lets it out again ([`crate::spring`]). It stays so while the gas says that it leans
//! (`parts::load_transfer`). How rough the road is is told by the running RMS of the body's vertical acceleration, which is not
//! judged while the vehicle corners, and does not begin to count as rough while the lateral acceleration has the greater RMS: a bend
//! that is not recognised, on a vehicle whose sensors are off, must not open the springs.
//!
//! High damping quietens a body that heaves on its springs, and passes on what shakes the wheels. So damper 1 is set by the heave alone, the
//! vertical acceleration below 5 Hz: `docs/controller.md` has the measurement.

use super::demand::{Decide, Demand, Urgency};
use super::parts::cornering::{self, Cornering};
use super::parts::{load_transfer, rollover_guard};
use crate::estimate::Estimate;
use crate::filter::LowPass;
use crate::plausibility::Trusted;
use crate::range::{ConfigurationError, Hysteresis};
use crate::timing::ticks;
use crate::valves::{BYPASS_BITS, BYPASS2_BITS, SPRING_BITS, ValveCommand};
use crate::vehicle::VehicleDescription;

/// What passes of a vertical acceleration as heave: what is below 5 Hz, looked at every 20 ms. Constants, because code that computes them
/// has no place on the board.
const HEAVE: LowPass = LowPass::of_part(0.466_511_9);
/// Memory of the running RMS of the heave: 0.5 s, half a swing of the body on soft springs.
const HEAVE_MEMORY: LowPass = LowPass::of_part(0.039_210_565);
/// Shortest time that the road counts as rough, or as smooth: looks in 1 s.
const ROAD_DWELL_LOOKS: u16 = ticks(1_000) / load_transfer::TICKS as u16;

/// Thresholds. See [`strategy::Tuning`](super::Tuning) for an example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// When the vehicle corners.
    pub cornering: cornering::Tuning,
    /// Running RMS of the vertical acceleration at which a smooth road begins to count as rough (`begin`) and at which a rough
    /// one begins to count as smooth (`end`), m/s2, 0.01 to 10. The first is felt with stiff springs, the second with soft.
    pub rough_m_s2: Hysteresis,
    /// Running RMS of the heave at which damper 1 begins to be high (`begin`), and low again (`end`), m/s2, 0.01 to 20.
    pub heave_m_s2: Hysteresis,
    /// When the roll-over guard acts.
    pub rollover_guard: rollover_guard::Tuning,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            cornering: cornering::Tuning::default(),
            rough_m_s2: Hysteresis { begin: 0.25, end: 0.06 },
            heave_m_s2: Hysteresis { begin: 1.0, end: 0.7 }, // measured: docs/controller.md
            rollover_guard: rollover_guard::Tuning::default(),
        }
    }
}

/// Parameters of the strategy. See [`Decide`] for an example of a strategy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoadAndCornering {
    cornering: cornering::Parameters,
    load_transfer: load_transfer::Parameters,
    rough_2: Hysteresis,
    heave_2: Hysteresis,
    guard: rollover_guard::Tuning,
}

/// What the strategy remembers. See [`strategy::State`](super::State) for an example.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State {
    cornering: cornering::State,
    load_transfer: load_transfer::State,
    corners: bool,
    rough: bool,
    heaves: bool,
    /// Vertical acceleration below 5 Hz, m/s2, and its running mean square.
    heave_m_s2: f32,
    heave_mean_square: f32,
    /// Looks before the road may be judged again.
    dwell: u16,
    guard: rollover_guard::State,
}

#[cfg(all(test, feature = "comparison"))]
impl State {
    /// On a rough road on which the body heaves so much that it does for three seconds more, whatever the estimate says.
    pub(super) fn heaving() -> Self {
        Self {
            rough: true,
            heaves: true,
            heave_mean_square: 1_000.0,
            ..RoadAndCornering::INITIAL
        }
    }
}

impl Decide for RoadAndCornering {
    type Tuning = Tuning;
    type State = State;
    const INITIAL: State = State {
        cornering: cornering::State::INITIAL,
        load_transfer: load_transfer::State::INITIAL,
        corners: false,
        rough: false,
        heaves: false,
        heave_m_s2: 0.0,
        heave_mean_square: 0.0,
        dwell: 0,
        guard: rollover_guard::State::INITIAL,
    };

    fn check(tuning: &Tuning) -> Result<(), ConfigurationError> {
        tuning.cornering.check()?;
        tuning
            .rough_m_s2
            .check("tuning.strategy.road_and_cornering.rough_m_s2", 0.01, 10.0)?;
        tuning
            .heave_m_s2
            .check("tuning.strategy.road_and_cornering.heave_m_s2", 0.01, 20.0)?;
        tuning.rollover_guard.check([
            "tuning.strategy.road_and_cornering.rollover_guard.roll_rad",
            "tuning.strategy.road_and_cornering.rollover_guard.lateral_m_s2",
        ])
    }

    fn new(vehicle: &VehicleDescription, tuning: &Tuning) -> Self {
        Self {
            cornering: cornering::Parameters::new(&tuning.cornering),
            load_transfer: load_transfer::Parameters::new(vehicle),
            rough_2: tuning.rough_m_s2.squared(),
            heave_2: tuning.heave_m_s2.squared(),
            guard: tuning.rollover_guard,
        }
    }

    fn step(&self, state: &mut State, estimate: &Estimate, trusted: &Trusted) -> Demand {
        let rollover_guard = state.guard.step(&self.guard, estimate);
        let leans = (state.load_transfer).step(
            &self.load_transfer,
            trusted.load_to_right_m,
            estimate.roll_rad,
            state.corners,
        );
        let cornering = state.cornering.step(&self.cornering, estimate, leans);
        let corners = matches!(cornering, Cornering::Yes(_));
        state.corners = corners;
        if state.load_transfer.has_looked() {
            self.look_at_road(state, estimate);
        }
        // In a bend at once, whatever lean that traps: the road lets it out again. On a smooth road nothing was trapped, and what seems to
        // be is a sensor that is off, or gas that is warmer than it was.
        let (word, urgency) = if corners || rollover_guard {
            match cornering {
                Cornering::Yes(outer) if state.rough && !rollover_guard => (0, Urgency::Bend { outer }),
                _ => (0, Urgency::Emergency),
            }
        } else if !state.rough {
            (0, Urgency::Comfort)
        } else if cornering == Cornering::Suspected {
            (SPRING_BITS, Urgency::Comfort)
        } else if state.heaves {
            (SPRING_BITS | BYPASS2_BITS, Urgency::Comfort)
        } else {
            (SPRING_BITS | BYPASS_BITS, Urgency::Comfort)
        };
        Demand {
            valves: ValveCommand::from_word(word),
            urgency,
            handling: corners,
            rollover_guard,
        }
    }
}

impl RoadAndCornering {
    /// Whether the road is rough, and whether the body heaves on it, unless the vehicle corners. In each fourth tick: the busiest one has no
    /// time left, and a road changes slowly.
    fn look_at_road(&self, state: &mut State, estimate: &Estimate) {
        let heave_m_s2 = HEAVE.step(&mut state.heave_m_s2, estimate.vertical_acceleration_m_s2);
        HEAVE_MEMORY.step(&mut state.heave_mean_square, heave_m_s2 * heave_m_s2);
        if state.corners {
            return;
        }
        let (vertical_mean_square, lateral_mean_square) = (estimate.vertical_mean_square, estimate.lateral_mean_square);
        state.dwell = state.dwell.saturating_sub(1);
        let changes = if state.rough {
            vertical_mean_square < self.rough_2.end
        } else {
            vertical_mean_square > self.rough_2.begin && vertical_mean_square > lateral_mean_square
        };
        if changes && state.dwell == 0 {
            state.rough = !state.rough;
            state.dwell = ROAD_DWELL_LOOKS;
        }
        let bound = if state.heaves {
            self.heave_2.end
        } else {
            self.heave_2.begin
        };
        state.heaves = state.heave_mean_square > bound;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lateral::Bands;
    use oleo_interface::Side;

    fn opens(vertical_rms: f32, lateral_rms: f32) -> bool {
        let strategy = RoadAndCornering::new(&VehicleDescription::default(), &Tuning::default());
        let estimate = Estimate {
            vertical_mean_square: vertical_rms * vertical_rms,
            lateral_mean_square: lateral_rms * lateral_rms,
            ..Estimate::default()
        };
        let mut state = RoadAndCornering::INITIAL;
        let demands = [(); 2].map(|()| strategy.step(&mut state, &estimate, &Trusted::default()));
        demands.map(|demand| demand.valves != ValveCommand::SAFE) == [false, true]
    }

    #[test]
    fn a_road_is_rough_by_its_vertical_motion_unless_the_lateral_one_is_greater() {
        assert!(!opens(0.24, 0.0));
        assert!(opens(0.26, 0.0) && opens(0.26, 0.25) && opens(2.0, 1.9));
        // A bend that is not recognised shakes the body a little, too.
        assert!(!opens(0.26, 0.27) && !opens(2.0, 2.1));
    }

    #[test]
    fn a_rough_road_stays_rough_whatever_the_lateral_motion() {
        let strategy = RoadAndCornering::new(&VehicleDescription::default(), &Tuning::default());
        let mut state = RoadAndCornering::INITIAL;
        let mut rough = Estimate {
            vertical_mean_square: 0.3,
            ..Estimate::default()
        };
        for _ in 0..2 {
            strategy.step(&mut state, &rough, &Trusted::default());
        }
        rough.lateral_mean_square = 2.0;
        for _ in 0..2 * ticks(1_000) {
            let demand = strategy.step(&mut state, &rough, &Trusted::default());
            assert_ne!(demand.valves, ValveCommand::SAFE);
        }
    }

    /// A strategy that has known a road of this vertical RMS for ten seconds, m/s2, on which the body heaves with this RMS, m/s2, and what
    /// it then wants with a lateral acceleration and a lean, m/s2 and rad.
    fn on(vertical_rms: f32, heave_rms: f32, lateral_m_s2: f32, roll_rad: f32) -> Demand {
        let strategy = RoadAndCornering::new(&VehicleDescription::default(), &Tuning::default());
        let mut state = RoadAndCornering::INITIAL;
        let mut estimate = Estimate {
            vertical_mean_square: vertical_rms * vertical_rms,
            vertical_acceleration_m_s2: heave_rms,
            ..Estimate::default()
        };
        for _ in 0..2_000 {
            strategy.step(&mut state, &estimate, &Trusted::default());
        }
        estimate.roll_rad = roll_rad;
        estimate.lateral.acceleration_m_s2 = Bands {
            quick: lateral_m_s2,
            slow: lateral_m_s2,
        };
        strategy.step(&mut state, &estimate, &Trusted::default())
    }

    #[test]
    fn what_each_road_gets() {
        let soft = ValveCommand::SOFT;
        let firm = ValveCommand::from_word(SPRING_BITS | BYPASS2_BITS);
        for (vertical_rms, heave_rms, valves) in [
            (0.1, 0.1, ValveCommand::SAFE),
            (0.5, 0.5, soft),
            (0.5, 1.01, firm),
            (2.0, 0.99, soft),
        ] {
            let demand = on(vertical_rms, heave_rms, 0.0, 0.0);
            assert_eq!(
                (demand.valves, demand.urgency, demand.handling),
                (valves, Urgency::Comfort, false),
                "{vertical_rms} m/s2"
            );
            // A suspected one leaves the springs as they are, and the dampers are high.
            let demand = on(vertical_rms, heave_rms, 0.21, 0.0);
            let suspected = if vertical_rms > 0.25 {
                ValveCommand::from_word(SPRING_BITS)
            } else {
                ValveCommand::SAFE
            };
            assert_eq!(
                (demand.valves, demand.urgency, demand.handling),
                (suspected, Urgency::Comfort, false),
                "{vertical_rms} m/s2"
            );
            // A bend to the left closes all valves on every road, and lets out on a rough one what lean that traps.
            let in_bend = if vertical_rms > 0.25 {
                Urgency::Bend { outer: Side::Right }
            } else {
                Urgency::Emergency
            };
            let demand = on(vertical_rms, heave_rms, 3.5, 0.0);
            assert_eq!(
                (demand.valves, demand.urgency, demand.handling, demand.rollover_guard),
                (ValveCommand::SAFE, in_bend, true, false)
            );
            // And so does the guard, in the same bend.
            let demand = on(vertical_rms, heave_rms, 3.5, 0.1);
            assert_eq!(
                (demand.valves, demand.urgency, demand.rollover_guard),
                (ValveCommand::SAFE, Urgency::Emergency, true)
            );
        }
    }

    /// With hysteresis: rough from 0.25 and smooth below 0.06 m/s2; damper 1 high from a heave of 1.0 and low below 0.7 m/s2.
    #[test]
    fn a_road_stays_what_it_is_between_the_thresholds() {
        let strategy = RoadAndCornering::new(&VehicleDescription::default(), &Tuning::default());
        let mut state = RoadAndCornering::INITIAL;
        for (vertical_rms, heave_rms, rough, heaves) in [
            (0.2, 0.0, false, false),
            (0.3, 0.0, true, false),
            (0.07, 0.9, true, false),
            (2.0, 0.98, true, false),
            (1.0, 1.02, true, true),
            (1.0, 0.72, true, true),
            (1.0, 0.68, true, false),
            (0.05, 0.0, false, false),
        ] {
            let estimate = Estimate {
                vertical_mean_square: vertical_rms * vertical_rms,
                vertical_acceleration_m_s2: heave_rms,
                ..Estimate::default()
            };
            for _ in 0..=4 * ticks(1_000) {
                strategy.step(&mut state, &estimate, &Trusted::default());
            }
            assert_eq!(
                (state.rough, state.heaves),
                (rough, heaves),
                "{vertical_rms} m/s2, heave {heave_rms} m/s2"
            );
        }
    }

    /// RMS of the heave after ten seconds of a sine of the vertical acceleration, m/s2 and Hz, the mean of its last second.
    fn heave_rms(rms_m_s2: f32, frequency_hz: f32) -> f32 {
        let strategy = RoadAndCornering::new(&VehicleDescription::default(), &Tuning::default());
        let mut state = RoadAndCornering::INITIAL;
        let mut sum = 0.0;
        for tick in 0..2_000_u16 {
            let phase = 2.0 * core::f32::consts::PI * frequency_hz * f32::from(tick) * oleo_interface::tick::TICK_S_F32;
            let estimate = Estimate {
                vertical_acceleration_m_s2: core::f32::consts::SQRT_2 * rms_m_s2 * libm::sinf(phase),
                ..Estimate::default()
            };
            strategy.step(&mut state, &estimate, &Trusted::default());
            sum += if tick >= 1_800 { state.heave_mean_square } else { 0.0 };
        }
        libm::sqrtf(sum / 200.0)
    }

    #[test]
    fn the_constants_are_those_of_their_units() {
        let look_s = f32::from(load_transfer::TICKS) * oleo_interface::tick::TICK_S_F32;
        assert_eq!(HEAVE, LowPass::sampled(look_s, 0.1 / core::f32::consts::PI));
        assert_eq!(HEAVE_MEMORY, LowPass::sampled(look_s, 0.5));
    }

    /// With `p` the part that is taken over every `T`, the lag passes `p / |1 - (1 - p) exp(-2 pi i f T)|`.
    #[test]
    fn heave_is_what_is_below_five_hertz() {
        for (frequency_hz, passed) in [(1.0, 0.982), (5.0, 0.726), (12.0, 0.423)] {
            let found = heave_rms(2.0, frequency_hz) / 2.0;
            assert!((found / passed - 1.0).abs() < 0.04, "{frequency_hz} Hz: {found}");
        }
    }

    /// The running mean square forgets 63 % in its memory of half a second.
    #[test]
    fn heave_is_forgotten_in_half_a_second() {
        let strategy = RoadAndCornering::new(&VehicleDescription::default(), &Tuning::default());
        let mut state = State {
            heave_mean_square: 1.0,
            ..RoadAndCornering::INITIAL
        };
        for _ in 0..ticks(500) {
            strategy.step(&mut state, &Estimate::default(), &Trusted::default());
        }
        assert!((state.heave_mean_square - 0.368).abs() < 1e-3);
    }
}
