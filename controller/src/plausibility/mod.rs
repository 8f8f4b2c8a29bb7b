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
//! While a check is undecided, the last good value is used. After that a displacement follows from the other three (the body is
//! rigid, and the axles are assumed not to move), p1 from p2 or p3 (which are equal at rest), and p2 and p3 from p1. p4 keeps
//! its last value; springs are not switched then, because the mode machine keeps them closed.

mod limits;
mod oil_balance;
mod oil_motion;
mod reading_check;
mod stuck;
mod trapped_oil;
mod trusted;
mod verdict;
mod vote;

use oleo_interface::{Corner, Corners, Gauge, PressurePoint, StrutPressures};

use crate::reading::Inputs;
use crate::sensor_message::SensorMessage;
use crate::vehicle::VehicleDescription;
use limits::{DISPLACEMENT, PRESSURE};
use oil_balance::OilBalance;
use reading_check::ReadingCheck;
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
/// let trusted = (0..12).map(|_| state.step(&parameters, &good, &context)).last().unwrap();
/// assert_eq!((trusted.invalid_readings, trusted.health.cause), (0, FaultCode::None));
/// // A broken cable is found in the third tick; the other three displacements replace the reading.
/// let trusted = (0..3).map(|_| state.step(&parameters, &cable, &context)).last().unwrap();
/// assert_eq!((trusted.invalid_readings, trusted.health.cause), (1, FaultCode::SensorRange));
/// assert!(trusted.health.affected[Corner::FrontLeft]);
/// assert_eq!(trusted.displacement_m[Corner::FrontLeft], 0.01);
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct State {
    displacement: Corners<ReadingCheck>,
    pressure: Corners<StrutPressures<ReadingCheck>>,
    stuck: Stuck,
    vote: Corners<Vote>,
    oil: Corners<OilBalance>,
    trapped: Corners<TrappedOil>,
}

/// What the checks must know of the valves and the mode. See [`State`] for an example.
#[derive(Clone, Copy, Debug, Default)]
pub struct Context {
    /// Whether valve 3 of each corner has been open for so long that p4 follows p1. Behind a closed valve it does not.
    pub spring_settled_open: Corners<bool>,
    /// Whether valve 3 of each corner was commanded closed in the last tick.
    pub spring_commanded_closed: Corners<bool>,
    /// Whether the gas charges are still being learnt, because the mode has not been normal yet.
    pub learning: bool,
}

impl State {
    /// One tick: returns all readings, measured or replaced, and their health.
    pub fn step(&mut self, parameters: &Parameters, inputs: &Inputs, context: &Context) -> Trusted {
        let mut trusted = Trusted::default();
        let mut verdicts = Corners::<Verdicts>::default();

        for corner in Corner::ALL {
            let lost = inputs
                .lost_messages
                .contains(SensorMessage::Displacement(corner.axle()));
            let check = &mut self.displacement[corner];
            verdicts[corner].displacement = check.step(inputs.displacement[corner], lost, &DISPLACEMENT);
            trusted.displacement_m[corner] = check.value();
        }
        for corner in Corner::ALL {
            let lost = inputs.lost_messages.contains(SensorMessage::Pressure(corner));
            for point in PressurePoint::ALL {
                let check = &mut self.pressure[corner][point];
                verdicts[corner].pressure[point] = check.step(inputs.pressure[corner][point], lost, &PRESSURE);
                trusted.pressure[corner][point] = Gauge(check.value());
            }
        }

        self.stuck.step(&trusted, context.spring_settled_open, &mut verdicts);
        for corner in Corner::ALL {
            let (pressure, verdict) = (&trusted.pressure[corner], &mut verdicts[corner]);
            self.vote[corner].step(&parameters.vote, pressure, context.spring_settled_open[corner], verdict);
            self.trapped[corner].step(pressure, context.spring_commanded_closed[corner], verdict);
            trusted.charge[corner] = self.oil[corner].step(
                &parameters.oil_balance,
                trusted.displacement_m[corner],
                pressure,
                context.learning,
                verdict,
            );
        }

        trusted.judge(&verdicts, inputs);
        // Nothing to replace is the usual tick, and a good reading is in range already.
        if trusted.invalid_readings > 0 {
            trusted.substitute(&verdicts);
        }
        trusted
    }
}
