//! `[[fault]]` tables of a scenario file, converted into a [`Fault`].

use oleo_controller::can::MESSAGES;
use oleo_interface::tick::TICK_S;
use oleo_plant_sim::model_file::names::suggestion;
use oleo_plant_sim::model_file::{Checked, InvalidValue, Limit, Range};
use serde::Deserialize;
use strum::IntoStaticStr;

use super::fault::{CORNER_NAMES, Fault, FaultKind, SENSOR_NAMES, Sensor, SensorFault, SensorPlace, ValvePlace};
use crate::bus::{Disturbance, Target};
use crate::sync::Role;

/// Longest run, s: an hour, so that a slip of a zero does not fill the memory.
pub const LONGEST_S: f64 = 3600.0;

/// Kind of a fault as it stands in the file.
#[derive(Clone, Copy, Deserialize, IntoStaticStr)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
enum Kind {
    Silence,
    Drop,
    Corrupt,
    Delay,
    Duplicate,
    Replay,
    Masquerade,
    NodeKilled,
    NodeRestarted,
    SensorStuck,
    SensorNan,
    SensorOutOfRange,
    SensorOffset,
    SensorGain,
    SensorNoise,
    SensorDrift,
    SensorSwap,
    SolenoidStuck,
}

/// Node that is killed.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Node {
    Plant,
    Controller,
}

/// Position in which a solenoid is stuck.
#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Position {
    Open,
    Closed,
}

/// A fault as it stands in the file, with all keys that any kind has. Which of them go with which kind is checked when
/// the fault is made.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FaultEntry {
    kind: Kind,
    at_s: f64,
    for_s: Option<f64>,
    message: Option<String>,
    probability: Option<f64>,
    bits: Option<u32>,
    ticks: Option<u32>,
    sensor: Option<String>,
    other: Option<String>,
    value: Option<f64>,
    valve: Option<String>,
    position: Option<Position>,
    node: Option<Node>,
}

impl Checked for FaultEntry {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("at_s", Range::FromTo(0.0, LONGEST_S), "s", |entry| entry.at_s),
        Limit::optional("for_s", Range::FromTo(TICK_S, LONGEST_S), "s", |entry| entry.for_s),
        Limit::optional("probability", Range::FromTo(0.0, 1.0), "", |entry| entry.probability),
        Limit::optional("bits", Range::FromTo(1.0, 64.0), "", |entry| entry.bits.map(f64::from)),
        Limit::optional("ticks", Range::FromTo(1.0, 1000.0), "", |entry| {
            entry.ticks.map(f64::from)
        }),
        Limit::optional("value", Range::FromTo(-1e12, 1e12), "", |entry| entry.value),
    ];
}

impl FaultEntry {
    /// The fault in a run of so many ticks.
    pub fn fault(mut self, run_ticks: u32) -> Result<Fault, InvalidValue> {
        let from_tick = (self.at_s / TICK_S).round() as u32;
        if from_tick >= run_ticks {
            let end_s = f64::from(run_ticks) * TICK_S;
            let what = format!(
                "is {}: the run ends at {end_s} s, so the fault must begin before",
                self.at_s
            );
            return Err(InvalidValue::new("at_s", what));
        }
        let until_tick = match self.for_s {
            Some(for_s) => from_tick + (for_s / TICK_S).round() as u32,
            None => run_ticks,
        };
        let kind = self.kind()?;
        self.check_nothing_is_left()?;
        Ok(Fault {
            kind,
            from_tick,
            until_tick,
        })
    }

    /// What happens. Takes the keys that belong to the kind of the fault.
    fn kind(&mut self) -> Result<FaultKind, InvalidValue> {
        Ok(match self.kind {
            Kind::Silence => FaultKind::Message {
                target: self.target()?,
                probability: 1.0,
                disturbance: Disturbance::Drop,
            },
            Kind::Drop => self.disturbed(Disturbance::Drop)?,
            Kind::Duplicate => self.disturbed(Disturbance::Duplicate)?,
            Kind::Corrupt => {
                let bits = self.bits.take().unwrap_or(1) as u8;
                self.disturbed(Disturbance::Corrupt { bits })?
            }
            Kind::Delay => {
                let ticks = self.ticks.take().unwrap_or(1) as u16;
                self.disturbed(Disturbance::Delay { ticks })?
            }
            Kind::Replay => {
                let ticks = self.ticks.take().unwrap_or(200) as u16;
                self.disturbed(Disturbance::Replay { ticks })?
            }
            Kind::Masquerade => FaultKind::Message {
                target: self.target()?,
                probability: 1.0,
                disturbance: Disturbance::Masquerade,
            },
            Kind::NodeKilled => FaultKind::NodeKilled(match self.node.take() {
                Some(Node::Plant) => Role::Plant,
                Some(Node::Controller) => Role::Controller,
                None => return Err(self.needs("node", "\"plant\"")),
            }),
            Kind::NodeRestarted => match self.node.take() {
                Some(Node::Controller) if self.for_s.is_some() => FaultKind::ControllerRestarted,
                Some(Node::Controller) => return Err(self.needs("for_s", "0.2")),
                Some(Node::Plant) => {
                    let what = "is \"plant\", which begins another run when it restarts: must be \"controller\"";
                    return Err(InvalidValue::new("node", what));
                }
                None => return Err(self.needs("node", "\"controller\"")),
            },
            Kind::SensorStuck => self.sensor(SensorFault::Stuck)?,
            Kind::SensorNan => self.sensor(SensorFault::NotANumber)?,
            Kind::SensorOutOfRange => {
                let value = self.value.take().ok_or_else(|| self.needs("value (SI)", "0.05"))?;
                self.sensor(SensorFault::Value(value as f32))?
            }
            Kind::SensorOffset => {
                let value = self.value.take().ok_or_else(|| self.needs("value (SI)", "0.05"))?;
                self.sensor(SensorFault::Offset(value as f32))?
            }
            Kind::SensorGain => {
                let value = self.value.take().ok_or_else(|| self.needs("value (a factor)", "1.2"))?;
                self.sensor(SensorFault::Gain(value as f32))?
            }
            Kind::SensorNoise => {
                let value = self.value.take().ok_or_else(|| self.needs("value (SI)", "0.002"))?;
                if value < 0.0 {
                    let what = format!("is {value}: a standard deviation is 0 or more");
                    return Err(InvalidValue::new("value", what));
                }
                self.sensor(SensorFault::Noise(value as f32))?
            }
            Kind::SensorDrift => {
                let value = self
                    .value
                    .take()
                    .ok_or_else(|| self.needs("value (SI a second)", "0.001"))?;
                self.sensor(SensorFault::Drift(value as f32))?
            }
            Kind::SensorSwap => {
                let one = self.place("sensor", self.sensor.clone())?;
                let other = self.place("other", self.other.clone())?;
                (self.sensor, self.other) = (None, None);
                let is_displacement = |place: SensorPlace| place.sensor == Sensor::Displacement;
                if one == other || is_displacement(one) != is_displacement(other) {
                    let what = "must be another sensor than sensor, and of the same quantity";
                    return Err(InvalidValue::new("other", what));
                }
                FaultKind::SensorsSwapped { one, other }
            }
            Kind::SolenoidStuck => {
                let name = self
                    .valve
                    .take()
                    .ok_or_else(|| self.needs("valve", "\"front-left.3\""))?;
                let place = ValvePlace::from_name(&name).ok_or_else(|| {
                    let corners = CORNER_NAMES.join(", ");
                    let what = format!("is {name:?}: must be CORNER.NUMBER, of {corners} and 1 to 3");
                    InvalidValue::new("valve", what)
                })?;
                let position = self
                    .position
                    .take()
                    .ok_or_else(|| self.needs("position", "\"closed\""))?;
                FaultKind::SolenoidStuck {
                    place,
                    open: position == Position::Open,
                }
            }
        })
    }

    /// Some frames of some messages are disturbed.
    fn disturbed(&mut self, disturbance: Disturbance) -> Result<FaultKind, InvalidValue> {
        Ok(FaultKind::Message {
            target: self.target()?,
            probability: self.probability.take().unwrap_or(1.0),
            disturbance,
        })
    }

    /// A sensor is faulty.
    fn sensor(&mut self, fault: SensorFault) -> Result<FaultKind, InvalidValue> {
        let name = self.sensor.take();
        let place = self.place("sensor", name)?;
        Ok(FaultKind::Sensor { place, fault })
    }

    /// The sensor that a key names.
    fn place(&self, key: &'static str, name: Option<String>) -> Result<SensorPlace, InvalidValue> {
        let name = name.ok_or_else(|| self.needs(key, "\"front-left.p1\""))?;
        SensorPlace::from_name(&name).ok_or_else(|| {
            let (corners, sensors) = (CORNER_NAMES.join(", "), SENSOR_NAMES.join(", "));
            let what = format!("is {name:?}: must be CORNER.SENSOR, of {corners} and {sensors}");
            InvalidValue::new(key, what)
        })
    }

    /// Which messages; all of them where nothing is said.
    fn target(&mut self) -> Result<Target, InvalidValue> {
        let Some(name) = self.message.take() else {
            return Ok(Target::All);
        };
        Ok(match name.as_str() {
            "all" => Target::All,
            "sensors" => Target::Sensors,
            "controller" => Target::Controller,
            other => {
                let message = MESSAGES.iter().find(|message| message.name == other).ok_or_else(|| {
                    let names: Vec<&str> = ["all", "sensors", "controller"]
                        .into_iter()
                        .chain(MESSAGES.iter().map(|message| message.name))
                        .collect();
                    let what = format!(
                        "is {other:?}, which is not a message: {}",
                        suggestion(other, &names, "messages")
                    );
                    InvalidValue::new("message", what)
                })?;
                Target::Id(message.id)
            }
        })
    }

    fn needs(&self, key: &str, example: &str) -> InvalidValue {
        let kind: &str = self.kind.into();
        let what = format!("is {kind:?}, which needs {key} too: for example {key} = {example}");
        InvalidValue::new("kind", what)
    }

    /// What the kind of the fault has not taken does not belong to it.
    fn check_nothing_is_left(&self) -> Result<(), InvalidValue> {
        let left = [
            ("message", self.message.is_some()),
            ("probability", self.probability.is_some()),
            ("bits", self.bits.is_some()),
            ("ticks", self.ticks.is_some()),
            ("sensor", self.sensor.is_some()),
            ("other", self.other.is_some()),
            ("value", self.value.is_some()),
            ("valve", self.valve.is_some()),
            ("position", self.position.is_some()),
            ("node", self.node.is_some()),
        ];
        match left.into_iter().find(|(_, is_left)| *is_left) {
            None => Ok(()),
            Some((key, _)) => {
                let kind: &str = self.kind.into();
                let what = format!("does not belong to a fault of kind {kind:?}: remove it");
                Err(InvalidValue::new(key, what))
            }
        }
    }
}
