//! `model.toml`: what is believed about one strut. The same file configures rig, vehicle, hil and diagnose.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::damper::DamperTable;
use super::effects::{BumpStop, Effects};

/// Atmosphere, Pa.
pub const ATMOSPHERE_PA: f64 = 101_325.0;

/// A model file that cannot be used; one line naming file, line, key and what to do.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}{}: {what}", line.map(|l| format!(":{l}")).unwrap_or_default())]
pub struct ModelError {
    /// File the model came from.
    pub file: String,
    /// Line, where known.
    pub line: Option<usize>,
    /// What is wrong and what is allowed.
    pub what: String,
}

/// What the campaign is of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Specimen {
    /// Name.
    pub name: String,
    /// `two-stage hydropneumatic strut`.
    pub kind: String,
}

/// Main cylinder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// Bore, m.
    pub bore_m: f64,
    /// Oil volume at displacement zero, m3.
    pub oil_volume_m3: f64,
    /// Static pressure, Pa gauge.
    #[serde(rename = "static_pressure_Pa")]
    pub static_pressure_pa: f64,
}

/// Gas filling.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GasCharge {
    /// `nitrogen`.
    pub species: String,
    /// Ambient temperature, K.
    #[serde(rename = "temperature_K")]
    pub temperature_k: f64,
}

/// One accumulator.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Accumulator {
    /// Gas volume at static pressure and ambient temperature, m3.
    pub static_gas_volume_m3: f64,
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
    /// Valves in parallel on one switching signal; 1 where the coefficient is that of the whole function.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub in_parallel: u32,
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

/// All orifices.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Orifice {
    /// Pressure drop below which an orifice flows laminar, Pa.
    #[serde(rename = "transition_pressure_Pa")]
    pub transition_pressure_pa: f64,
}

/// Response of all valves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ValveTiming {
    /// Time to 95 % of the change, `c0 + c1 dP + c2 dP^2`, s, dP in MPa; one to three coefficients.
    pub response_polynomial_s: Vec<f64>,
    /// Time to 5 % over time to 95 %.
    pub initial_delay_fraction: f64,
}

/// A strut: specimen, geometry, fillings, characteristics, effects, tolerances, sensor noise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StrutModel {
    /// Accumulators 1 and 2.
    pub accumulator: [Accumulator; 2],
    /// Valves 1 to 3.
    pub valve: [Valve; 3],
    /// Name and kind.
    pub specimen: Specimen,
    /// Main cylinder.
    pub cylinder: Cylinder,
    /// Gas.
    pub gas: GasCharge,
    /// Damper packs 1 and 2.
    pub damper: [DamperTable; 2],
    /// Orifice law.
    pub orifice: Orifice,
    /// Valve timing.
    pub valve_timing: ValveTiming,
    /// The terms present.
    #[serde(default)]
    pub effects: Effects,
    /// How far nominal values may be off without anything missing.
    #[serde(default)]
    pub tolerance: BTreeMap<String, f64>,
    /// Standard deviation of each channel's white noise.
    #[serde(default)]
    pub noise: BTreeMap<String, f64>,
}

impl StrutModel {
    /// Parse and check a model.
    ///
    /// # Errors
    /// Unknown, missing or impossible entries, with file and line.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, ModelError> {
        let model: Self = toml::from_str(text).map_err(|e| ModelError {
            file: file.to_owned(),
            line: e
                .span()
                .map(|s| text[..s.start.min(text.len())].matches('\n').count() + 1),
            what: e.message().trim().replace('\n', " "),
        })?;
        model.check().map_err(|(key, what)| ModelError {
            file: file.to_owned(),
            line: line_of(text, &key),
            what: format!("{key} {what}"),
        })?;
        Ok(model)
    }

    /// The model as a file that [`StrutModel::from_toml`] reads back.
    #[must_use]
    pub fn to_toml(&self) -> String {
        // Every field is a number, a string or a table of them, which TOML can always hold.
        toml::to_string_pretty(self).unwrap_or_default()
    }

    /// The strut of the Land Rover Defender 110 preset at a static load, N (4,000 unladen to 8,000 laden at the rear).
    ///
    /// Damper packs keep their characteristic; gas volumes are those at this load, as the design asks.
    #[must_use]
    pub fn defender110(static_load_n: f64) -> Self {
        let text = include_str!("../../presets/strut-defender110.toml");
        let mut model = Self::from_toml(text, "presets/strut-defender110.toml").unwrap_or_else(|e| unreachable!("{e}"));
        model.cylinder.static_pressure_pa = static_load_n / model.piston_area_m2();
        model
    }

    /// Piston area, m2.
    #[must_use]
    pub fn piston_area_m2(&self) -> f64 {
        0.25 * std::f64::consts::PI * self.cylinder.bore_m * self.cylinder.bore_m
    }

    /// The key and what is wrong with its value.
    pub(crate) fn check(&self) -> Result<(), (String, String)> {
        let positive = |key: &str, v: f64| {
            if v.is_finite() && v > 0.0 {
                Ok(())
            } else {
                Err((key.to_owned(), format!("is {v}: must be above 0")))
            }
        };
        let not_negative = |key: &str, v: f64| {
            if v.is_finite() && v >= 0.0 {
                Ok(())
            } else {
                Err((key.to_owned(), format!("is {v}: must be 0 or more")))
            }
        };
        let finite = |key: &str, v: f64| {
            if v.is_finite() {
                Ok(())
            } else {
                Err((key.to_owned(), format!("is {v}: must be a finite number")))
            }
        };
        if self.specimen.kind != "two-stage hydropneumatic strut" {
            return Err((
                "kind".into(),
                format!(
                    "is {:?}: must be \"two-stage hydropneumatic strut\"",
                    self.specimen.kind
                ),
            ));
        }
        if self.gas.species != "nitrogen" {
            return Err((
                "species".into(),
                format!("is {:?}: only \"nitrogen\" is known", self.gas.species),
            ));
        }
        positive("bore_m", self.cylinder.bore_m)?;
        positive("oil_volume_m3", self.cylinder.oil_volume_m3)?;
        positive("static_pressure_Pa", self.cylinder.static_pressure_pa)?;
        positive("temperature_K", self.gas.temperature_k)?;
        positive("transition_pressure_Pa", self.orifice.transition_pressure_pa)?;
        for a in &self.accumulator {
            positive("static_gas_volume_m3", a.static_gas_volume_m3)?;
        }
        for v in &self.valve {
            positive("flow_coefficient", v.flow_coefficient)?;
            if v.in_parallel == 0 {
                return Err(("in_parallel".into(), "is 0: must be 1 or more".into()));
            }
        }
        for d in &self.damper {
            increasing("flow_m3_s", &d.flow_m3_s)?;
            increasing("pressure_drop_Pa", &d.pressure_drop_pa)?;
            if d.flow_m3_s.len() != d.pressure_drop_pa.len() {
                let (a, b) = (d.flow_m3_s.len(), d.pressure_drop_pa.len());
                return Err((
                    "pressure_drop_Pa".into(),
                    format!("has {b} points, flow_m3_s has {a}: must be as many"),
                ));
            }
        }
        if self.valve_timing.response_polynomial_s.is_empty() || self.valve_timing.response_polynomial_s.len() > 3 {
            return Err((
                "response_polynomial_s".into(),
                "must have one to three coefficients".into(),
            ));
        }
        not_negative("response_polynomial_s", self.valve_timing.response_polynomial_s[0])?;
        let f = self.valve_timing.initial_delay_fraction;
        if !(f.is_finite() && (0.0..1.0).contains(&f)) {
            return Err((
                "initial_delay_fraction".into(),
                format!("is {f}: must be from 0 to below 1"),
            ));
        }
        let e = &self.effects;
        if let Some(t) = &e.oil_compressibility {
            positive("bulk_modulus_Pa", t.bulk_modulus_pa)?;
        }
        if let Some(t) = &e.entrained_air {
            not_negative("volume_fraction", t.volume_fraction)?;
            positive("polytropic_exponent", t.polytropic_exponent)?;
        }
        if let Some(t) = &e.gas_heat_transfer {
            positive("time_constant_1_s", t.time_constant_1_s)?;
            positive("time_constant_2_s", t.time_constant_2_s)?;
        }
        if let Some(t) = &e.gas_charge_error {
            for (key, v) in [
                ("relative_error_1", t.relative_error_1),
                ("relative_error_2", t.relative_error_2),
            ] {
                positive(key, 1.0 + v).map_err(|_| (key.to_owned(), format!("is {v}: must be above -1")))?;
            }
        }
        if let Some(t) = &e.seal_friction {
            not_negative("coulomb_force_N", t.coulomb_force_n)?;
            not_negative("breakaway_force_N", t.breakaway_force_n)?;
            positive("stribeck_speed_m_s", t.stribeck_speed_m_s)?;
            positive("presliding_stiffness_N_m", t.presliding_stiffness_n_m)?;
        }
        if let Some(t) = &e.side_load_friction {
            not_negative("coefficient", t.coefficient)?;
            finite("overlap_growth_1_m", t.overlap_growth_1_m)?;
        }
        if let Some(t) = &e.accumulator_piston_friction {
            not_negative("pressure_1_Pa", t.pressure_1_pa)?;
            not_negative("pressure_2_Pa", t.pressure_2_pa)?;
            positive("presliding_volume_m3", t.presliding_volume_m3)?;
        }
        if let Some(t) = &e.damper_leakage {
            not_negative("flow_coefficient_1", t.flow_coefficient_1)?;
            not_negative("flow_coefficient_2", t.flow_coefficient_2)?;
        }
        if let Some(t) = &e.line_resistance {
            not_negative("resistance_1_Pa_s_m3", t.resistance_1_pa_s_m3)?;
            not_negative("resistance_2_Pa_s_m3", t.resistance_2_pa_s_m3)?;
        }
        if let Some(t) = &e.line_inertance {
            not_negative("inertance_2_kg_m4", t.inertance_2_kg_m4)?;
        }
        if let Some(t) = &e.valve_delay {
            not_negative("response_polynomial_s", t.response_polynomial_s[0])?;
            finite(
                "response_polynomial_s",
                t.response_polynomial_s[1] + t.response_polynomial_s[2],
            )?;
        }
        if let Some(t) = &e.valve3_leakage {
            not_negative("flow_coefficient", t.flow_coefficient)?;
        }
        if let Some(BumpStop {
            bump_clearance_m,
            rebound_clearance_m,
            stiffness_n_m,
            progression_n_m3,
        }) = &e.bump_stop
        {
            finite("bump_clearance_m", *bump_clearance_m)?;
            finite("rebound_clearance_m", *rebound_clearance_m)?;
            not_negative("stiffness_N_m", *stiffness_n_m)?;
            not_negative("progression_N_m3", *progression_n_m3)?;
        }
        if let Some(t) = &e.mount_compliance {
            positive("stiffness_N_m", t.stiffness_n_m)?;
        }
        if let Some(t) = &e.damping_fade {
            not_negative("fade_1_per_J", t.fade_1_per_j)?;
            not_negative("fade_2_per_J", t.fade_2_per_j)?;
            positive("cooling_time_s", t.cooling_time_s)?;
        }
        for (key, sensor) in [
            ("sensor_lag", &e.sensor_lag),
            ("sensor_gain", &e.sensor_gain),
            ("sensor_drift", &e.sensor_drift),
            ("sensor_skew", &e.sensor_skew),
            ("sensor_sign", &e.sensor_sign),
            ("sensor_offset", &e.sensor_offset),
        ] {
            for (column, v) in sensor.iter().flatten() {
                finite(column, *v)?;
                if !super::sensor::COLUMNS.contains(&column.as_str()) {
                    let known = super::sensor::COLUMNS.join(", ");
                    return Err((
                        column.clone(),
                        format!("in {key} is not a column of a strut's recording: one of {known}"),
                    ));
                }
            }
        }
        super::laws::check(&e.unlisted)?;
        for law in &e.unlisted {
            increasing("argument", &law.argument)?;
            if law.value.len() != law.argument.len() {
                return Err(("value".into(), "must have as many points as argument".into()));
            }
            law.value.iter().try_for_each(|v| finite("value", *v))?;
        }
        Ok(())
    }
}

fn increasing(key: &str, values: &[f64]) -> Result<(), (String, String)> {
    if values.len() < 2 {
        return Err((
            key.to_owned(),
            format!("has {} points: needs two or more", values.len()),
        ));
    }
    if let Some(w) = values
        .windows(2)
        .find(|w| !(w[0].is_finite() && w[1].is_finite() && w[1] > w[0]))
    {
        return Err((key.to_owned(), format!("goes from {} to {}: must increase", w[0], w[1])));
    }
    Ok(())
}

/// First line that sets `key`.
fn line_of(text: &str, key: &str) -> Option<usize> {
    text.lines()
        .position(|line| line.contains(key) && line.contains('='))
        .map(|i| i + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_preset_reads_back_what_it_writes() {
        let model = StrutModel::defender110(8000.0);
        assert_eq!(StrutModel::from_toml(&model.to_toml(), "copy").unwrap(), model);
        assert!((model.cylinder.static_pressure_pa - 4.0744e6).abs() < 1e3);
    }

    #[test]
    fn a_bad_value_is_one_line_with_file_line_and_key() {
        let text = StrutModel::defender110(8000.0).to_toml();
        let line = text.lines().position(|l| l.starts_with("oil_volume_m3")).unwrap() + 1;
        let bad = text.replace("oil_volume_m3 = ", "oil_volume_m3 = -");
        let error = StrutModel::from_toml(&bad, "model.toml").unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("model.toml:{line}: oil_volume_m3 is -")),
            "{error}"
        );
        assert_eq!(error.lines().count(), 1);
    }

    #[test]
    fn a_law_that_nobody_would_read_is_refused() {
        let law = |place: &str, over: &str| {
            let (a, v) = ("argument = [0.0, 1.0]", "value = [1.0, 1.0]");
            format!("\n[[effects.unlisted]]\nplace = \"{place}\"\ndepends_on = \"{over}\"\n{a}\n{v}\n")
        };
        let read = |laws: &str| StrutModel::from_toml(&(StrutModel::defender110(8000.0).to_toml() + laws), "m");
        assert!(read(&(law("valve-1..3", "pressure_drop") + &law("beside-pack-1", "displacement"))).is_ok());
        let unread = read(&law("valve-1", "p1")).unwrap_err().to_string();
        assert!(
            unread.contains("\"p1\"") && unread.contains("\"pressure_drop\""),
            "{unread}"
        );
        let twice = read(&(law("main-seal", "speed") + &law("main-seal", "p1")))
            .unwrap_err()
            .to_string();
        assert!(twice.contains("main-seal") && twice.lines().count() == 1, "{twice}");
    }

    #[test]
    fn unknown_and_missing_keys_name_their_line() {
        let text = StrutModel::defender110(8000.0).to_toml();
        let unknown = StrutModel::from_toml(&text.replace("bore_m", "boar_m"), "m").unwrap_err();
        assert!(
            unknown.line.is_some() && unknown.to_string().contains("boar_m"),
            "{unknown}"
        );
        let missing = StrutModel::from_toml(&text.replace("[orifice]", "[noise]"), "m").unwrap_err();
        assert_eq!(missing.to_string().lines().count(), 1);
    }
}
