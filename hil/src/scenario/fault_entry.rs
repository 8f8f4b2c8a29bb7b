//! `[[fault]]` tables of a scenario file: keys to a checked [`Fault`].

use oleo_controller::can::MESSAGES;
use serde::Deserialize;
use toml::Spanned;

use super::TICK_S;
use super::fault::{CORNER_NAMES, Fault, FaultKind, SENSOR_NAMES, SensorFault, SensorPlace, ValvePlace};
use super::file::{LONGEST_S, Reader, ScenarioError};
use crate::bus::{Disturbance, Target};
use crate::sync::Role;

/// All keys any kind of fault has; which ones go with which kind is checked afterwards.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FaultEntry {
    kind: Spanned<String>,
    at_s: Spanned<f64>,
    for_s: Option<Spanned<f64>>,
    message: Option<Spanned<String>>,
    probability: Option<Spanned<f64>>,
    bits: Option<Spanned<i64>>,
    ticks: Option<Spanned<i64>>,
    sensor: Option<Spanned<String>>,
    value: Option<Spanned<f64>>,
    valve: Option<Spanned<String>>,
    position: Option<Spanned<String>>,
    node: Option<Spanned<String>>,
}

impl Reader<'_> {
    pub(super) fn fault(&self, entry: Spanned<FaultEntry>, run_ticks: u32) -> Result<Fault, ScenarioError> {
        let start = entry.span().start;
        let mut entry = entry.into_inner();
        let at_s = self.within("at_s", &entry.at_s, 0.0, LONGEST_S)?;
        let from_tick = (at_s / TICK_S).round() as u32;
        if from_tick >= run_ticks {
            let end_s = f64::from(run_ticks) * TICK_S;
            return Err(self.error(
                entry.at_s.span().start,
                format!("at_s is {at_s}: the run ends at {end_s} s"),
            ));
        }
        let until_tick = match &entry.for_s {
            Some(for_s) => from_tick + (self.within("for_s", for_s, TICK_S, LONGEST_S)? / TICK_S).round() as u32,
            None => run_ticks,
        };
        let kind = self.fault_kind(&mut entry, start)?;
        // What the kind has not taken does not belong to it.
        let left = [
            ("message", entry.message.map(|v| v.span())),
            ("probability", entry.probability.map(|v| v.span())),
            ("bits", entry.bits.map(|v| v.span())),
            ("ticks", entry.ticks.map(|v| v.span())),
            ("sensor", entry.sensor.map(|v| v.span())),
            ("value", entry.value.map(|v| v.span())),
            ("valve", entry.valve.map(|v| v.span())),
            ("position", entry.position.map(|v| v.span())),
            ("node", entry.node.map(|v| v.span())),
        ];
        if let Some((key, span)) = left.into_iter().find_map(|(key, span)| Some((key, span?))) {
            let kind = entry.kind.as_ref();
            return Err(self.error(
                span.start,
                format!("{key} does not belong to a fault of kind {kind:?}: remove it"),
            ));
        }
        Ok(Fault {
            kind,
            from_tick,
            until_tick,
        })
    }

    fn fault_kind(&self, entry: &mut FaultEntry, start: usize) -> Result<FaultKind, ScenarioError> {
        let kind = entry.kind.as_ref().clone();
        let missing = |key: &str, example: &str| {
            self.error(
                start,
                format!("a fault of kind {kind:?} needs {key}: for example {key} = {example}"),
            )
        };
        Ok(match kind.as_str() {
            "silence" => FaultKind::Message {
                target: self.target(entry)?,
                probability: 1.0,
                disturbance: Disturbance::Drop,
            },
            "drop" | "corrupt" | "delay" | "duplicate" => {
                let target = self.target(entry)?;
                let probability = entry
                    .probability
                    .take()
                    .map_or(Ok(1.0), |v| self.within("probability", &v, 0.0, 1.0))?;
                let disturbance = match kind.as_str() {
                    "corrupt" => {
                        let bits = entry.bits.take().map_or(Ok(1), |v| self.whole("bits", &v, 1, 64))?;
                        Disturbance::Corrupt { bits: bits as u8 }
                    }
                    "delay" => {
                        let ticks = entry.ticks.take().map_or(Ok(1), |v| self.whole("ticks", &v, 1, 1000))?;
                        Disturbance::Delay { ticks: ticks as u16 }
                    }
                    "duplicate" => Disturbance::Duplicate,
                    _ => Disturbance::Drop,
                };
                FaultKind::Message {
                    target,
                    probability,
                    disturbance,
                }
            }
            "node-killed" => {
                let node = entry.node.take().ok_or_else(|| missing("node", "\"plant\""))?;
                FaultKind::NodeKilled(match node.as_ref().as_str() {
                    "plant" => Role::Plant,
                    "controller" => Role::Controller,
                    other => {
                        let what = format!("node is {other:?}: must be \"plant\" or \"controller\"");
                        return Err(self.error(node.span().start, what));
                    }
                })
            }
            "sensor-stuck" | "sensor-nan" | "sensor-out-of-range" | "sensor-offset" => {
                let name = entry
                    .sensor
                    .take()
                    .ok_or_else(|| missing("sensor", "\"front-left.p1\""))?;
                let place = SensorPlace::from_name(name.as_ref()).ok_or_else(|| {
                    let (corners, sensors) = (CORNER_NAMES.join(", "), SENSOR_NAMES.join(", "));
                    let what = format!(
                        "sensor is {:?}: must be CORNER.SENSOR, of {corners} and {sensors}",
                        name.as_ref()
                    );
                    self.error(name.span().start, what)
                })?;
                let fault = match kind.as_str() {
                    "sensor-stuck" => SensorFault::Stuck,
                    "sensor-nan" => SensorFault::NotANumber,
                    _ => {
                        let value = entry.value.take().ok_or_else(|| missing("value (SI)", "0.05"))?;
                        let number = self.within("value", &value, -1e12, 1e12)? as f32;
                        if kind == "sensor-offset" {
                            SensorFault::Offset(number)
                        } else {
                            SensorFault::Value(number)
                        }
                    }
                };
                FaultKind::Sensor { place, fault }
            }
            "solenoid-stuck" => {
                let name = entry.valve.take().ok_or_else(|| missing("valve", "\"front-left.3\""))?;
                let place = ValvePlace::from_name(name.as_ref()).ok_or_else(|| {
                    let corners = CORNER_NAMES.join(", ");
                    let what = format!(
                        "valve is {:?}: must be CORNER.NUMBER, of {corners} and 1 to 3",
                        name.as_ref()
                    );
                    self.error(name.span().start, what)
                })?;
                let position = entry.position.take().ok_or_else(|| missing("position", "\"closed\""))?;
                let open = match position.as_ref().as_str() {
                    "open" => true,
                    "closed" => false,
                    other => {
                        let what = format!("position is {other:?}: must be \"open\" or \"closed\"");
                        return Err(self.error(position.span().start, what));
                    }
                };
                FaultKind::SolenoidStuck { place, open }
            }
            other => {
                let what = format!(
                    "kind is {other:?}: must be one of silence, drop, corrupt, delay, duplicate, node-killed, sensor-stuck, \
                     sensor-nan, sensor-out-of-range, sensor-offset, solenoid-stuck"
                );
                return Err(self.error(entry.kind.span().start, what));
            }
        })
    }

    /// Which messages; all of them where nothing is said.
    fn target(&self, entry: &mut FaultEntry) -> Result<Target, ScenarioError> {
        let Some(name) = entry.message.take() else {
            return Ok(Target::All);
        };
        Ok(match name.as_ref().as_str() {
            "all" => Target::All,
            "sensors" => Target::Sensors,
            "controller" => Target::Controller,
            other => {
                let message = MESSAGES.iter().find(|message| message.name == other).ok_or_else(|| {
                    let names = MESSAGES.map(|message| message.name).join(", ");
                    let what = format!("message is {other:?}: must be all, sensors, controller or one of {names}");
                    self.error(name.span().start, what)
                })?;
                Target::Id(message.id)
            }
        })
    }
}
