//! Faults that a scenario injects: kind, place and time.
//!
//! Faults of messages (and of whole nodes, which others know by their messages only) become [`Injection`]s of the bus; faults of sensors and
//! solenoids happen inside the plant. All of them live on the plant's side, so that a run in one process and one in two
//! suffer the same. The one exception is a controller that restarts: that happens in the controller's node, which for this needs the
//! scenario too.

use oleo_interface::{Corner, PressurePoint, Valve};

use crate::bus::{Disturbance, Injection, Target};
use crate::sync::Role;

/// Names of the corners, in order.
pub const CORNER_NAMES: [&str; 4] = [
    Corner::FrontLeft.name(),
    Corner::FrontRight.name(),
    Corner::RearLeft.name(),
    Corner::RearRight.name(),
];

/// Names of a strut's sensors, in order.
pub const SENSOR_NAMES: [&str; 5] = ["displacement", "p1", "p2", "p3", "p4"];

/// A sensor of a strut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sensor {
    /// The displacement of the strut, m.
    Displacement,
    /// One of the four pressures.
    Pressure(PressurePoint),
}

impl Sensor {
    /// From `displacement` or `p1` to `p4`.
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "displacement" => Some(Self::Displacement),
            point => Some(Self::Pressure(point.parse().ok()?)),
        }
    }
}

/// One sensor of one strut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SensorPlace {
    /// The corner of the vehicle that the sensor belongs to.
    pub corner: Corner,
    /// The sensor at that corner.
    pub sensor: Sensor,
}

impl SensorPlace {
    /// The sensor with this name, such as `front-left.p1`.
    pub fn from_name(text: &str) -> Option<Self> {
        let (corner, sensor) = text.split_once('.')?;
        Some(Self {
            corner: Corner::named(corner)?,
            sensor: Sensor::from_name(sensor)?,
        })
    }
}

/// One valve of one strut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ValvePlace {
    /// The corner of the vehicle that the valve belongs to.
    pub corner: Corner,
    /// The valve at that corner.
    pub valve: Valve,
}

impl ValvePlace {
    /// From `front-left.3`; valves are counted 1 to 3 as in the report.
    pub fn from_name(text: &str) -> Option<Self> {
        let (corner, valve) = text.split_once('.')?;
        Some(Self {
            corner: Corner::named(corner)?,
            valve: Valve::from_number(valve.parse().ok()?)?,
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
    /// The truth times this factor.
    Gain(f32),
    /// The truth and normally distributed noise of this standard deviation; SI.
    Noise(f32),
    /// The truth and an offset that grows by this much a second; SI.
    Drift(f32),
}

/// Kind and place of a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaultKind {
    /// Some frames are disturbed.
    Message {
        /// The messages that are affected.
        target: Target,
        /// How many of them, 0 to 1.
        probability: f64,
        /// What happens to them.
        disturbance: Disturbance,
    },
    /// A node is gone: nothing of it is heard, and a plant without its node does not drive its valves.
    NodeKilled(Role),
    /// The controller is silent for a while and then starts anew, as after a reset: it knows nothing of what was before.
    ControllerRestarted,
    /// A sensor reports a wrong value.
    Sensor {
        /// The sensor that is affected.
        place: SensorPlace,
        /// What it reports instead of the true value.
        fault: SensorFault,
    },
    /// Two sensors of one quantity have changed their plugs.
    SensorsSwapped {
        /// One of them.
        one: SensorPlace,
        /// The other one.
        other: SensorPlace,
    },
    /// A valve no longer follows its signal.
    SolenoidStuck {
        /// The valve that is affected.
        place: ValvePlace,
        /// Whether it is stuck open; otherwise it is stuck closed.
        open: bool,
    },
}

/// A fault during a stretch of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// What happens, and to which messages, sensor, valve or node.
    pub kind: FaultKind,
    /// First tick in which the fault acts.
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
            FaultKind::ControllerRestarted
            | FaultKind::Sensor { .. }
            | FaultKind::SensorsSwapped { .. }
            | FaultKind::SolenoidStuck { .. } => return None,
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
            Some(SensorPlace {
                corner: Corner::RearRight,
                sensor: Sensor::Pressure(PressurePoint::P4),
            })
        );
        assert_eq!(
            SensorPlace::from_name("front-left.displacement"),
            Some(SensorPlace {
                corner: Corner::FrontLeft,
                sensor: Sensor::Displacement,
            })
        );
        assert_eq!(
            ValvePlace::from_name("rear-left.3"),
            Some(ValvePlace {
                corner: Corner::RearLeft,
                valve: Valve::Spring,
            })
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
