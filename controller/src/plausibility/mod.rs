//! Plausibility checks: which readings may be used, and what replaces the others.
//!
//! A wrong number is worse than none, because it opens valves. Each reading passes the checks below in this order. One that fails
//! is replaced, and its corner is reported as *affected*; the mode machine then decides what the controller may still do.
//!
//! | check | what it sees | detected within (ticks) | file |
//! |---|---|---|---|
//! | range, not a number, flagged invalid | a broken wire, a dead sensor | 3 | `reading_check` |
//! | rate | spikes, bit errors before the message was protected | 3 | `reading_check` |
//! | stuck | a value that does not change while the strut moves | 200 | `stuck` |
//! | vote | a pressure that is off by over 1 MPa | about 2 s / offset (MPa) | `vote` |
//! | closed valve | a valve 3 that does not close | 260 in motion | `closed_valve` |
//! | closed valve | a valve 1 that does not close | 660 in motion | `closed_valve` |
//! | oil balance | a displacement that disagrees with the gas volumes by over 40 mm, a charge that drifts | 600 | `oil_balance` |
//! | oil motion | a displacement that does not move as the gas does | 400 in motion | `oil_motion` |
//! | link (from the node) | a late or untrusted message | at once | `reading_check` |
//!
//! What `reading_check` looks at is looked at in every tick. The comparisons from `stuck` on, which see means and spans, take the
//! corners in turns, one a tick (`turn`).
//!
//! While a check is undecided, the last good value is used. After that a displacement follows from the other three (the body is
//! rigid, and the axles are assumed not to move), p1 from p2 or p3 (which are equal at rest), and p2 and p3 from p1. p4 keeps
//! its last value; springs are not switched then, because the mode machine keeps them closed.

mod closed_valve;
mod limits;
mod oil_balance;
mod oil_motion;
mod reading_check;
mod span;
mod stuck;
mod trusted;
pub(crate) mod turn;
mod verdict;
mod vote;

use oleo_interface::{Corner, Corners, StrutValves, Valve};

use crate::reading::Inputs;
use crate::sensor_message::{MessageSet, SensorMessage};
use crate::vehicle::VehicleDescription;
use closed_valve::ClosedValves;
use oil_balance::OilBalance;
use reading_check::{StrutReadings, take_over};
use stuck::Stuck;
pub use trusted::Trusted;
use verdict::Verdicts;
use vote::Vote;

/// Parameters of the checks on the oil balance and of the vote; the other checks have constants only. See
/// [`State`] for an example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    oil_balance: oil_balance::Parameters,
    vote: vote::Parameters,
}

impl Parameters {
    /// From a description that has been checked.
    pub(crate) fn new(vehicle: &VehicleDescription) -> Self {
        Self {
            oil_balance: oil_balance::Parameters::new(vehicle),
            vote: vote::Parameters::default(),
        }
    }
}

/// The bit of a corner, where there is one for each.
const fn bit(corner: Corner) -> u8 {
    1 << corner.index()
}

/// The bits of all corners.
const ALL: u8 = (1 << Corner::ALL.len()) - 1;

/// Memory of all checks.
///
/// ```
/// use oleo_controller::plausibility::{Context, State};
/// use oleo_controller::{Configuration, Corner, Corners, FaultCode, Gauge, Inputs, Reading, StrutPressures};
/// let parameters = Configuration::defender110().plausibility;
/// let (mut state, context) = (State::default(), Context::default());
/// let good = Inputs::from_values(Corners::splat(0.01), Corners::splat(StrutPressures::splat(Gauge(2.0e6))));
/// let mut cable = good;
/// cable.displacement[Corner::FrontLeft] = Reading::INVALID;
///
/// // Readings are believed after 12 good samples.
/// let trusted = (0..12).map(|_| *state.step(&parameters, &good, &context)).last().unwrap();
/// assert_eq!((trusted.invalid_readings, trusted.health.cause), (0, FaultCode::None));
/// // A broken cable is found in the third tick; the other three displacements replace the reading.
/// let trusted = (0..3).map(|_| *state.step(&parameters, &cable, &context)).last().unwrap();
/// assert_eq!((trusted.invalid_readings, trusted.health.cause), (1, FaultCode::SensorRange));
/// assert!(trusted.health.affected[Corner::FrontLeft]);
/// assert_eq!(trusted.displacement_m[Corner::FrontLeft], 0.01);
/// ```
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State {
    /// The last good readings. Nothing is wrong in its `health`.
    measured: Trusted,
    /// The same in a tick in which something is wrong: what is wrong, and with what it is replaced.
    replaced: Trusted,
    /// The corner that is compared next.
    turn: Corner,
    /// Turns of the present window of `stuck` that are over at each corner before the one whose turn it is.
    window_turns: u8,
    /// Turns of each corner since the last look at the offset of p1.
    offset_turns: u8,
    /// Whether there was a tick.
    begun: bool,
    /// A bit for each corner of whose readings none has failed its own check or is not believed again yet.
    settled: u8,
    /// A bit for each corner at which a comparison has found something.
    disagreeing: u8,
    readings: Corners<StrutReadings>,
    comparisons: Corners<Comparisons>,
}

impl Default for State {
    fn default() -> Self {
        Self::INITIAL
    }
}

/// What the checks must know of the valves and the mode. See [`State`] for an example.
#[derive(Clone, Copy, Debug, Default)]
pub struct Context {
    /// Whether valve 3 of the corner whose turn it is ([`State::turn`]) has been open for so long that p4 follows p1. Behind a
    /// closed valve it does not.
    pub spring_settled_open: bool,
    /// Which valves of that corner were commanded open in the last tick.
    pub commanded_open: StrutValves<bool>,
    /// Whether the gas charges are still being learnt, because the mode has not been normal yet.
    pub learning: bool,
}

/// The comparisons of the readings of one strut with each other, and what they have found.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Comparisons {
    stuck: Stuck,
    vote: Vote,
    closed_valves: ClosedValves,
    oil: OilBalance,
    verdicts: Verdicts,
}

impl Comparisons {
    const INITIAL: Self = Self {
        stuck: Stuck::INITIAL,
        vote: Vote::INITIAL,
        closed_valves: ClosedValves::INITIAL,
        oil: OilBalance::INITIAL,
        verdicts: Verdicts::GOOD,
    };
}

impl State {
    /// No reading is believed.
    pub(crate) const INITIAL: Self = Self {
        measured: Trusted::INITIAL,
        replaced: Trusted::INITIAL,
        turn: Corner::FrontLeft,
        window_turns: 0,
        offset_turns: 0,
        begun: false,
        settled: 0,
        disagreeing: 0,
        readings: Corners::splat(StrutReadings::INITIAL),
        comparisons: Corners::splat(Comparisons::INITIAL),
    };

    /// The corner whose readings are compared with each other in the next tick.
    pub const fn turn(&self) -> Corner {
        self.turn
    }

    /// One tick: returns all readings, measured or replaced, and their health.
    pub fn step(&mut self, parameters: &Parameters, inputs: &Inputs, context: &Context) -> &Trusted {
        // Written out, because the compiler then knows every place in memory.
        let mut doubtful = ALL & !self.settled;
        self.take_over(Corner::FrontLeft, inputs, &mut doubtful);
        self.take_over(Corner::FrontRight, inputs, &mut doubtful);
        self.take_over(Corner::RearLeft, inputs, &mut doubtful);
        self.take_over(Corner::RearRight, inputs, &mut doubtful);
        if doubtful != 0 {
            self.doubt(doubtful, inputs);
        }
        self.compare(parameters, context);
        // In most ticks nothing is wrong.
        let right = self.settled == ALL && self.disagreeing == 0 && inputs.lost_messages == MessageSet::EMPTY;
        if right && !inputs.foreign_sender && !inputs.solenoid_failed {
            return &self.measured;
        }
        self.replace(inputs)
    }

    /// Takes over the readings of a corner unless it is doubtful; it becomes so if one of them may be wrong.
    #[inline(always)]
    fn take_over(&mut self, corner: Corner, inputs: &Inputs, doubtful: &mut u8) {
        let displacement = (inputs.displacement[corner], &mut self.measured.displacement_m[corner]);
        let pressure = (&inputs.pressure[corner], &mut self.measured.pressure[corner]);
        if *doubtful & bit(corner) == 0 && !take_over(displacement, pressure) {
            *doubtful |= bit(corner);
        }
    }

    /// The first tick: no reading is believed.
    #[cold]
    #[inline(never)]
    fn begin(&mut self) {
        self.begun = true;
        for (_, readings) in self.readings.iter_mut() {
            readings.begin();
        }
    }

    /// Checks each reading of the doubtful corners by itself.
    #[inline(never)]
    fn doubt(&mut self, doubtful: u8, inputs: &Inputs) {
        if !self.begun {
            self.begin();
        }
        for corner in Corner::ALL.into_iter().filter(|corner| doubtful & bit(*corner) != 0) {
            let lost = |message| inputs.lost_messages.contains(message);
            let lost = (
                lost(SensorMessage::Displacement(corner.axle())),
                lost(SensorMessage::Pressure(corner)),
            );
            let displacement = (inputs.displacement[corner], &mut self.measured.displacement_m[corner]);
            let pressure = (&inputs.pressure[corner], &mut self.measured.pressure[corner]);
            if self.readings[corner].doubt(displacement, pressure, lost) {
                self.settled |= bit(corner);
            } else {
                self.settled &= !bit(corner);
            }
        }
    }

    /// The end of a tick in which something is or may be wrong.
    #[inline(never)]
    fn replace(&mut self, inputs: &Inputs) -> &Trusted {
        let checks = self.readings.each_ref().zip(self.comparisons.each_ref());
        let verdicts = checks.map(|(readings, comparisons)| readings.verdicts().or(comparisons.verdicts));
        self.replaced.judge(&verdicts, inputs);
        self.replaced.charge = self.measured.charge;
        self.replaced.substitute(&self.measured, &verdicts);
        &self.replaced
    }

    /// Compares the readings of the corner whose turn it is.
    fn compare(&mut self, parameters: &Parameters, context: &Context) {
        let corner = self.turn;
        // Only the first turn of a window needs the number, and the windows of all corners have ended then.
        let moving = || {
            (self.comparisons.values())
                .filter(|corner| corner.stuck.has_moved())
                .count()
        };
        let moving = (self.window_turns == 0).then(moving);
        let comparisons = &mut self.comparisons[corner];
        let (x, pressure) = (self.measured.displacement_m[corner], &self.measured.pressure[corner]);
        let p4_follows = context.spring_settled_open;
        let by_itself = self.readings[corner].verdicts();
        let mut verdict = by_itself;
        if let Some(moving) = moving {
            comparisons.stuck.begin_window(moving);
        }
        comparisons.stuck.step(x, pressure, p4_follows, &mut verdict);
        if self.window_turns == stuck::WINDOW_TURNS - 1 {
            comparisons.stuck.end_window();
        }
        comparisons
            .vote
            .step(&parameters.vote, pressure, p4_follows, &mut verdict);
        if self.offset_turns == 0 {
            self.measured.p1_offset_pa[corner] = comparisons.vote.p1_offset_pa(&parameters.vote);
        }
        let (of_bypass, open) = (self.offset_turns % 2 == 1, context.commanded_open);
        (comparisons.closed_valves).step(of_bypass, pressure, open, &mut verdict);
        self.measured.charge[corner] = (comparisons.oil).step(
            &parameters.oil_balance,
            x,
            pressure,
            context.learning,
            context.commanded_open[Valve::Spring],
            &mut verdict,
        );
        if self.disagreeing & bit(corner) != 0 || verdict != Verdicts::GOOD {
            // What was said of a reading that is wrong by itself now holds until it can be compared again.
            comparisons.verdicts = by_itself.select(comparisons.verdicts, verdict);
            self.disagreeing &= !bit(corner);
            if comparisons.verdicts != Verdicts::GOOD {
                self.disagreeing |= bit(corner);
            }
        }
        self.turn = turn::next(corner);
        if self.turn == Corner::FrontLeft {
            self.window_turns = (self.window_turns + 1) % stuck::WINDOW_TURNS;
            self.offset_turns = (self.offset_turns + 1) % vote::OFFSET_TURNS;
            let carried_m = |corner| self.comparisons[corner].oil.carried_m();
            let right_m = carried_m(Corner::FrontRight) + carried_m(Corner::RearRight);
            let left_m = carried_m(Corner::FrontLeft) + carried_m(Corner::RearLeft);
            self.measured.load_to_right_m = 0.5 * (right_m - left_m);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::configuration::Configuration;
    use crate::failsafe::FaultCode;
    use crate::reading::Reading;
    use oleo_interface::{Gauge, PressurePoint, StrutPressures};

    const GOOD: (FaultCode, [bool; 4]) = (FaultCode::None, [false; 4]);

    /// A vehicle whose struts are shaken together by 10 mm at 2 Hz; p1 to p4 follow by 10 MPa/m.
    fn shaken(tick: u32) -> Inputs {
        let swing = libm::sinf(core::f32::consts::TAU * 2.0 * 0.005 * tick as f32);
        let pressure = StrutPressures::splat(Gauge(2.0e6 + 1.0e5 * swing));
        Inputs::from_values(Corners::splat(0.01 * swing), Corners::splat(pressure))
    }

    fn parked(_: u32) -> Inputs {
        shaken(0)
    }

    struct Vehicle {
        state: State,
        tick: u32,
        inputs: fn(u32) -> Inputs,
    }

    impl Vehicle {
        fn settled(inputs: fn(u32) -> Inputs) -> Self {
            let (state, tick) = (State::default(), 0);
            let mut vehicle = Self { state, tick, inputs };
            assert_eq!(vehicle.run(600, |_| {}), GOOD);
            vehicle
        }

        /// Ticks in which `spoil` changes the inputs; returns cause and corners of the last one.
        fn run(&mut self, ticks: u32, spoil: impl Fn(&mut Inputs)) -> (FaultCode, [bool; 4]) {
            let parameters = Configuration::defender110().plausibility;
            let context = Context {
                spring_settled_open: true,
                commanded_open: StrutValves::new(true, true, true),
                learning: true,
            };
            let mut health = crate::failsafe::Health::default();
            for _ in 0..ticks {
                let mut inputs = (self.inputs)(self.tick);
                spoil(&mut inputs);
                health = self.state.step(&parameters, &inputs, &context).health;
                self.tick += 1;
            }
            (health.cause, health.affected.into_array())
        }
    }

    fn only(corner: Corner) -> [bool; 4] {
        Corners::from_fn(|other| other == corner).into_array()
    }

    fn offset(reading: &mut Reading, offset: f32) {
        *reading = Reading::new(reading.value().unwrap_or(0.0) + offset);
    }

    /// The body leans to the right by 8 mm at both axles, or at the front only, on the first gas of 0.1 l alone.
    fn leaning(inputs: &mut Inputs, axles: &[oleo_interface::Axle]) {
        for corner in Corner::ALL.into_iter().filter(|corner| axles.contains(&corner.axle())) {
            let right = corner.side() == oleo_interface::Side::Right;
            let x = if right { 0.008 } else { -0.008 };
            let absolute_pa = 2.101_325e6 * 1.0e-4 / (1.0e-4 - 1.963_495_4e-3 * x);
            let p = Reading::new(absolute_pa - 101_325.0);
            let p4 = inputs.pressure[corner].p4;
            inputs.displacement[corner] = Reading::new(x);
            inputs.pressure[corner] = StrutPressures {
                p4,
                ..StrutPressures::splat(p)
            };
        }
    }

    #[test]
    fn what_the_right_carries_more_than_the_left_is_the_mean_of_the_axles() {
        use oleo_interface::Axle;
        for (axles, more_m) in [
            ([Axle::Front, Axle::Rear].as_slice(), 0.016),
            (&[Axle::Front], 0.008),
            (&[Axle::Rear], 0.008),
            (&[], 0.0),
        ] {
            let mut vehicle = Vehicle::settled(parked);
            assert_eq!(vehicle.run(20, |inputs| leaning(inputs, axles)), GOOD);
            let found_m = vehicle.state.measured.load_to_right_m;
            assert!((found_m - more_m).abs() < 1e-4, "{axles:?}: {found_m} m");
        }
    }

    /// What is blamed at a strut whose valves have been closed for some time, of those that share the readings of one.
    fn blamed(ticks: u32, inputs: impl Fn(u32) -> Inputs) -> Verdicts {
        let parameters = Configuration::defender110().plausibility;
        let context = Context::default();
        let mut state = Vehicle::settled(parked).state;
        for tick in 0..ticks {
            state.step(&parameters, &inputs(tick), &context);
        }
        state.comparisons[Corner::RearLeft].verdicts
    }

    /// Oil comes to p2 and goes within 80 ms without a drop, which only looks at every second turn of the corner can see. p4 stays.
    #[test]
    fn valves_1_and_3_are_looked_at_in_every_second_turn_each() {
        let comes_and_goes = |tick: u32| {
            let pressure = 2.0e6 + if (tick / 8).is_multiple_of(2) { 0.22e6 } else { -0.22e6 };
            let pressure = StrutPressures {
                p3: Gauge(2.0e6),
                p4: Gauge(2.0e6),
                ..StrutPressures::splat(Gauge(pressure))
            };
            Inputs::from_values(Corners::splat(0.0), Corners::splat(pressure))
        };
        assert!(!blamed(1_000, comes_and_goes).is_good(verdict::Place::P2));
        // The same at p4, and none at p2.
        let behind_valve_3 = |tick: u32| {
            let mut inputs = comes_and_goes(tick);
            for pressure in inputs.pressure.each_mut().into_array() {
                (pressure.p4, pressure.p3) = (pressure.p1, pressure.p1);
                (pressure.p1, pressure.p2) = (Reading::new(2.0e6), Reading::new(2.0e6));
            }
            inputs
        };
        assert!(!blamed(1_000, behind_valve_3).is_good(verdict::Place::P4));
    }

    /// Behind the vote's lag of 1 s the mean over 2 s has come so far after 4 s; 0.1 MPa of it is not taken off.
    #[test]
    fn the_offset_of_p1_is_taken_off_as_slowly_as_it_is_meant_to_be() {
        let mut vehicle = Vehicle::settled(parked);
        let corner = Corner::RearLeft;
        vehicle.run(800, |inputs| offset(&mut inputs.pressure[corner].p1, 0.5e6));
        let come = 1.0 - (2.0 * libm::expf(-4.0 / 2.0) - libm::expf(-4.0 / 1.0));
        let found_pa = vehicle.state.measured.p1_offset_pa[corner];
        assert!((found_pa - (0.5e6 * come - 0.1e6)).abs() < 0.02e6, "{found_pa} Pa");
    }

    #[test]
    fn no_reading_is_believed_before_its_twelfth_good_sample() {
        let mut vehicle = Vehicle {
            state: State::default(),
            tick: 0,
            inputs: parked,
        };
        for _ in 1..12 {
            assert_eq!(vehicle.run(1, |_| {}), (FaultCode::SensorRange, [true; 4]));
        }
        assert_eq!(vehicle.run(1, |_| {}), GOOD);
    }

    #[test]
    fn a_missing_reading_concerns_its_corner() {
        for corner in Corner::ALL {
            let mut vehicle = Vehicle::settled(parked);
            let missing = |inputs: &mut Inputs| inputs.displacement[corner] = Reading::INVALID;
            assert_eq!(vehicle.run(2, missing), GOOD);
            assert_eq!(vehicle.run(1, missing), (FaultCode::SensorRange, only(corner)));
            assert_eq!(vehicle.run(11, |_| {}), (FaultCode::SensorRange, only(corner)));
            assert_eq!(vehicle.run(1, |_| {}), GOOD);
        }
    }

    #[test]
    fn bus_and_solenoids_are_faults_while_all_readings_are_good() {
        let mut vehicle = Vehicle::settled(parked);
        let silent = |inputs: &mut Inputs| inputs.lost_messages = MessageSet::ALL;
        assert_eq!(vehicle.run(1, silent), (FaultCode::BusSilent, [false; 4]));
        assert_eq!(vehicle.run(1, |_| {}), GOOD);
        assert_eq!(
            vehicle.run(1, |inputs| inputs.foreign_sender = true),
            (FaultCode::ForeignSender, [true; 4])
        );
        assert_eq!(vehicle.run(1, |_| {}), GOOD);
        assert_eq!(
            vehicle.run(1, |inputs| inputs.solenoid_failed = true),
            (FaultCode::Solenoid, [false; 4])
        );
        assert_eq!(vehicle.run(1, |_| {}), GOOD);
    }

    /// What a comparison says of one corner comes and goes without the others.
    #[test]
    fn corners_are_compared_each_for_itself() {
        for first in Corner::ALL {
            for second in Corner::ALL.into_iter().filter(|second| *second != first) {
                let mut vehicle = Vehicle::settled(parked);
                let wrong = |corner: Corner| move |inputs: &mut Inputs| offset(&mut inputs.pressure[corner].p2, 2.0e6);
                assert_eq!(vehicle.run(300, wrong(first)), (FaultCode::SensorVote, only(first)));
                let both = |inputs: &mut Inputs| [first, second].into_iter().for_each(|corner| wrong(corner)(inputs));
                let two = Corners::from_fn(|corner| corner == first || corner == second).into_array();
                assert_eq!(vehicle.run(300, both), (FaultCode::SensorVote, two));
                assert_eq!(vehicle.run(600, wrong(second)), (FaultCode::SensorVote, only(second)));
                assert_eq!(vehicle.run(600, |_| {}), GOOD);
            }
        }
    }

    #[test]
    fn a_stuck_pressure_is_found_within_200_ticks_and_forgiven_when_it_moves() {
        for corner in Corner::ALL {
            for point in [PressurePoint::P1, PressurePoint::P2, PressurePoint::P3] {
                let mut vehicle = Vehicle::settled(shaken);
                let stuck = |inputs: &mut Inputs| inputs.pressure[corner][point] = Reading::new(2.0e6);
                let found = (1..=300).find(|_| vehicle.run(1, stuck).0 == FaultCode::SensorStuck);
                assert!(found.is_some_and(|n| n <= 200), "{corner:?} {point:?}: {found:?}");
                assert_eq!(vehicle.run(400, stuck), (FaultCode::SensorStuck, only(corner)));
                assert_eq!(vehicle.run(400, |_| {}), GOOD);
            }
        }
    }

    /// Its own p1 moves by 0.2 MPa, which is not enough alone: two other struts must move.
    #[test]
    fn a_stuck_displacement_is_found_by_the_other_struts() {
        for corner in Corner::ALL {
            let mut vehicle = Vehicle::settled(shaken);
            let stuck = |inputs: &mut Inputs| inputs.displacement[corner] = Reading::new(0.0);
            let found = (1..=300).find(|_| vehicle.run(1, stuck).0 == FaultCode::SensorStuck);
            assert!(found.is_some_and(|n| n <= 200), "{corner:?}: {found:?}");
            assert_eq!(vehicle.run(400, |_| {}), GOOD);
        }
    }

    /// The context is about the corner whose turn it is.
    #[test]
    fn turns_go_round() {
        let mut vehicle = Vehicle::settled(parked);
        let turns: [Corner; 8] = core::array::from_fn(|_| {
            let turn = vehicle.state.turn();
            vehicle.run(1, |_| {});
            turn
        });
        let first = turns[0].index();
        for (n, turn) in turns.into_iter().enumerate() {
            assert_eq!(turn.index(), (first + n) % 4);
        }
    }
}
