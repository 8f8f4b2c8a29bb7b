//! What goes wrong, where and when.
//!
//! Faults of messages (and of whole nodes, which others know by their messages only) become [`Injection`]s of the bus; faults of sensors and
//! solenoids happen inside the plant. All of them live on the plant's side, so that a run in one process and one in two
//! suffer the same.

use oleo_controller::valves::{CORNERS, VALVES};

use crate::bus::{Disturbance, Injection, Target};
use crate::sync::Role;

/// Names of the corners, in order.
pub const CORNER_NAMES: [&str; CORNERS] = ["front-left", "front-right", "rear-left", "rear-right"];

/// Names of a strut's sensors, in order.
pub const SENSOR_NAMES: [&str; 5] = ["displacement", "p1", "p2", "p3", "p4"];

/// One sensor of one strut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SensorPlace {
    /// 0 front left to 3 rear right.
    pub corner: usize,
    /// 0 displacement, 1 to 4 pressures.
    pub sensor: usize,
}

impl SensorPlace {
    /// From `front-left.p1`.
    pub fn from_name(text: &str) -> Option<Self> {
        let (corner, sensor) = text.split_once('.')?;
        Some(Self {
            corner: CORNER_NAMES.iter().position(|name| *name == corner)?,
            sensor: SENSOR_NAMES.iter().position(|name| *name == sensor)?,
        })
    }
}

/// One valve of one strut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ValvePlace {
    /// 0 front left to 3 rear right.
    pub corner: usize,
    /// 0 and 1 bypass valves, 2 spring valve.
    pub valve: usize,
}

impl ValvePlace {
    /// From `front-left.3`; valves are counted 1 to 3 as in the report.
    pub fn from_name(text: &str) -> Option<Self> {
        let (corner, valve) = text.split_once('.')?;
        let corner = CORNER_NAMES.iter().position(|name| *name == corner)?;
        let number: usize = valve.parse().ok()?;
        (1..=VALVES).contains(&number).then(|| Self {
            corner,
            valve: number - 1,
        })
    }
}

/// What a faulty sensor says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SensorFault {
    /// What it said when the fault began.
    Stuck,
    /// Not a number: the node sends its error code.
    NotANumber,
    /// This value, whatever the truth; SI.
    Value(f32),
    /// The truth and this much more; SI.
    Offset(f32),
}

/// Kind and place of a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaultKind {
    /// Some frames are disturbed.
    Message {
        /// Which.
        target: Target,
        /// How many of them, 0 to 1.
        probability: f64,
        /// How.
        disturbance: Disturbance,
    },
    /// A node is gone: nothing of it is heard, and a plant without its node does not drive its valves.
    NodeKilled(Role),
    /// A sensor lies.
    Sensor {
        /// Which.
        place: SensorPlace,
        /// How.
        fault: SensorFault,
    },
    /// A valve no longer follows its signal.
    SolenoidStuck {
        /// Which.
        place: ValvePlace,
        /// Where it stays.
        open: bool,
    },
}

/// A fault during a stretch of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// What and where.
    pub kind: FaultKind,
    /// First tick concerned.
    pub from_tick: u32,
    /// First tick no longer concerned.
    pub until_tick: u32,
}

impl Fault {
    /// Whether the fault is present in a tick.
    pub fn is_active(&self, tick: u32) -> bool {
        (self.from_tick..self.until_tick).contains(&tick)
    }

    /// The fault as something that happens to frames, if it is.
    pub fn injection(&self) -> Option<Injection> {
        let (target, probability, disturbance) = match self.kind {
            FaultKind::Message {
                target,
                probability,
                disturbance,
            } => (target, probability, disturbance),
            FaultKind::NodeKilled(Role::Plant) => (Target::All, 1.0, Disturbance::Drop),
            FaultKind::NodeKilled(Role::Controller) => (Target::Controller, 1.0, Disturbance::Drop),
            FaultKind::Sensor { .. } | FaultKind::SolenoidStuck { .. } => return None,
        };
        let (from_tick, until_tick) = (self.from_tick, self.until_tick);
        Some(Injection {
            target,
            from_tick,
            until_tick,
            probability,
            disturbance,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_have_names() {
        assert_eq!(
            SensorPlace::from_name("rear-right.p4"),
            Some(SensorPlace { corner: 3, sensor: 4 })
        );
        assert_eq!(
            SensorPlace::from_name("front-left.displacement"),
            Some(SensorPlace { corner: 0, sensor: 0 })
        );
        assert_eq!(
            ValvePlace::from_name("rear-left.3"),
            Some(ValvePlace { corner: 2, valve: 2 })
        );
        for nonsense in ["", "front-left", "front-left.p5", "middle.p1", "front-left.p1.p1"] {
            assert_eq!(SensorPlace::from_name(nonsense), None);
        }
        for nonsense in ["front-left.0", "front-left.4", "front-left.-1", "3"] {
            assert_eq!(ValvePlace::from_name(nonsense), None);
        }
    }

    #[test]
    fn a_killed_node_is_silence_on_the_bus() {
        let killed = |role| {
            Fault {
                kind: FaultKind::NodeKilled(role),
                from_tick: 5,
                until_tick: 9,
            }
            .injection()
            .unwrap()
        };
        assert_eq!(killed(Role::Plant).target, Target::All);
        assert_eq!(killed(Role::Controller).target, Target::Controller);
        assert_eq!(killed(Role::Plant).disturbance, Disturbance::Drop);
    }
}
