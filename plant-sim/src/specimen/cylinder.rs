//! A cylinder on a test machine: pressures on areas, friction of its seals, its moving mass.
//!
//! `F = sum(A_i p_i) + friction(v, p) + m a`. Displacement positive in the direction that compresses, friction positive
//! against it. The friction is the strut's (Coulomb and Stribeck with Dahl presliding), and may grow with pressure:
//! lip seals are pressed on by what they seal.

use serde::{Deserialize, Serialize};

use super::name::SpecimenName;
use super::smoothed_motion::SmoothedMotion;
use crate::model_file::instruments::{check_noise, check_noise_is_complete, check_tolerance};
use crate::model_file::limits::each_checked;
use crate::model_file::{Checked, InvalidValue, Limit, ModelFileError, Range, checked, read};
use crate::strut::{
    Effects, Equation, PRESLIDING_STIFFNESS_N_M, SensorEffect, SideLoadFriction, TermId, advance_friction,
    check_columns, record_column,
};

/// A pressure acting on an area.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CylinderChamber {
    /// Column of the pressure.
    pub column: String,
    /// Area, m2; negative for the side that pushes the other way.
    pub area_m2: f64,
}

impl Checked for CylinderChamber {
    const LIMITS: &'static [Limit<Self>] = &[Limit::one("area_m2", Range::FromTo(-10.0, 10.0), "m2", |c| c.area_m2)];

    fn check_together(&self) -> Result<(), InvalidValue> {
        if self.area_m2.abs() < LEAST_AREA_M2 {
            let what = format!(
                "is {}: must be at least {LEAST_AREA_M2:e} m2 on either side",
                self.area_m2
            );
            return Err(InvalidValue::new("area_m2", what));
        }
        Ok(())
    }
}

/// A hundredth of a square millimetre: a smaller area is a slip of the unit.
const LEAST_AREA_M2: f64 = 1e-8;

/// Friction of the cylinder's seal. Where only the part that grows with pressure is present the Coulomb force is zero.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CylinderSeal {
    /// Coulomb friction force, N, 0 or more.
    #[serde(rename = "coulomb_force_N")]
    pub coulomb_force_n: f64,
    /// Stiffness of the seal before it slides, N/m.
    #[serde(rename = "presliding_stiffness_N_m")]
    pub presliding_stiffness_n_m: f64,
}

impl Checked for CylinderSeal {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("coulomb_force_N", Range::FromTo(0.0, 1e9), "N", |s| s.coulomb_force_n),
        Limit::one("presliding_stiffness_N_m", Range::FromTo(1e-3, 1e15), "N/m", |s| {
            s.presliding_stiffness_n_m
        }),
    ];
}

/// Terms a cylinder may have.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CylinderEffects {
    /// Friction of the seal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seal_friction: Option<CylinderSeal>,
    /// Friction over `sum |A_i p_i|`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub side_load_friction: Option<SideLoadFriction>,
    /// Unlisted: moving mass, kg.
    #[serde(rename = "moving_mass_kg", skip_serializing_if = "Option::is_none")]
    pub moving_mass_kg: Option<f64>,
    /// Unlisted: viscous friction, N s/m.
    #[serde(rename = "viscous_friction_N_s_m", skip_serializing_if = "Option::is_none")]
    pub viscous_friction_n_s_m: Option<f64>,
    /// Unlisted: force over displacement, N/m.
    #[serde(rename = "parallel_stiffness_N_m", skip_serializing_if = "Option::is_none")]
    pub parallel_stiffness_n_m: Option<f64>,
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
    /// Columns whose instrument is connected the wrong way round, each -1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_sign: Option<SensorEffect>,
    /// Offsets of columns: calibration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_offset: Option<SensorEffect>,
}

/// A part of the force beside pressure and friction: a mass, a viscous friction or a stiffness, of either sign so that a
/// fit may cross zero.
const FORCE_PART: Range = Range::FromTo(-1e12, 1e12);

impl CylinderEffects {
    /// Friction of the seal: Dahl's equation with the level `g`.
    pub const SEAL_FRICTION: Equation = Equation {
        text: "dF/dx = k (1 - sgn(v) F / g), g = F_c",
        source: "Dahl 1968; Coulomb",
    };

    /// Friction that grows with pressure: what it adds to the level.
    pub const SIDE_LOAD_FRICTION: Equation = Equation {
        text: "g = mu sum |A_i p_i| / (1 + s x)",
        source: "Theron & Els, final report 2002, section 3.5.1",
    };

    /// Equation of [`CylinderEffects::moving_mass_kg`].
    pub const MOVING_MASS: Equation = Equation {
        text: "F = m d2x/dt2",
        source: "Newton's second law; no name in the vocabulary",
    };

    /// Equation of [`CylinderEffects::viscous_friction_n_s_m`].
    pub const VISCOUS_FRICTION: Equation = Equation {
        text: "F = c dx/dt",
        source: "Newton's law of viscosity; no name in the vocabulary",
    };

    /// Equation of [`CylinderEffects::parallel_stiffness_n_m`].
    pub const PARALLEL_STIFFNESS: Equation = Equation {
        text: "F = k x",
        source: "Hooke's law; no name in the vocabulary",
    };

    /// The faulty columns of one kind of instrument fault; `None` for an id that is no fault of its instruments.
    pub fn sensor_fault_mut(&mut self, id: TermId) -> Option<&mut Option<SensorEffect>> {
        match id {
            TermId::SensorLag => Some(&mut self.sensor_lag),
            TermId::SensorGain => Some(&mut self.sensor_gain),
            TermId::SensorDrift => Some(&mut self.sensor_drift),
            TermId::SensorSkew => Some(&mut self.sensor_skew),
            TermId::SensorSign => Some(&mut self.sensor_sign),
            _ => None,
        }
    }
}

impl Checked for CylinderEffects {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::optional("moving_mass_kg", FORCE_PART, "kg", |e| e.moving_mass_kg),
        Limit::optional("viscous_friction_N_s_m", FORCE_PART, "N s/m", |e| {
            e.viscous_friction_n_s_m
        }),
        Limit::optional("parallel_stiffness_N_m", FORCE_PART, "N/m", |e| {
            e.parallel_stiffness_n_m
        }),
    ];

    fn check_together(&self) -> Result<(), InvalidValue> {
        if let Some(seal) = &self.seal_friction {
            checked(seal, "seal_friction")?;
        }
        if let Some(side) = &self.side_load_friction {
            checked(side, "side_load_friction")?;
        }
        Ok(())
    }
}

/// The `model.toml` of a cylinder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CylinderModel {
    /// Name and kind of the specimen.
    pub specimen: SpecimenName,
    /// Pressure chambers that act on the piston, one or more.
    pub chamber: Vec<CylinderChamber>,
    /// Effects that the model contains.
    #[serde(default)]
    pub effects: CylinderEffects,
    /// How far values may be off: `area` relative, `force_offset_N`, `pressure_offset_Pa`.
    #[serde(default)]
    pub tolerance: SensorEffect,
    /// Standard deviation of the noise by column.
    #[serde(default)]
    pub noise: SensorEffect,
}

impl Checked for CylinderModel {
    const LIMITS: &'static [Limit<Self>] = &[];

    fn check_together(&self) -> Result<(), InvalidValue> {
        checked(&self.specimen, "specimen")?;
        if self.chamber.is_empty() {
            return Err(InvalidValue::new("chamber", "has no entry: must have one or more"));
        }
        each_checked(&self.chamber, "chamber")?;
        checked(&self.effects, "effects")?;
        let chambers: Vec<&str> = self.chamber.iter().map(|chamber| chamber.column.as_str()).collect();
        let measured: Vec<&str> = std::iter::once(FORCE).chain(chambers.iter().copied()).collect();
        let e = &self.effects;
        for (id, fault) in [
            (TermId::SensorGain, &e.sensor_gain),
            (TermId::SensorDrift, &e.sensor_drift),
            (TermId::SensorSkew, &e.sensor_skew),
            (TermId::SensorSign, &e.sensor_sign),
            (TermId::SensorOffset, &e.sensor_offset),
        ] {
            check_columns(id, fault.as_ref(), &measured).map_err(|invalid| invalid.inside("effects"))?;
        }
        // The lag of a pressure cannot be undone without amplifying its noise.
        check_columns(TermId::SensorLag, e.sensor_lag.as_ref(), &[FORCE])
            .map_err(|invalid| invalid.inside("effects"))?;
        check_tolerance(&self.tolerance, &["area", "force_offset_N", "pressure_offset_Pa"])?;
        check_noise(&self.noise, &self.channels())
    }
}

/// Column of the load cell.
const FORCE: &str = "force_N";

impl CylinderModel {
    /// The displacement, the force, which is compared with the model, and the pressure of every chamber.
    fn channels(&self) -> Vec<&str> {
        let chambers = self.chamber.iter().map(|chamber| chamber.column.as_str());
        ["displacement_m", FORCE].into_iter().chain(chambers).collect()
    }

    /// Refuse a model that does not state the noise of every channel, which only a diagnosis needs. Displacement and
    /// pressures, which are not compared, may be without noise (0).
    ///
    /// # Errors
    /// The channels whose noise is missing, or a force without noise.
    pub fn check_noise_is_complete(&self) -> Result<(), InvalidValue> {
        check_noise_is_complete(&self.noise, &self.channels(), &[FORCE])
    }

    /// Read and check a model. `file` is the name that appears in errors.
    ///
    /// ```
    /// use oleo_plant_sim::specimen::CylinderModel;
    /// let text = "[specimen]\nname = \"a\"\nkind = \"cylinder\"\n[[chamber]]\ncolumn = \"p_Pa\"\narea_m2 = 4.9e-4\n";
    /// let model = CylinderModel::from_toml(text, "model.toml").unwrap();
    /// assert_eq!(model.chamber[0].area_m2, 4.9e-4);
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

    /// Force on the cylinder from motion and pressures (one series a chamber), before the load cell, N.
    #[must_use]
    pub fn force_n(&self, time_s: &[f64], motion: &SmoothedMotion, pressures: &[Vec<f64>]) -> Vec<f64> {
        let effects = &self.effects;
        let pressures: Vec<Vec<f64>> = self
            .chamber
            .iter()
            .zip(pressures)
            .map(|(c, p)| self.corrected(time_s, &c.column, p))
            .collect();
        let stiffness =
            (effects.seal_friction.as_ref()).map_or(PRESLIDING_STIFFNESS_N_M, |seal| seal.presliding_stiffness_n_m);
        let mut friction = 0.0;
        (0..time_s.len())
            .map(|k| {
                let (mut net, mut pressing) = (0.0, 0.0);
                for (chamber, p) in self.chamber.iter().zip(&pressures) {
                    net += chamber.area_m2 * p[k];
                    pressing += (chamber.area_m2 * p[k].max(0.0)).abs();
                }
                if k > 0 {
                    let stroke = motion.displacement_m[k] - motion.displacement_m[k - 1];
                    let mut level = effects.seal_friction.as_ref().map_or(0.0, |seal| seal.coulomb_force_n);
                    if let Some(side) = &effects.side_load_friction {
                        level += side.level_n(pressing, motion.displacement_m[k]);
                    }
                    friction = advance_friction(friction, stroke, level, stiffness);
                }
                net + friction
                    + effects.moving_mass_kg.unwrap_or(0.0) * motion.acceleration_m_s2[k]
                    + effects.viscous_friction_n_s_m.unwrap_or(0.0) * motion.speed_m_s[k]
                    + effects.parallel_stiffness_n_m.unwrap_or(0.0) * motion.displacement_m[k]
            })
            .collect()
    }

    /// A measured pressure put right: what the instrument did is undone (sign, offset, gain, drift, skew).
    fn corrected(&self, time_s: &[f64], column: &str, series: &[f64]) -> Vec<f64> {
        let size = |effect: &Option<SensorEffect>| effect.as_ref().and_then(|e| e.get(column).copied());
        let of = |effect: &Option<SensorEffect>| size(effect).unwrap_or(0.0);
        let (offset, gain, drift) = (
            of(&self.effects.sensor_offset),
            of(&self.effects.sensor_gain),
            of(&self.effects.sensor_drift),
        );
        let delay = of(&self.effects.sensor_skew);
        let factor = (1.0 + gain) * size(&self.effects.sensor_sign).unwrap_or(1.0);
        let mut series: Vec<f64> = series
            .iter()
            .zip(time_s)
            .map(|(p, t)| (p - offset - drift * (t - time_s[0])) / factor)
            .collect();
        if delay != 0.0 {
            let early = SensorEffect::from([(column.to_owned(), -delay)]);
            let early = Effects {
                sensor_skew: Some(early),
                ..Effects::default()
            };
            record_column(&early, column, time_s, &mut series);
        }
        series
    }

    /// What the load cell shows of the force.
    #[must_use]
    pub fn shown(&self, time_s: &[f64], mut force_n: Vec<f64>) -> Vec<f64> {
        let e = &self.effects;
        let instruments = Effects {
            sensor_lag: e.sensor_lag.clone(),
            sensor_gain: e.sensor_gain.clone(),
            sensor_drift: e.sensor_drift.clone(),
            sensor_skew: e.sensor_skew.clone(),
            sensor_sign: e.sensor_sign.clone(),
            sensor_offset: e.sensor_offset.clone(),
            ..Effects::default()
        };
        record_column(&instruments, FORCE, time_s, &mut force_n);
        force_n
    }
}

#[cfg(test)]
mod tests {
    use super::super::smoothed_motion::smooth_motion;
    use super::*;

    /// What the instruments of `record_column` do to a pressure and a force is undone and done.
    #[test]
    fn a_reversed_instrument_is_put_right_or_shown() {
        let mut model = CylinderModel::from_toml(
            "[specimen]\nname='a'\nkind='cylinder'\n[[chamber]]\ncolumn='p_Pa'\narea_m2=0.001\n\
             [effects.sensor_sign]\np_Pa=-1.0\n[effects.sensor_gain]\np_Pa=0.1\n[effects.sensor_offset]\np_Pa=2e3\n",
            "test",
        )
        .unwrap();
        let t: Vec<f64> = (0..50).map(|k| f64::from(k) * 0.01).collect();
        let truth: Vec<f64> = t.iter().map(|t| 1e6 + 1e5 * t).collect();
        let mut read = truth.clone();
        let instruments = Effects {
            sensor_sign: model.effects.sensor_sign.clone(),
            sensor_gain: model.effects.sensor_gain.clone(),
            sensor_offset: model.effects.sensor_offset.clone(),
            ..Effects::default()
        };
        record_column(&instruments, "p_Pa", &t, &mut read);
        assert!(read[0] < -1e6);
        let corrected = model.corrected(&t, "p_Pa", &read);
        let farthest = (corrected.iter().zip(&truth)).map(|(a, b)| (a - b).abs());
        assert!(farthest.fold(0.0, f64::max) < 1e-3);
        model.effects.sensor_sign = Some(SensorEffect::from([(FORCE.to_owned(), -1.0)]));
        assert_eq!(model.shown(&t, vec![7.0; 50]), vec![-7.0; 50]);
        let wrong = model.to_toml().unwrap().replace("force_N = -1.0", "force_N = 2.0");
        assert!(CylinderModel::from_toml(&wrong, "test").is_err());
    }

    #[test]
    fn friction_that_grows_with_pressure_widens_the_loop() {
        let mut model = CylinderModel::from_toml(
            "[specimen]\nname='a'\nkind='cylinder'\n[[chamber]]\ncolumn='p_Pa'\narea_m2=0.001\n",
            "test",
        )
        .unwrap();
        model.effects.seal_friction = Some(CylinderSeal {
            coulomb_force_n: 10.0,
            presliding_stiffness_n_m: 1e6,
        });
        model.effects.side_load_friction = Some(SideLoadFriction {
            coefficient: 0.02,
            overlap_growth_1_m: 0.0,
        });
        let t: Vec<f64> = (0..400).map(|k| f64::from(k) * 0.01).collect();
        let x: Vec<f64> = t.iter().map(|t| 0.01 * libm::sin(*t * 3.0)).collect();
        let f = model.force_n(&t, &smooth_motion(&t, &x, 0.03), &[vec![1e6; 400]]);
        // Pressure force 1000 N, friction 10 + 0.02 * 1000 N on either side.
        let (low, high) = f.iter().fold((f64::MAX, f64::MIN), |(a, b), &v| (a.min(v), b.max(v)));
        assert!((high - 1030.0).abs() < 0.1 && (low - 970.0).abs() < 0.1, "{low} {high}");
    }
}
