//! Scenario files: TOML to checked values, or one line with file, line and key.
//!
//! Values that can be wrong keep their place in the text until they are checked, so that every complaint names its line.

use std::path::Path;

use oleo_controller::can::MESSAGES;
use oleo_controller::strategy::{DamperPolicy, Strategy};
use serde::Deserialize;
use toml::Spanned;

use super::check::{Check, Comparison, Metric};
use super::fault::{CORNER_NAMES, Fault, FaultKind, SENSOR_NAMES, SensorFault, SensorPlace, ValvePlace};
use super::{Clock, OnControllerLoss, Scenario, TICK_S};
use crate::bus::{Disturbance, Target};
use crate::sync::Role;

/// Longest run, s: an hour, so that a slip of a zero does not fill the memory.
pub const LONGEST_S: f64 = 3600.0;
/// Fastest vehicle, km/h.
pub const FASTEST_KM_H: f64 = 250.0;

/// A scenario that cannot be run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScenarioError {
    /// Which file.
    pub file: String,
    /// Line, where one is to blame.
    pub line: Option<usize>,
    /// Key, what is wrong with it, and what would be right.
    pub what: String,
}

impl std::fmt::Display for ScenarioError {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.line {
            Some(line) => write!(out, "{}:{line}: {}", self.file, self.what),
            None => write!(out, "{}: {}", self.file, self.what),
        }
    }
}

impl std::error::Error for ScenarioError {}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ScenarioFile {
    name: String,
    #[serde(default)]
    description: String,
    road: Spanned<String>,
    speed_km_h: Spanned<f64>,
    duration_s: Spanned<f64>,
    strategy: Option<Spanned<String>>,
    damper_policy: Option<Spanned<String>>,
    strut: Option<String>,
    vehicle: Option<String>,
    seed: Option<Spanned<i64>>,
    bus: Option<Spanned<String>>,
    clock: Option<Spanned<String>>,
    on_controller_loss: Option<Spanned<String>>,
    partner_timeout_s: Option<Spanned<f64>>,
    #[serde(default)]
    fault: Vec<Spanned<FaultEntry>>,
    #[serde(default)]
    check: Vec<Spanned<CheckEntry>>,
}

/// All keys any kind of fault has; which ones go with which kind is checked afterwards.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FaultEntry {
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

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CheckEntry {
    metric: Spanned<String>,
    at_most: Option<f64>,
    at_least: Option<f64>,
    equals: Option<toml::Value>,
}

/// Reads a scenario. `folder` is where relative paths in it start.
///
/// # Errors
/// See [`ScenarioError`].
pub fn parse(text: &str, file: &str, folder: &Path) -> Result<Scenario, ScenarioError> {
    let reader = Reader { text, file };
    let raw: ScenarioFile = toml::from_str(text).map_err(|error| ScenarioError {
        file: file.into(),
        line: error.span().map(|span| reader.line(span.start)),
        what: error.message().split_whitespace().collect::<Vec<_>>().join(" "),
    })?;
    let speed_km_h = reader.within("speed_km_h", &raw.speed_km_h, 0.0, FASTEST_KM_H)?;
    let duration_s = reader.within("duration_s", &raw.duration_s, TICK_S, LONGEST_S)?;
    let ticks = (duration_s / TICK_S).round() as u32;
    let timeout = raw
        .partner_timeout_s
        .map(|v| reader.within("partner_timeout_s", &v, 0.1, 600.0))
        .transpose()?;
    Ok(Scenario {
        name: raw.name,
        description: raw.description,
        road: located(raw.road.as_ref(), folder, &oleo_plant_sim::road::NAMES),
        speed_m_s: speed_km_h / 3.6,
        ticks,
        strategy: reader.one_of("strategy", raw.strategy.as_ref(), &Strategy::ALL)?,
        damper_policy: reader.one_of("damper_policy", raw.damper_policy.as_ref(), &DamperPolicy::ALL)?,
        strut: located(raw.strut.as_deref().unwrap_or(DEFENDER), folder, &[DEFENDER]),
        vehicle: located(raw.vehicle.as_deref().unwrap_or(DEFENDER), folder, &[DEFENDER]),
        seed: raw
            .seed
            .map(|v| reader.whole("seed", &v, 0, i64::MAX))
            .transpose()?
            .unwrap_or(1) as u64,
        bus: match raw.bus {
            Some(bus) => bus
                .as_ref()
                .parse()
                .map_err(|e| reader.error(bus.span().start, format!("bus {e}")))?,
            None => Default::default(),
        },
        clock: reader.one_of("clock", raw.clock.as_ref(), &Clock::ALL)?,
        on_controller_loss: reader.one_of(
            "on_controller_loss",
            raw.on_controller_loss.as_ref(),
            &[("continue", OnControllerLoss::Continue), ("end", OnControllerLoss::End)],
        )?,
        partner_timeout_s: timeout.unwrap_or(3.0),
        faults: raw
            .fault
            .into_iter()
            .map(|entry| reader.fault(entry, ticks))
            .collect::<Result<_, _>>()?,
        checks: raw
            .check
            .into_iter()
            .map(|entry| reader.check(entry))
            .collect::<Result<_, _>>()?,
    })
}

/// Name of the built-in vehicle and strut.
pub const DEFENDER: &str = "defender110";

/// A built-in name as it is, anything else as a path from the scenario's folder.
fn located(value: &str, folder: &Path, names: &[&str]) -> String {
    if names.contains(&value) || folder.as_os_str().is_empty() {
        value.to_owned()
    } else {
        folder.join(value).to_string_lossy().into_owned()
    }
}

/// What every complaint needs.
struct Reader<'a> {
    text: &'a str,
    file: &'a str,
}

impl Reader<'_> {
    fn line(&self, offset: usize) -> usize {
        self.text.bytes().take(offset).filter(|byte| *byte == b'\n').count() + 1
    }

    fn error(&self, offset: usize, what: String) -> ScenarioError {
        ScenarioError {
            file: self.file.into(),
            line: Some(self.line(offset)),
            what,
        }
    }

    fn within(&self, key: &str, value: &Spanned<f64>, low: f64, high: f64) -> Result<f64, ScenarioError> {
        let number = *value.as_ref();
        if (low..=high).contains(&number) {
            return Ok(number);
        }
        Err(self.error(
            value.span().start,
            format!("{key} is {number}: must be from {low} to {high}"),
        ))
    }

    fn whole(&self, key: &str, value: &Spanned<i64>, low: i64, high: i64) -> Result<i64, ScenarioError> {
        let number = *value.as_ref();
        if (low..=high).contains(&number) {
            return Ok(number);
        }
        Err(self.error(
            value.span().start,
            format!("{key} is {number}: must be from {low} to {high}"),
        ))
    }

    /// A value by its name; the type's default where the key is absent.
    fn one_of<T: Copy + Default>(
        &self,
        key: &str,
        name: Option<&Spanned<String>>,
        all: &[(&str, T)],
    ) -> Result<T, ScenarioError> {
        let Some(name) = name else { return Ok(T::default()) };
        all.iter()
            .find_map(|(n, value)| (n == name.as_ref()).then_some(*value))
            .ok_or_else(|| {
                let names: Vec<&str> = all.iter().map(|(name, _)| *name).collect();
                self.error(
                    name.span().start,
                    format!("{key} is {:?}: must be one of {}", name.as_ref(), names.join(", ")),
                )
            })
    }

    fn fault(&self, entry: Spanned<FaultEntry>, run_ticks: u32) -> Result<Fault, ScenarioError> {
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

    fn check(&self, entry: Spanned<CheckEntry>) -> Result<Check, ScenarioError> {
        let start = entry.span().start;
        let entry = entry.into_inner();
        let metric = Metric::from_name(entry.metric.as_ref()).ok_or_else(|| {
            let names: Vec<&str> = Metric::ALL.iter().map(|metric| metric.name()).collect();
            let what = format!(
                "metric is {:?}: must be one of {}",
                entry.metric.as_ref(),
                names.join(", ")
            );
            self.error(entry.metric.span().start, what)
        })?;
        let one = "a check needs exactly one of at_most, at_least, equals";
        let comparison = match (entry.at_most, entry.at_least, entry.equals) {
            (Some(limit), None, None) => Comparison::AtMost(limit),
            (None, Some(limit), None) => Comparison::AtLeast(limit),
            (None, None, Some(toml::Value::Integer(number))) => Comparison::Equals(number as f64),
            (None, None, Some(toml::Value::Float(number))) => Comparison::Equals(number),
            (None, None, Some(toml::Value::String(word))) => Comparison::Is(word),
            (None, None, Some(_)) => return Err(self.error(start, "equals must be a number or a word".into())),
            _ => return Err(self.error(start, one.into())),
        };
        if let Comparison::AtMost(limit) | Comparison::AtLeast(limit) | Comparison::Equals(limit) = comparison
            && !limit.is_finite()
        {
            return Err(self.error(start, format!("the limit is {limit}: must be a finite number")));
        }
        if matches!(comparison, Comparison::Is(_)) != metric.is_word() {
            let kind = if metric.is_word() {
                "a word: equals = \"normal\""
            } else {
                "a number"
            };
            return Err(self.error(start, format!("{} is {kind}", metric.name())));
        }
        Ok(Check { metric, comparison })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const GOOD: &str = "name = \"x\"\nroad = \"flat\"\nspeed_km_h = 60\nduration_s = 2\n";

    fn complaint(more: &str) -> String {
        let error = parse(&format!("{GOOD}{more}"), "x.toml", Path::new(""))
            .unwrap_err()
            .to_string();
        assert_eq!(error.lines().count(), 1, "{error}");
        error
    }

    #[test]
    fn defaults() {
        let scenario = parse(GOOD, "x.toml", Path::new("dir")).unwrap();
        assert_eq!(
            (scenario.ticks, scenario.seed, scenario.road.as_str()),
            (400, 1, "flat")
        );
        let own = parse(&GOOD.replace("flat", "my.crg"), "x.toml", Path::new("dir")).unwrap();
        assert_eq!(own.road, "dir/my.crg");
    }

    #[test]
    fn complaints_name_file_line_and_key() {
        let table = [
            ("sped = 3\n", "x.toml:5: unknown field `sped`"),
            ("seed = -1\n", "x.toml:5: seed is -1"),
            (
                "strategy = \"soft\"\n",
                "x.toml:5: strategy is \"soft\": must be one of always-soft",
            ),
            ("bus = \"can0\"\n", "x.toml:5: bus \"can0\" is not a bus"),
            ("clock = \"slow\"\n", "x.toml:5: clock is"),
            ("seed = \n", "x.toml:5: "),
            (
                "[[fault]]\nkind = \"drop\"\nat_s = 3\n",
                "x.toml:7: at_s is 3: the run ends at 2 s",
            ),
            (
                "[[fault]]\nkind = \"drop\"\nat_s = 1\nprobability = 1.5\n",
                "x.toml:8: probability is 1.5",
            ),
            ("[[fault]]\nkind = \"drop\"\nat_s = nan\n", "x.toml:7: at_s is NaN"),
            (
                "[[fault]]\nkind = \"drop\"\nat_s = 1\nbits = 3\n",
                "x.toml:8: bits does not belong",
            ),
            (
                "[[fault]]\nkind = \"flood\"\nat_s = 1\n",
                "x.toml:6: kind is \"flood\": must be one of silence",
            ),
            (
                "[[fault]]\nkind = \"drop\"\nat_s = 1\nmessage = \"X\"\n",
                "x.toml:8: message is \"X\"",
            ),
            (
                "[[fault]]\nkind = \"sensor-nan\"\nat_s = 1\n",
                "x.toml:5: a fault of kind \"sensor-nan\" needs sensor",
            ),
            (
                "[[fault]]\nkind = \"sensor-nan\"\nat_s = 1\nsensor = \"p1\"\n",
                "x.toml:8: sensor is \"p1\"",
            ),
            (
                "[[fault]]\nkind = \"node-killed\"\nat_s = 1\nnode = \"me\"\n",
                "x.toml:8: node is \"me\"",
            ),
            (
                "[[check]]\nmetric = \"speed\"\nat_most = 1\n",
                "x.toml:6: metric is \"speed\": must be one of",
            ),
            (
                "[[check]]\nmetric = \"max_roll_deg\"\n",
                "x.toml:5: a check needs exactly one of",
            ),
            (
                "[[check]]\nmetric = \"max_roll_deg\"\nequals = \"safe\"\n",
                "x.toml:5: max_roll_deg is a number",
            ),
            (
                "[[check]]\nmetric = \"final_mode\"\nat_most = 1\n",
                "x.toml:5: final_mode is a word",
            ),
            (
                "[[check]]\nmetric = \"max_roll_deg\"\nat_most = inf\n",
                "x.toml:5: the limit is inf",
            ),
        ];
        for (more, expected) in table {
            let error = complaint(more);
            assert!(error.starts_with(expected), "{error}\n  expected {expected}");
        }
        let missing = parse("name = \"x\"\n", "x.toml", Path::new(""))
            .unwrap_err()
            .to_string();
        assert!(missing.contains("missing field `road`"), "{missing}");
    }

    proptest! {
        #[test]
        fn no_text_does_harm(text in "\\PC{0,200}") {
            let _ = parse(&text, "x", Path::new(""));
        }

        #[test]
        fn no_damaged_scenario_does_harm(at in 0usize..400, byte in 0x20u8..0x7F) {
            let mut text = format!("{GOOD}[[fault]]\nkind = \"corrupt\"\nat_s = 1.0\nfor_s = 0.5\nbits = 2\n[[check]]\nmetric = \"final_mode\"\nequals = \"safe\"\n").into_bytes();
            let length = text.len();
            text[at % length] = byte;
            let _ = parse(std::str::from_utf8(&text).unwrap(), "x", Path::new(""));
        }
    }
}
