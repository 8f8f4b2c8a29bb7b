//! Scenario files: TOML to checked values, or one line with file, line and key.
//!
//! Values that can be wrong keep their place in the text until they are checked, so that every complaint names its line.

use std::path::Path;
use std::str::FromStr;

use serde::Deserialize;
use strum::VariantNames;
use toml::Spanned;

use super::check::{Check, Comparison, Metric};
use super::fault_entry::FaultEntry;
use super::{Scenario, TICK_S};

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
        strategy: reader.one_of("strategy", raw.strategy.as_ref())?,
        damper_policy: reader.one_of("damper_policy", raw.damper_policy.as_ref())?,
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
        clock: reader.one_of("clock", raw.clock.as_ref())?,
        on_controller_loss: reader.one_of("on_controller_loss", raw.on_controller_loss.as_ref())?,
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
pub(super) struct Reader<'a> {
    text: &'a str,
    file: &'a str,
}

impl Reader<'_> {
    fn line(&self, offset: usize) -> usize {
        self.text.bytes().take(offset).filter(|byte| *byte == b'\n').count() + 1
    }

    pub(super) fn error(&self, offset: usize, what: String) -> ScenarioError {
        ScenarioError {
            file: self.file.into(),
            line: Some(self.line(offset)),
            what,
        }
    }

    pub(super) fn within(&self, key: &str, value: &Spanned<f64>, low: f64, high: f64) -> Result<f64, ScenarioError> {
        let number = *value.as_ref();
        if (low..=high).contains(&number) {
            return Ok(number);
        }
        Err(self.error(
            value.span().start,
            format!("{key} is {number}: must be from {low} to {high}"),
        ))
    }

    pub(super) fn whole(&self, key: &str, value: &Spanned<i64>, low: i64, high: i64) -> Result<i64, ScenarioError> {
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
    fn one_of<T: Default + FromStr + VariantNames>(
        &self,
        key: &str,
        name: Option<&Spanned<String>>,
    ) -> Result<T, ScenarioError> {
        let Some(name) = name else { return Ok(T::default()) };
        name.as_ref().parse().map_err(|_| {
            self.error(
                name.span().start,
                format!(
                    "{key} is {:?}: must be one of {}",
                    name.as_ref(),
                    T::VARIANTS.join(", ")
                ),
            )
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
