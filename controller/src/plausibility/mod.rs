//! Which readings may be used, and what stands in for those that may not.
//!
//! A wrong number is worse than none, since it opens valves. Each reading passes, in this order, the checks below; what fails is
//! replaced and its corner is reported *affected*, which the mode machine turns into permission.
//!
//! | check | what it sees | detected within (ticks) | file |
//! |---|---|---|---|
//! | range, NaN, flagged invalid | broken wire, dead sensor | 3 | `reading_check` |
//! | rate | spikes, bit errors before protection | 3 | `reading_check` |
//! | stuck | frozen value while the strut moves | 200 | `stuck` |
//! | vote | one pressure off by over 1 MPa | about 2 s / offset (MPa) | `vote` |
//! | oil balance | displacement against gas volumes, off by over 40 mm | 600 | `oil_balance` |
//! | link (from the node) | late or untrusted message | at once | `reading_check` |
//!
//! Substitutes: while a check makes up its mind, the last good value. After that: a displacement from the other three (the body is
//! rigid, the axles assumed unmoved); p1 from p2 or p3 (equal at rest); p2, p3 from p1; p4 keeps its last value, and the
//! mode machine forbids spring switching anyway.

mod limits;
mod oil_balance;
mod reading_check;
mod stuck;
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
pub use trusted::Trusted;
use verdict::Verdicts;
use vote::Vote;

/// Parameters of the checks that have any.
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
#[derive(Clone, Copy, Debug, Default)]
pub struct State {
    displacement: Corners<ReadingCheck>,
    pressure: Corners<StrutPressures<ReadingCheck>>,
    stuck: Stuck,
    vote: Corners<Vote>,
    oil: Corners<OilBalance>,
}

/// What the checks must know of the commands: p4 follows only through an open valve 3.
#[derive(Clone, Copy, Debug, Default)]
pub struct Context {
    /// Valve 3 has been open for long enough that p4 follows.
    pub spring_settled_open: Corners<bool>,
    /// The vehicle has not been in `Normal` yet: gas charges are being learnt.
    pub learning: bool,
}

impl State {
    /// One tick.
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
