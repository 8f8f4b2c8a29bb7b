//! A damper on a dynamometer: it is moved, and its force is measured.
//!
//! `F = c v + F_offset` is what the model of every damper has. The effects add their forces, compression positive.

use serde::{Deserialize, Serialize};

use super::effects::MechanismEffects;
use crate::model_file::instruments::{check_noise, check_noise_is_complete, check_tolerance};
use crate::model_file::{Checked, InvalidValue, Limit, ModelFileError, Range, checked, read};
use crate::specimen::name::SpecimenName;
use crate::specimen::smoothed_motion::{SmoothedMotion, mean_interval_s, smooth_motion};
use crate::strut::SensorEffect;

/// What the model of every damper has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Damper {
    /// Force over speed, N s/m, 0 or more.
    #[serde(rename = "viscous_N_s_m")]
    pub viscous_n_s_m: f64,
    /// Force at rest, N.
    #[serde(rename = "offset_N")]
    pub offset_n: f64,
}

impl Checked for Damper {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("viscous_N_s_m", Range::FromTo(0.0, 1e9), "N s/m", |d| d.viscous_n_s_m),
        Limit::one("offset_N", Range::FromTo(-1e9, 1e9), "N", |d| d.offset_n),
    ];
}

/// The `model.toml` of a damper.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DamperModel {
    /// Name and kind of the specimen.
    pub specimen: SpecimenName,
    /// What the model of every damper has.
    pub damper: Damper,
    /// Effects that the model contains.
    #[serde(default)]
    pub effects: MechanismEffects,
    /// How far values may be off: `viscous` relative, `offset_N`.
    #[serde(default)]
    pub tolerance: SensorEffect,
    /// Standard deviation of the noise by column.
    #[serde(default)]
    pub noise: SensorEffect,
}

/// Column of the load cell, which is compared with the model.
const FORCE: &str = "force_N";
/// All channels of a damper.
const CHANNELS: [&str; 2] = ["displacement_m", FORCE];
/// Half window over which the motion is smoothed, in samples.
const SMOOTHING_SAMPLES: f64 = 5.0;

impl Checked for DamperModel {
    const LIMITS: &'static [Limit<Self>] = &[];

    fn check_together(&self) -> Result<(), InvalidValue> {
        checked(&self.specimen, "specimen")?;
        checked(&self.damper, "damper")?;
        checked(&self.effects, "effects")?;
        self.effects.check_sensors(FORCE)?;
        check_tolerance(&self.tolerance, &["viscous", "offset_N"])?;
        check_noise(&self.noise, &CHANNELS)
    }
}

impl DamperModel {
    /// Refuse a model that does not state the noise of both channels, which only a diagnosis needs. The displacement, which is
    /// not compared, may be without noise (0).
    ///
    /// # Errors
    /// The channels whose noise is missing, or a force without noise.
    pub fn check_noise_is_complete(&self) -> Result<(), InvalidValue> {
        check_noise_is_complete(&self.noise, &CHANNELS, &[FORCE])
    }

    /// Read and check a model. `file` is the name that appears in errors.
    ///
    /// ```
    /// use oleo_plant_sim::specimen::DamperModel;
    /// let text = "[specimen]\nname = \"a\"\nkind = \"damper\"\n[damper]\nviscous_N_s_m = 1500.0\noffset_N = 20.0\n";
    /// let model = DamperModel::from_toml(text, "model.toml").unwrap();
    /// // 0.2 m/s in compression, sampled at 100 Hz.
    /// let time_s: Vec<f64> = (0..100).map(|k| 0.01 * f64::from(k)).collect();
    /// let displacement_m: Vec<f64> = time_s.iter().map(|t| 0.2 * t).collect();
    /// let force_n = model.force_n(&DamperModel::motion(&time_s, &displacement_m)).unwrap();
    /// assert!((force_n[50] - 320.0).abs() < 1e-6);
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

    /// The motion of a recording, freed of noise.
    #[must_use]
    pub fn motion(time_s: &[f64], displacement_m: &[f64]) -> SmoothedMotion {
        smooth_motion(time_s, displacement_m, SMOOTHING_SAMPLES * mean_interval_s(time_s))
    }

    /// Force on the damper at every sample of a motion, before the load cell, N. Presliding friction begins without force.
    ///
    /// # Errors
    /// A stroke that would leave no gas volume.
    pub fn force_n(&self, motion: &SmoothedMotion) -> Result<Vec<f64>, String> {
        let effects = &self.effects;
        let mass = effects.further_mass_kg();
        if let Some(gas) = &effects.gas_spring {
            gas.check_reaches(motion.displacement_m.iter().copied().fold(f64::NEG_INFINITY, f64::max))?;
        }
        let (mut friction, mut behind) = (0.0, motion.displacement_m.first().copied().unwrap_or(0.0));
        let mut before = behind;
        let samples = (motion.displacement_m.iter())
            .zip(&motion.speed_m_s)
            .zip(&motion.acceleration_m_s2);
        let mut forces = Vec::with_capacity(motion.displacement_m.len());
        for ((&x, &v), &a) in samples {
            // Behind a gap the damper follows the part of the step that is beyond the gap.
            let (position, stroke, share) = match &effects.backlash {
                None => (x, x - before, 1.0),
                Some(gap) => {
                    let next = gap.behind_m(behind, x);
                    let (stroke, step) = (next - behind, x - before);
                    let share = if step == 0.0 {
                        0.0
                    } else {
                        (stroke / step).clamp(0.0, 1.0)
                    };
                    (next, stroke, share)
                }
            };
            let speed = share * v;
            friction = effects.friction_after_n(friction, stroke, speed);
            let resistance = effects.resistance(position, speed).0;
            forces.push(
                self.damper.offset_n + self.damper.viscous_n_s_m * speed + resistance + friction + mass * share * a,
            );
            (behind, before) = (position, x);
        }
        Ok(forces)
    }

    /// What the load cell shows of the force.
    #[must_use]
    pub fn shown(&self, time_s: &[f64], force_n: Vec<f64>) -> Vec<f64> {
        self.effects.shown(FORCE, time_s, force_n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen::mechanism::{
        Backlash, CoulombFriction, ForceOffset, Inertia, PreslidingFriction, SmoothYield, Stiffness,
    };

    fn damper() -> DamperModel {
        let text = "[specimen]\nname='a'\nkind='damper'\n[damper]\nviscous_N_s_m=1000.0\noffset_N=5.0\n";
        DamperModel::from_toml(text, "test").unwrap()
    }

    /// A sine of 10 mm at 1 Hz with its exact derivatives.
    fn sine() -> SmoothedMotion {
        let w = std::f64::consts::TAU;
        let at = |f: &dyn Fn(f64) -> f64| (0..2001).map(|k| f(0.001 * f64::from(k))).collect();
        SmoothedMotion {
            displacement_m: at(&|t| 0.01 * libm::sin(w * t)),
            speed_m_s: at(&|t| 0.01 * w * libm::cos(w * t)),
            acceleration_m_s2: at(&|t| -0.01 * w * w * libm::sin(w * t)),
        }
    }

    #[test]
    fn forces_add_up() {
        let mut model = damper();
        model.effects.coulomb_friction = Some(CoulombFriction { coulomb_force_n: 30.0 });
        model.effects.smooth_yield = Some(SmoothYield {
            yield_force_n: 200.0,
            yield_speed_m_s: 0.02,
        });
        model.effects.force_offset = Some(ForceOffset { force_n: -12.0 });
        model.effects.stiffness = Some(Stiffness { stiffness_n_m: 4000.0 });
        model.effects.inertia = Some(Inertia { moving_mass_kg: 3.0 });
        let (motion, force) = (sine(), model.force_n(&sine()).unwrap());
        for k in [100, 333, 700, 1801] {
            let (x, v, a) = (
                motion.displacement_m[k],
                motion.speed_m_s[k],
                motion.acceleration_m_s2[k],
            );
            let expected =
                5.0 - 12.0 + 1000.0 * v + 30.0_f64.copysign(v) + 200.0 * libm::tanh(v / 0.02) + 4000.0 * x + 3.0 * a;
            assert!((force[k] - expected).abs() < 1e-9, "{k}");
        }
    }

    /// Work that presliding friction takes in a full cycle between reversals far apart against `g/k`: `4 X g - 4 g^2/k`, each
    /// reversal rounding the corner by the area `2 g^2/k`.
    #[test]
    fn a_cycle_of_presliding_friction_dissipates_the_closed_form() {
        let mut model = damper();
        model.damper = Damper {
            viscous_n_s_m: 0.0,
            offset_n: 0.0,
        };
        model.effects.presliding_friction = Some(PreslidingFriction {
            coulomb_force_n: 100.0,
            presliding_stiffness_n_m: 1e6,
            breakaway_force_n: None,
            stribeck_speed_m_s: None,
        });
        let (motion, force) = (sine(), model.force_n(&sine()).unwrap());
        // The second cycle, from the turning point at 0.75 s to that at 1.75 s.
        let work: f64 = (750..1750)
            .map(|k| 0.5 * (force[k] + force[k + 1]) * (motion.displacement_m[k + 1] - motion.displacement_m[k]))
            .sum();
        let expected = 4.0 * 0.01 * 100.0 - 4.0 * 100.0 * 100.0 / 1e6;
        assert!((work / expected - 1.0).abs() < 1e-3, "{work} {expected}");
    }

    #[test]
    fn a_gap_keeps_the_damper_still_after_each_reversal() {
        let mut model = damper();
        model.effects.backlash = Some(Backlash { gap_m: 0.002 });
        let (motion, force) = (sine(), model.force_n(&sine()).unwrap());
        // After the turning point at 0.25 s nothing follows until the motion has come back by 2 mm.
        let follows = (250..750).find(|&k| (force[k] - 5.0).abs() > 1.0).expect("it follows");
        assert!((motion.displacement_m[follows] - 0.008).abs() < 1e-4);
        // Beyond the gap it is the damper again.
        assert!((force[500] - 5.0 - 1000.0 * motion.speed_m_s[500]).abs() < 1e-6);
    }

    #[test]
    fn what_is_written_is_read_again() {
        let mut model = damper();
        model.effects.smooth_yield = Some(SmoothYield {
            yield_force_n: 200.0,
            yield_speed_m_s: 0.02,
        });
        model.effects.sensor_skew = Some(SensorEffect::from([("force_N".to_owned(), 0.002)]));
        let text = model.to_toml().unwrap();
        assert_eq!(DamperModel::from_toml(&text, "again"), Ok(model));
    }
}
