//! A chamber of nitrogen closed by a piston, and nothing else.
//!
//! `V = V_0 - A x`, ideal gas of constant mass. Isothermal, adiabatic, or in between through the energy equation with a
//! thermal time constant of Els & Grobbelaar (SAE 930265), as in the strut:
//! `m c_v dT/dt = -p dV/dt - m c_v (T - T_ambient) / tau`. The time constant is a number, or that of free convection, which
//! is the shorter the further the gas is from the temperature of its wall.
//! Units SI; pressure absolute.

use serde::{Deserialize, Serialize};

use super::name::SpecimenName;
use crate::model_file::instruments::{check_noise, check_noise_is_complete, check_tolerance};
use crate::model_file::{Checked, InvalidValue, Limit, ModelFileError, Range, checked, read};
use crate::strut::{
    Effects, Equation, NITROGEN_CV_J_KG_K, NITROGEN_R_J_KG_K, SensorEffect, TermId, check_columns, record_column,
};

/// The gas chamber of a gas spring.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpringChamber {
    /// Area of the piston, m2.
    pub area_m2: f64,
    /// Gas volume at displacement zero, m3.
    pub volume_at_zero_m3: f64,
}

impl Checked for SpringChamber {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("area_m2", Range::FromTo(1e-6, 1.0), "m2", |c| c.area_m2),
        Limit::one("volume_at_zero_m3", Range::FromTo(1e-7, 10.0), "m3", |c| {
            c.volume_at_zero_m3
        }),
    ];
}

/// What the gas is taken to do where no heat transfer is modelled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum GasProcess {
    /// Stays at its first temperature.
    Isothermal,
    /// The gas exchanges no heat with its surroundings.
    Adiabatic,
}

/// The gas in the chamber.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GasSpringGas {
    /// Species of the gas; only `nitrogen` is possible.
    pub species: String,
    /// Process without heat transfer.
    pub process: GasProcess,
    /// Ambient temperature, K.
    #[serde(rename = "temperature_K")]
    pub temperature_k: f64,
    /// Gas temperature at the first sample less ambient, K.
    #[serde(
        rename = "initial_temperature_difference_K",
        default,
        skip_serializing_if = "is_zero"
    )]
    pub initial_temperature_difference_k: f64,
    /// Pressure at the first sample over the measured one, less 1.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub initial_pressure_error: f64,
}

impl Checked for GasSpringGas {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("temperature_K", Range::FromTo(200.0, 400.0), "K", |g| g.temperature_k),
        Limit::one(
            "initial_temperature_difference_K",
            Range::FromTo(-150.0, 150.0),
            "K",
            |g| g.initial_temperature_difference_k,
        ),
        Limit::one("initial_pressure_error", Range::FromTo(-0.9, 0.9), "", |g| {
            g.initial_pressure_error
        }),
    ];

    fn check_together(&self) -> Result<(), InvalidValue> {
        if self.species == "nitrogen" {
            return Ok(());
        }
        let what = format!("is {:?}: must be \"nitrogen\", the only gas known", self.species);
        Err(InvalidValue::new("species", what))
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature serde wants")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// How the gas gives its heat to the wall.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Convection {
    /// In proportion to the difference of their temperatures.
    #[default]
    Constant,
    /// By turbulent free convection, `Nu = C (Gr Pr)^(1/3)` (McAdams, Heat Transmission, 3rd ed., 1954, chapter 7): the heat
    /// transfer coefficient grows with the third root of the difference and with the density to the power of 2/3. The wall is in
    /// proportion to the gas volume, as that of a cylinder whose piston moves.
    Free,
}

impl Convection {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature serde wants")]
    fn is_constant(&self) -> bool {
        *self == Self::Constant
    }
}

/// Difference of temperatures at which the time constant of free convection is stated, K.
const STATED_AT_K: f64 = 10.0;

/// Heat exchanged with the wall.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GasHeatTransferTerm {
    /// Thermal time constant, s; with free convection that at a difference of 10 K and at the gas volume of displacement zero.
    pub time_constant_s: f64,
    /// How the gas gives its heat to the wall.
    #[serde(default, skip_serializing_if = "Convection::is_constant")]
    pub convection: Convection,
}

impl GasHeatTransferTerm {
    /// What is left after a time (s) of a difference of temperatures (K) at a constant volume, relative to that at displacement zero.
    fn left_k(&self, difference_k: f64, relative_volume: f64, time_s: f64) -> f64 {
        match self.convection {
            Convection::Constant => difference_k * libm::exp(-time_s / self.time_constant_s),
            // d' = -d |d|^(1/3) times a constant has the solution d (1 + r t/3)^-3, where r is the rate at the beginning.
            Convection::Free => {
                let times_as_fast = libm::cbrt(difference_k.abs() / STATED_AT_K * relative_volume);
                let base = 1.0 + times_as_fast * time_s / (3.0 * self.time_constant_s);
                difference_k / (base * base * base)
            }
        }
    }
}

impl Checked for GasHeatTransferTerm {
    const LIMITS: &'static [Limit<Self>] = &[Limit::one("time_constant_s", Range::FromTo(1e-3, 1e6), "s", |h| {
        h.time_constant_s
    })];
}

/// Terms a gas spring may have.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GasSpringEffects {
    /// Gas neither isothermal nor adiabatic.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gas_heat_transfer: Option<GasHeatTransferTerm>,
    /// Unlisted: gas lost, `dm/dt = -rate m`, 1/s.
    #[serde(rename = "gas_leak_rate_1_s", skip_serializing_if = "Option::is_none")]
    pub gas_leak_rate_1_s: Option<f64>,
    /// Unlisted: a fixed polytropic exponent in place of the process.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub polytropic_exponent: Option<f64>,
    /// First-order lag of a column, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_lag: Option<SensorEffect>,
    /// Relative gain error of a column.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_gain: Option<SensorEffect>,
    /// Drift of a column, unit per second.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_drift: Option<SensorEffect>,
    /// Time by which a column is late, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_skew: Option<SensorEffect>,
}

impl GasSpringEffects {
    /// Heat exchanged with the wall, of an ideal gas with constant heat capacity.
    pub const GAS_HEAT_TRANSFER: Equation = Equation {
        text: "m c_v dT/dt = -p dV/dt - m c_v (T - T_ambient) / tau",
        source: "Els & Grobbelaar, SAE 930265, 1993; Otis & Pourmovahed, J. Dyn. Sys. Meas. Control 107, 1985; free convection: McAdams, Heat Transmission, 1954",
    };

    /// Equation of [`GasSpringEffects::polytropic_exponent`].
    pub const POLYTROPIC_EXPONENT: Equation = Equation {
        text: "p V^n = constant",
        source: "polytropic process; no name in the vocabulary",
    };

    /// Equation of [`GasSpringEffects::gas_leak_rate_1_s`].
    pub const GAS_LOST: Equation = Equation {
        text: "dm/dt = -k m",
        source: "a leak in proportion to what is left, assumed; no name in the vocabulary",
    };

    /// The faulty columns of one kind of instrument fault; `None` for an id that is no fault of its instruments.
    pub fn sensor_fault_mut(&mut self, id: TermId) -> Option<&mut Option<SensorEffect>> {
        match id {
            TermId::SensorLag => Some(&mut self.sensor_lag),
            TermId::SensorGain => Some(&mut self.sensor_gain),
            TermId::SensorDrift => Some(&mut self.sensor_drift),
            TermId::SensorSkew => Some(&mut self.sensor_skew),
            _ => None,
        }
    }
}

impl Checked for GasSpringEffects {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::optional("gas_leak_rate_1_s", Range::FromTo(-1e3, 1e3), "1/s", |e| {
            e.gas_leak_rate_1_s
        }),
        Limit::optional("polytropic_exponent", Range::FromTo(0.5, 3.0), "", |e| {
            e.polytropic_exponent
        }),
    ];

    fn check_together(&self) -> Result<(), InvalidValue> {
        if let Some(heat) = &self.gas_heat_transfer {
            checked(heat, "gas_heat_transfer")?;
        }
        for (id, fault) in [
            (TermId::SensorLag, &self.sensor_lag),
            (TermId::SensorGain, &self.sensor_gain),
            (TermId::SensorDrift, &self.sensor_drift),
            (TermId::SensorSkew, &self.sensor_skew),
        ] {
            check_columns(id, fault.as_ref(), &[PRESSURE])?;
        }
        Ok(())
    }
}

/// Column of the pressure sensor.
const PRESSURE: &str = "p_Pa";

/// The `model.toml` of a gas spring.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GasSpringModel {
    /// Name and kind of the specimen.
    pub specimen: SpecimenName,
    /// Geometry of the gas chamber.
    pub chamber: SpringChamber,
    /// The gas in the chamber.
    pub gas: GasSpringGas,
    /// Effects that the model contains.
    #[serde(default)]
    pub effects: GasSpringEffects,
    /// How far values may be off: `volume_at_zero`, `initial_pressure` relative, `temperature_K` in K.
    #[serde(default)]
    pub tolerance: SensorEffect,
    /// Standard deviation of the noise by column.
    #[serde(default)]
    pub noise: SensorEffect,
}

impl Checked for GasSpringModel {
    const LIMITS: &'static [Limit<Self>] = &[];

    fn check_together(&self) -> Result<(), InvalidValue> {
        checked(&self.specimen, "specimen")?;
        checked(&self.chamber, "chamber")?;
        checked(&self.gas, "gas")?;
        checked(&self.effects, "effects")?;
        check_tolerance(
            &self.tolerance,
            &["volume_at_zero", "initial_pressure", "temperature_K", "time_constant"],
        )?;
        check_noise(&self.noise, &CHANNELS)
    }
}

/// Channels of a gas spring: the displacement and the pressure, which is compared with the model.
const CHANNELS: [&str; 2] = ["displacement_m", PRESSURE];

impl GasSpringModel {
    /// Refuse a model that does not state the noise of both channels, which only a diagnosis needs. The displacement, which is
    /// not compared, may be without noise (0).
    ///
    /// # Errors
    /// The channels whose noise is missing, or a pressure without noise.
    pub fn check_noise_is_complete(&self) -> Result<(), InvalidValue> {
        check_noise_is_complete(&self.noise, &CHANNELS, &[PRESSURE])
    }

    /// Read and check a model. `file` is the name that appears in errors.
    ///
    /// ```
    /// use oleo_plant_sim::specimen::GasSpringModel;
    /// let text = "[specimen]\nname = \"a\"\nkind = \"gas spring\"\n[chamber]\narea_m2 = 0.01\nvolume_at_zero_m3 = 0.05\n\
    ///             [gas]\nspecies = \"nitrogen\"\nprocess = \"adiabatic\"\ntemperature_K = 293.15\n";
    /// let model = GasSpringModel::from_toml(text, "model.toml").unwrap();
    /// // Half of a stroke of 1 m, within a second, from 1 MPa (absolute).
    /// let pressure_pa = model.pressure_pa(&[0.0, 1.0], &[0.0, 0.5], 1.0e6).unwrap();
    /// assert!(pressure_pa[1] > 1.15e6 && pressure_pa[1] < 1.17e6);
    /// ```
    ///
    /// # Errors
    /// Unknown, missing or impossible entries, with file and line.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, ModelFileError> {
        read(text, file)
    }

    /// The model as a file.
    ///
    /// # Errors
    /// Never for a model that was read; the serialiser's message otherwise.
    pub fn to_toml(&self) -> Result<String, String> {
        toml::to_string_pretty(self).map_err(|e| e.to_string())
    }

    /// Absolute pressure at every sample, from the displacement and the first measured pressure, before instruments.
    ///
    /// # Errors
    /// A stroke that would leave no gas volume.
    pub fn pressure_pa(
        &self,
        time_s: &[f64],
        displacement_m: &[f64],
        first_pressure_pa: f64,
    ) -> Result<Vec<f64>, String> {
        let gas = &self.gas;
        let volume = |x: f64| self.chamber.volume_at_zero_m3 - self.chamber.area_m2 * x;
        let smallest = displacement_m.iter().map(|&x| volume(x)).fold(f64::INFINITY, f64::min);
        if smallest <= 0.0 {
            return Err(format!(
                "the recorded stroke would leave a gas volume of {smallest} m3; correct volume_at_zero_m3 or area_m2"
            ));
        }
        let ambient = gas.temperature_k;
        let mut temperature = ambient + gas.initial_temperature_difference_k;
        let mut v = volume(displacement_m[0]);
        let first = first_pressure_pa * (1.0 + gas.initial_pressure_error);
        let mut mass_r = first * v / temperature;
        let exponent = match (
            &self.effects.gas_heat_transfer,
            self.effects.polytropic_exponent,
            gas.process,
        ) {
            (Some(_), _, _) | (None, None, GasProcess::Adiabatic) => NITROGEN_R_J_KG_K / NITROGEN_CV_J_KG_K,
            (None, Some(n), _) => n - 1.0,
            (None, None, GasProcess::Isothermal) => 0.0,
        };
        let leak = self.effects.gas_leak_rate_1_s.unwrap_or(0.0);
        let mut pressure = Vec::with_capacity(time_s.len());
        pressure.push(first);
        for k in 1..time_s.len() {
            let dt = time_s[k] - time_s[k - 1];
            let next = volume(displacement_m[k]);
            // Strang splitting: half a step of heat exchange, the adiabatic change of volume, half a step; each exact.
            let relaxed = |temperature: f64, volume: f64| {
                let relative = volume / self.chamber.volume_at_zero_m3;
                let heat = self.effects.gas_heat_transfer.as_ref();
                heat.map_or(temperature, |h| {
                    ambient + h.left_k(temperature - ambient, relative, 0.5 * dt)
                })
            };
            temperature = relaxed(temperature, v) * libm::pow(v / next, exponent);
            temperature = relaxed(temperature, next);
            mass_r *= libm::exp(-leak * dt);
            v = next;
            pressure.push(mass_r * temperature / v);
        }
        Ok(pressure)
    }

    /// What the pressure sensor shows of the true pressure.
    #[must_use]
    pub fn shown(&self, time_s: &[f64], mut pressure_pa: Vec<f64>) -> Vec<f64> {
        let e = &self.effects;
        let instruments = Effects {
            sensor_lag: e.sensor_lag.clone(),
            sensor_gain: e.sensor_gain.clone(),
            sensor_drift: e.sensor_drift.clone(),
            sensor_skew: e.sensor_skew.clone(),
            ..Effects::default()
        };
        record_column(&instruments, PRESSURE, time_s, &mut pressure_pa);
        pressure_pa
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model() -> GasSpringModel {
        GasSpringModel::from_toml(
            "[specimen]\nname='a'\nkind='gas spring'\n[chamber]\narea_m2=0.01\nvolume_at_zero_m3=0.05\n[gas]\n\
             species='nitrogen'\nprocess='adiabatic'\ntemperature_K=293.15\n",
            "test",
        )
        .unwrap()
    }

    #[test]
    fn adiabatic_is_the_closed_form() {
        let t: Vec<f64> = (0..101).map(f64::from).collect();
        let x: Vec<f64> = t.iter().map(|t| 0.02 * t).collect();
        let p = model().pressure_pa(&t, &x, 1e6).unwrap();
        let gamma = 1.0 + NITROGEN_R_J_KG_K / NITROGEN_CV_J_KG_K;
        assert!((p[100] / (1e6 * libm::pow(0.05 / 0.03, gamma)) - 1.0).abs() < 1e-10);
    }

    #[test]
    fn a_held_piston_relaxes_with_the_time_constant_to_the_isotherm() {
        let mut m = model();
        m.effects.gas_heat_transfer = Some(GasHeatTransferTerm {
            time_constant_s: 5.0,
            convection: Convection::Constant,
        });
        let t: Vec<f64> = (0..10_001).map(|k| f64::from(k) * 0.01).collect();
        let x: Vec<f64> = t.iter().map(|t| if *t < 0.005 { 0.0 } else { 1.0 }).collect();
        let p = m.pressure_pa(&t, &x, 1e6).unwrap();
        let isotherm = 1e6 * 0.05 / 0.04;
        assert!((p[10_000] / isotherm - 1.0).abs() < 1e-6);
        let ratio = (p[1001] - isotherm) / (p[501] - isotherm);
        assert!((ratio - libm::exp(-1.0)).abs() < 1e-6, "{ratio}");
    }

    /// Against the equation itself, in steps of a millisecond by Runge and Kutta's method.
    #[test]
    fn free_convection_follows_its_equation() {
        let heat = GasHeatTransferTerm {
            time_constant_s: 6.0,
            convection: Convection::Free,
        };
        for (begins_k, relative) in [(25.0, 0.7), (-4.0, 1.2)] {
            let rate = |d: f64| -d * libm::cbrt(d.abs() / 10.0 * relative) / 6.0;
            let (mut d, step): (f64, f64) = (begins_k, 1e-3);
            for _ in 0..8000 {
                let k1 = rate(d);
                let k2 = rate(d + 0.5 * step * k1);
                let k3 = rate(d + 0.5 * step * k2);
                d += step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + rate(d + step * k3));
            }
            let left = heat.left_k(begins_k, relative, 8.0);
            assert!((left / d - 1.0).abs() < 1e-9, "{left} {d}");
        }
        assert_eq!(heat.left_k(0.0, 1.0, 1.0), 0.0);
        // At the difference and the volume at which it is stated, the constant is the inverse rate.
        let rate = (10.0 - heat.left_k(10.0, 1.0, 1e-6)) / 10.0 / 1e-6;
        assert!((rate * 6.0 - 1.0).abs() < 1e-4, "{rate}");
    }

    #[test]
    fn a_file_says_how_heat_is_exchanged_only_where_it_is_not_constant() {
        let mut m = model();
        for convection in [Convection::Constant, Convection::Free] {
            m.effects.gas_heat_transfer = Some(GasHeatTransferTerm {
                time_constant_s: 5.0,
                convection,
            });
            let text = m.to_toml().unwrap();
            assert_eq!(text.contains("convection = \"free\""), convection == Convection::Free);
            assert_eq!(GasSpringModel::from_toml(&text, "test").unwrap(), m);
        }
    }

    #[test]
    fn too_long_a_stroke_is_an_error() {
        assert!(
            model()
                .pressure_pa(&[0.0, 1.0], &[0.0, 6.0], 1e6)
                .unwrap_err()
                .contains("volume_at_zero_m3")
        );
    }
}
