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
//! | trapped oil | oil that moves through a closed valve 3 | 260 in motion | `trapped_oil` |
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

mod limits;
mod oil_balance;
mod oil_motion;
mod reading_check;
mod span;
mod stuck;
mod trapped_oil;
mod trusted;
mod turn;
mod verdict;
mod vote;

use oleo_interface::{Corner, Corners};

use crate::reading::Inputs;
use crate::sensor_message::{MessageSet, SensorMessage};
use crate::vehicle::VehicleDescription;
use oil_balance::OilBalance;
use reading_check::StrutReadings;
use stuck::Stuck;
use trapped_oil::TrappedOil;
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
pub struct State {
    readings: Corners<StrutReadings>,
    comparisons: Corners<Comparisons>,
    /// The corner that is compared next.
    turn: Corner,
    /// Turns of the present window of `stuck` that are over at each corner before the one whose turn it is.
    window_turns: u8,
    /// A bit for each corner at which a comparison has found something.
    disagreeing: u8,
    /// The last good readings. Nothing is wrong in its `health`.
    measured: Trusted,
    /// The same in a tick in which something is wrong: what is wrong, and with what it is replaced.
    replaced: Trusted,
}

impl Default for State {
    fn default() -> Self {
        Self {
            readings: Corners::default(),
            comparisons: Corners::default(),
            turn: Corner::FrontLeft,
            window_turns: 0,
            disagreeing: 0,
            measured: Trusted::default(),
            replaced: Trusted::default(),
        }
    }
}

/// What the checks must know of the valves and the mode. See [`State`] for an example.
#[derive(Clone, Copy, Debug, Default)]
pub struct Context {
    /// Whether valve 3 of the corner whose turn it is ([`State::turn`]) has been open for so long that p4 follows p1. Behind a
    /// closed valve it does not.
    pub spring_settled_open: bool,
    /// Whether valve 3 of that corner was commanded closed in the last tick.
    pub spring_commanded_closed: bool,
    /// Whether the gas charges are still being learnt, because the mode has not been normal yet.
    pub learning: bool,
}

/// The comparisons of the readings of one strut with each other, and what they have found.
#[derive(Clone, Copy, Debug, Default)]
struct Comparisons {
    stuck: Stuck,
    vote: Vote,
    trapped: TrappedOil,
    oil: OilBalance,
    verdicts: Verdicts,
}

impl State {
    /// The corner whose readings are compared with each other in the next tick.
    pub const fn turn(&self) -> Corner {
        self.turn
    }

    /// One tick: returns all readings, measured or replaced, and their health.
    pub fn step(&mut self, parameters: &Parameters, inputs: &Inputs, context: &Context) -> &Trusted {
        // Written out, because the compiler then knows every place in memory.
        let calm = self.check(Corner::FrontLeft, inputs)
            & self.check(Corner::FrontRight, inputs)
            & self.check(Corner::RearLeft, inputs)
            & self.check(Corner::RearRight, inputs);
        self.compare(parameters, context);
        // In most ticks nothing is wrong.
        let right = calm && self.disagreeing == 0 && inputs.lost_messages == MessageSet::EMPTY;
        if right && !inputs.foreign_sender && !inputs.solenoid_failed {
            return &self.measured;
        }
        self.replace(inputs)
    }

    /// Checks the readings of a corner by themselves; returns whether nothing was wrong with any of them lately.
    #[inline(always)]
    fn check(&mut self, corner: Corner, inputs: &Inputs) -> bool {
        let lost = || {
            let lost = |message| inputs.lost_messages.contains(message);
            let displacement = lost(SensorMessage::Displacement(corner.axle()));
            (displacement, lost(SensorMessage::Pressure(corner)))
        };
        let displacement = (inputs.displacement[corner], &mut self.measured.displacement_m[corner]);
        let pressure = (&inputs.pressure[corner], &mut self.measured.pressure[corner]);
        self.readings[corner].step(displacement, pressure, lost)
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
        comparisons
            .trapped
            .step(pressure, context.spring_commanded_closed, &mut verdict);
        self.measured.charge[corner] =
            (comparisons.oil).step(&parameters.oil_balance, x, pressure, context.learning, &mut verdict);
        let bit = 1 << corner.index();
        if self.disagreeing & bit != 0 || verdict != Verdicts::GOOD {
            // What was said of a reading that is wrong by itself now holds until it can be compared again.
            comparisons.verdicts = by_itself.select(comparisons.verdicts, verdict);
            self.disagreeing &= !bit;
            if comparisons.verdicts != Verdicts::GOOD {
                self.disagreeing |= bit;
            }
        }
        self.turn = turn::next(corner);
        if self.turn == Corner::FrontLeft {
            self.window_turns = (self.window_turns + 1) % stuck::WINDOW_TURNS;
        }
    }
}
