//! `model.toml`: what is believed about one strut. The same file configures rig, vehicle, hil and diagnose.

use std::collections::BTreeMap;

use oleo_interface::Gauge;
use serde::{Deserialize, Serialize};

use super::damper::DamperTable;
use super::terms::{COLUMNS, Effects, RESPONSE_COEFFICIENT, check_constant};
use crate::model_file::instruments::{check_noise, check_noise_is_complete, check_tolerance};
use crate::model_file::limits::each_checked;
use crate::model_file::{Checked, InvalidValue, Limit, ModelFileError, Range, checked, read};

/// What the model is of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Specimen {
    /// Name of the individual.
    pub name: String,
    /// Kind of the specimen, which must be [`StrutModel::KIND`].
    pub kind: String,
}

impl Checked for Specimen {
    const LIMITS: &'static [Limit<Self>] = &[];

    fn check_together(&self) -> Result<(), InvalidValue> {
        if self.kind == StrutModel::KIND {
            return Ok(());
        }
        let what = format!("is {:?}: must be {:?}", self.kind, StrutModel::KIND);
        Err(InvalidValue::new("kind", what))
    }
}

/// The main cylinder of the strut.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// Bore of the cylinder, m.
    pub bore_m: f64,
    /// Oil volume at displacement zero, m3.
    pub oil_volume_m3: f64,
    /// Static gauge pressure, Pa.
    #[serde(rename = "static_pressure_Pa")]
    pub static_pressure_pa: f64,
}

impl Checked for Cylinder {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("bore_m", Range::FromTo(1e-3, 2.0), "m", |c| c.bore_m),
        Limit::one("oil_volume_m3", Range::FromTo(1e-7, 10.0), "m3", |c| c.oil_volume_m3),
        Limit::one("static_pressure_Pa", Range::FromTo(100.0, 1e9), "Pa", |c| {
            c.static_pressure_pa
        }),
    ];
}

/// Gas filling of both accumulators.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GasCharge {
    /// Species: `nitrogen`, the only one known.
    pub species: String,
    /// Ambient temperature, K.
    #[serde(rename = "temperature_K")]
    pub temperature_k: f64,
}

impl Checked for GasCharge {
    const LIMITS: &'static [Limit<Self>] = &[Limit::one("temperature_K", Range::FromTo(100.0, 1000.0), "K", |g| {
        g.temperature_k
    })];

    fn check_together(&self) -> Result<(), InvalidValue> {
        if self.species == "nitrogen" {
            return Ok(());
        }
        let what = format!("is {:?}: must be \"nitrogen\", the only gas known", self.species);
        Err(InvalidValue::new("species", what))
    }
}

/// An accumulator with its gas charge.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Accumulator {
    /// Gas volume at static pressure and ambient temperature, m3.
    pub static_gas_volume_m3: f64,
}

impl Checked for Accumulator {
    const LIMITS: &'static [Limit<Self>] = &[Limit::one(
        "static_gas_volume_m3",
        Range::FromTo(1e-9, 10.0),
        "m3",
        |a| a.static_gas_volume_m3,
    )];
}

/// The valves of one function: bypass of damper 1, bypass of damper 2, or accumulator 2.
///
/// The prototype has two small fast ones for each, because no single valve had both the flow and the response (report,
/// section 3.3). One signal drives both and they are alike, so their flows add: `Q = in_parallel * c * orifice(dp)`. What
/// differs between the two, or one of them sticking, is not modelled.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Valve {
    /// Flow coefficient of one open valve, m3/s/sqrt(Pa).
    pub flow_coefficient: f64,
    /// Number of valves in parallel on one switching signal; 1 where the coefficient is that of the whole function.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub in_parallel: u32,
}

impl Checked for Valve {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("flow_coefficient", Range::FromTo(1e-12, 1.0), "m3/s/sqrt(Pa)", |v| {
            v.flow_coefficient
        }),
        Limit::one("in_parallel", Range::FromTo(1.0, 100.0), "", |v| {
            f64::from(v.in_parallel)
        }),
    ];
}

impl Valve {
    /// Flow coefficient of all valves of the function together, m3/s/sqrt(Pa).
    #[must_use]
    pub fn total_flow_coefficient(&self) -> f64 {
        f64::from(self.in_parallel) * self.flow_coefficient
    }
}

fn one() -> u32 {
    1
}

fn is_one(count: &u32) -> bool {
    *count == 1
}

/// What all orifices have in common.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Orifice {
    /// Pressure drop below which an orifice flows laminar, Pa.
    #[serde(rename = "transition_pressure_Pa")]
    pub transition_pressure_pa: f64,
}

impl Checked for Orifice {
    const LIMITS: &'static [Limit<Self>] = &[Limit::one(
        "transition_pressure_Pa",
        Range::FromTo(1.0, 1e8),
        "Pa",
        |o| o.transition_pressure_pa,
    )];
}

/// Response of all valves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ValveTiming {
    /// Time to 95 % of the change, `c0 + c1 dP + c2 dP^2`, s, with dP in MPa; one to three coefficients.
    pub response_polynomial_s: Vec<f64>,
    /// Time to 5 % of the change over the time to 95 %.
    pub initial_delay_fraction: f64,
}

impl Checked for ValveTiming {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::list("response_polynomial_s", RESPONSE_COEFFICIENT, "s", |t| {
            &t.response_polynomial_s
        }),
        Limit::one("initial_delay_fraction", Range::FromToBelow(0.0, 1.0), "", |t| {
            t.initial_delay_fraction
        }),
    ];

    fn check_together(&self) -> Result<(), InvalidValue> {
        let count = self.response_polynomial_s.len();
        if !(1..=3).contains(&count) {
            let what = format!("has {count} entries: must have one to three, the coefficients of a parabola");
            return Err(InvalidValue::new("response_polynomial_s", what));
        }
        check_constant(&self.response_polynomial_s)
    }
}

/// A strut: specimen, geometry, fillings, characteristics, effects, tolerances, sensor noise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StrutModel {
    /// Accumulators 1 and 2.
    pub accumulator: [Accumulator; 2],
    /// Valves 1 to 3.
    pub valve: [Valve; 3],
    /// Name and kind of the specimen.
    pub specimen: Specimen,
    /// The main cylinder of the strut.
    pub cylinder: Cylinder,
    /// Species and temperature of the gas.
    pub gas: GasCharge,
    /// Damper packs 1 and 2.
    pub damper: [DamperTable; 2],
    /// Flow law of the valves and leaks.
    pub orifice: Orifice,
    /// Response times of the valves.
    pub valve_timing: ValveTiming,
    /// The terms that the model has.
    #[serde(default)]
    pub effects: Effects,
    /// How far nominal values may be off without anything missing: relative, or in the unit of the name.
    #[serde(default)]
    pub tolerance: BTreeMap<String, f64>,
    /// Standard deviation of each channel's white noise, in the channel's unit.
    #[serde(default)]
    pub noise: BTreeMap<String, f64>,
}

/// What can be calibrated on a strut: the keys of `[tolerance]`.
const TOLERANCES: [&str; 10] = [
    "static_gas_volume",
    "static_pressure",
    "oil_volume",
    "flow_coefficient",
    "bulk_modulus",
    "time_constant",
    "temperature_K",
    "displacement_offset_m",
    "force_offset_N",
    "pressure_offset_Pa",
];

impl Checked for StrutModel {
    const LIMITS: &'static [Limit<Self>] = &[];

    fn check_together(&self) -> Result<(), InvalidValue> {
        checked(&self.specimen, "specimen")?;
        checked(&self.cylinder, "cylinder")?;
        checked(&self.gas, "gas")?;
        each_checked(&self.accumulator, "accumulator")?;
        each_checked(&self.valve, "valve")?;
        each_checked(&self.damper, "damper")?;
        checked(&self.orifice, "orifice")?;
        checked(&self.valve_timing, "valve_timing")?;
        checked(&self.effects, "effects")?;
        check_tolerance(&self.tolerance, &TOLERANCES)?;
        check_noise(&self.noise, &COLUMNS)
    }
}

impl StrutModel {
    /// What `[specimen] kind` says of a strut.
    pub const KIND: &'static str = "two-stage hydropneumatic strut";

    /// Read and check a model. `file` is the name that appears in errors.
    ///
    /// ```
    /// use oleo_plant_sim::strut::StrutModel;
    /// let text = StrutModel::defender110(8000.0).to_toml().replace("bore_m", "boar_m");
    /// let error = StrutModel::from_toml(&text, "model.toml").unwrap_err().to_string();
    /// assert!(error.contains("[cylinder] boar_m is not a known key: did you mean bore_m?"), "{error}");
    /// ```
    ///
    /// # Errors
    /// Unknown, missing or impossible entries, with file and line.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, ModelFileError> {
        read(text, file)
    }

    /// The model as a file that [`StrutModel::from_toml`] reads back to the same bits.
    ///
    /// ```
    /// use oleo_plant_sim::strut::StrutModel;
    /// let model = StrutModel::defender110(5000.0);
    /// assert_eq!(StrutModel::from_toml(&model.to_toml(), "copy.toml"), Ok(model));
    /// ```
    #[must_use]
    pub fn to_toml(&self) -> String {
        // Every field is a number, a string or a table of them, which TOML can always hold.
        toml::to_string_pretty(self).unwrap_or_default()
    }

    /// The model file of the Land Rover Defender 110 preset.
    pub const DEFENDER110_TOML: &'static str = include_str!("../../presets/strut-defender110.toml");

    /// The strut of the Land Rover Defender 110 preset at a static load, N (4,000 unladen to 8,000 laden at the rear).
    ///
    /// Damper packs keep their characteristic; gas volumes are those at this load, as the design asks.
    ///
    /// ```
    /// use oleo_plant_sim::strut::StrutModel;
    /// let model = StrutModel::defender110(8000.0);
    /// assert!((model.static_pressure().pa() * model.piston_area_m2() - 8000.0).abs() < 1e-9);
    /// ```
    #[must_use]
    pub fn defender110(static_load_n: f64) -> Self {
        let model = Self::from_toml(Self::DEFENDER110_TOML, "presets/strut-defender110.toml")
            .unwrap_or_else(|e| unreachable!("{e}"));
        model.charged_for(static_load_n)
    }

    /// The same strut charged for another static load, N, as in a workshop: its gas volumes are those at this load.
    ///
    /// ```
    /// use oleo_plant_sim::strut::StrutModel;
    /// assert_eq!(StrutModel::defender110(4000.0).charged_for(8000.0), StrutModel::defender110(8000.0));
    /// ```
    #[must_use]
    pub fn charged_for(mut self, static_load_n: f64) -> Self {
        self.cylinder.static_pressure_pa = static_load_n / self.piston_area_m2();
        self
    }

    /// Area of the piston, m2.
    #[must_use]
    pub fn piston_area_m2(&self) -> f64 {
        0.25 * std::f64::consts::PI * self.cylinder.bore_m * self.cylinder.bore_m
    }

    /// Pressure at the static position.
    #[must_use]
    pub fn static_pressure(&self) -> Gauge<f64> {
        Gauge(self.cylinder.static_pressure_pa)
    }

    /// Coefficients of the valves' response, s, s/MPa, s/MPa2: those of the term `valve_delay` where the model has it, else
    /// those of `[valve_timing]`.
    #[must_use]
    pub fn response_polynomial_s(&self) -> [f64; 3] {
        match &self.effects.valve_delay {
            Some(delay) => delay.response_polynomial_s,
            None => {
                let given = &self.valve_timing.response_polynomial_s;
                [0, 1, 2].map(|k| given.get(k).copied().unwrap_or(0.0))
            }
        }
    }

    /// Refuse a model that does not state the noise of every channel. A simulation does without; a diagnosis, which judges
    /// every residual by it, does not. Only the displacement, which is not compared, may be without noise (0).
    ///
    /// ```
    /// use oleo_plant_sim::strut::StrutModel;
    /// let mut model = StrutModel::defender110(8000.0);
    /// assert_eq!(model.check_noise_is_complete(), Ok(()));
    /// model.noise.remove("p3_Pa");
    /// let missing = model.check_noise_is_complete().unwrap_err();
    /// assert!(missing.to_string().starts_with("[noise] p3_Pa is missing: "));
    /// ```
    ///
    /// # Errors
    /// The channels whose noise is missing, or a zero. [`InvalidValue::in_file`] adds file and line.
    pub fn check_noise_is_complete(&self) -> Result<(), InvalidValue> {
        let [_, compared @ ..] = &COLUMNS;
        check_noise_is_complete(&self.noise, &COLUMNS, compared)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model_file::limits::forgotten_keys;

    #[test]
    fn the_preset_reads_back_what_it_writes() {
        let model = StrutModel::defender110(8000.0);
        assert_eq!(StrutModel::from_toml(&model.to_toml(), "copy").unwrap(), model);
        assert!((model.cylinder.static_pressure_pa - 4.0744e6).abs() < 1e3);
        assert_eq!(model.check_noise_is_complete(), Ok(()));
    }

    #[test]
    fn every_number_has_a_limit() {
        let mut model = StrutModel::defender110(8000.0);
        let valve = &mut model.valve[0];
        valve.in_parallel = 2;
        let forgotten = [
            forgotten_keys(&model.cylinder),
            forgotten_keys(&model.gas),
            forgotten_keys(&model.accumulator[0]),
            forgotten_keys(&model.valve[0]),
            forgotten_keys(&model.damper[0]),
            forgotten_keys(&model.orifice),
            forgotten_keys(&model.valve_timing),
        ];
        assert!(forgotten.concat().is_empty(), "{forgotten:?}");
    }

    #[test]
    fn what_is_not_a_number_is_checked_too() {
        let complaint = |change: fn(&mut StrutModel)| {
            let mut model = StrutModel::defender110(8000.0);
            change(&mut model);
            model.check().unwrap_err().to_string()
        };
        assert!(complaint(|m| m.gas.species = "air".into()).starts_with("[gas] species is \"air\""));
        assert!(complaint(|m| m.specimen.kind = "car".into()).starts_with("[specimen] kind is \"car\""));
        assert!(complaint(|m| m.valve[2].in_parallel = 0).starts_with("[valve 3] in_parallel is 0: must be from 1"));
        assert!(complaint(|m| m.valve_timing.response_polynomial_s.clear()).contains("has 0 entries"));
        assert!(
            complaint(|m| m.valve_timing.response_polynomial_s[0] = -0.1)
                .starts_with("[valve_timing] response_polynomial_s, entry 1, is -0.1: must be 0 or more")
        );
        assert!(complaint(|m| _ = m.noise.insert("p1_pa".into(), 1.0)).contains("did you mean p1_Pa?"));
        assert!(complaint(|m| _ = m.tolerance.insert("bore".into(), 1.0)).starts_with("[tolerance] bore is not"));
    }

    #[test]
    fn a_model_without_noise_is_refused_where_noise_is_needed() {
        let mut model = StrutModel::defender110(8000.0);
        model.noise.remove("p3_Pa");
        assert_eq!(model.check(), Ok(()));
        let missing = model.check_noise_is_complete().unwrap_err();
        let text = model.to_toml();
        let line = 1 + text.lines().position(|line| line == "[noise]").unwrap();
        let shown = missing.in_file(&text, "model.toml").to_string();
        assert!(
            shown.starts_with(&format!("model.toml:{line}: [noise] p3_Pa is missing: ")),
            "{shown}"
        );
    }
}
