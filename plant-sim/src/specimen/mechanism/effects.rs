//! The table `[effects]` of a damper's or a drive's model file.

use serde::{Deserialize, Serialize};

use super::backlash::Backlash;
use super::coulomb_friction::CoulombFriction;
use super::force_offset::ForceOffset;
use super::gas_spring::ParallelGasSpring;
use super::inertia::Inertia;
use super::presliding_friction::PreslidingFriction;
use super::smooth_yield::SmoothYield;
use super::stiffness::Stiffness;
use super::stribeck_friction::StribeckFriction;
use super::unnamed::UnnamedForces;
use crate::model_file::{Checked, InvalidValue, Limit, checked};
use crate::strut::{Effects, SensorEffect, TermId, check_columns, record_column};

/// Effects that a damper or a drive may have beside what its model always has.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MechanismEffects {
    /// Dry friction of constant size.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coulomb_friction: Option<CoulombFriction>,
    /// Dry friction that falls with speed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stribeck_friction: Option<StribeckFriction>,
    /// Dry friction with an elastic displacement before it slides.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub presliding_friction: Option<PreslidingFriction>,
    /// A force that saturates with speed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smooth_yield: Option<SmoothYield>,
    /// A constant force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_offset: Option<ForceOffset>,
    /// A linear spring in parallel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stiffness: Option<Stiffness>,
    /// A gas spring in parallel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gas_spring: Option<ParallelGasSpring>,
    /// A gap in a joint: between the moved end and a damper, or between a drive's mass and its position sensor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub backlash: Option<Backlash>,
    /// A mass beside that of the model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inertia: Option<Inertia>,
    /// Forces that the vocabulary has no name for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unlisted: Option<UnnamedForces>,
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
    /// Columns with the wrong sign: -1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_sign: Option<SensorEffect>,
}

impl Checked for MechanismEffects {
    const LIMITS: &'static [Limit<Self>] = &[];

    fn check_together(&self) -> Result<(), InvalidValue> {
        fn present<T: Checked>(term: Option<&T>, key: &'static str) -> Result<(), InvalidValue> {
            term.map_or(Ok(()), |term| checked(term, key))
        }
        present(self.coulomb_friction.as_ref(), "coulomb_friction")?;
        present(self.stribeck_friction.as_ref(), "stribeck_friction")?;
        present(self.presliding_friction.as_ref(), "presliding_friction")?;
        present(self.smooth_yield.as_ref(), "smooth_yield")?;
        present(self.force_offset.as_ref(), "force_offset")?;
        present(self.stiffness.as_ref(), "stiffness")?;
        present(self.gas_spring.as_ref(), "gas_spring")?;
        present(self.backlash.as_ref(), "backlash")?;
        present(self.inertia.as_ref(), "inertia")?;
        present(self.unlisted.as_ref(), "unlisted")
    }
}

impl MechanismEffects {
    /// The force that resists at a displacement (m) and a speed (m/s), N, and its slope over speed, N s/m: everything but dry
    /// friction, which has a state, and inertia, which needs an acceleration.
    #[must_use]
    pub fn resistance(&self, displacement_m: f64, speed_m_s: f64) -> (f64, f64) {
        let (mut force, mut slope) = self
            .unlisted
            .as_ref()
            .map_or((0.0, 0.0), |unnamed| unnamed.force_and_slope(displacement_m, speed_m_s));
        if let Some(smooth) = &self.smooth_yield {
            let (more, steeper) = smooth.force_and_slope(speed_m_s);
            force += more;
            slope += steeper;
        }
        if let Some(offset) = &self.force_offset {
            force += offset.force_n;
        }
        if let Some(spring) = &self.stiffness {
            force += spring.stiffness_n_m * displacement_m;
        }
        if let Some(gas) = &self.gas_spring {
            force += gas.force_n(displacement_m);
        }
        (force, slope)
    }

    /// Mass beside that of the model, kg.
    #[must_use]
    pub fn further_mass_kg(&self) -> f64 {
        self.inertia.as_ref().map_or(0.0, |inertia| inertia.moving_mass_kg)
    }

    /// The faulty columns of one kind of instrument fault; `None` for an id that is no fault of these instruments.
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

    /// Size of a fault of a column; `None` where its instrument has none.
    pub(super) fn fault(&self, id: TermId, column: &str) -> Option<f64> {
        let table = match id {
            TermId::SensorLag => &self.sensor_lag,
            TermId::SensorGain => &self.sensor_gain,
            TermId::SensorDrift => &self.sensor_drift,
            TermId::SensorSkew => &self.sensor_skew,
            TermId::SensorSign => &self.sensor_sign,
            _ => return None,
        };
        table.as_ref()?.get(column).copied()
    }

    /// Refuse a fault of another column than the one that is compared with the model.
    ///
    /// # Errors
    /// The column, or a size outside its range.
    pub(super) fn check_sensors(&self, compared: &str) -> Result<(), InvalidValue> {
        for (id, fault) in [
            (TermId::SensorLag, &self.sensor_lag),
            (TermId::SensorGain, &self.sensor_gain),
            (TermId::SensorDrift, &self.sensor_drift),
            (TermId::SensorSkew, &self.sensor_skew),
            (TermId::SensorSign, &self.sensor_sign),
        ] {
            check_columns(id, fault.as_ref(), &[compared]).map_err(|invalid| invalid.inside("effects"))?;
        }
        Ok(())
    }

    /// What the instrument of a column shows of its true values.
    pub(super) fn shown(&self, column: &str, time_s: &[f64], mut truth: Vec<f64>) -> Vec<f64> {
        let instruments = Effects {
            sensor_lag: self.sensor_lag.clone(),
            sensor_gain: self.sensor_gain.clone(),
            sensor_drift: self.sensor_drift.clone(),
            sensor_skew: self.sensor_skew.clone(),
            sensor_sign: self.sensor_sign.clone(),
            ..Effects::default()
        };
        record_column(&instruments, column, time_s, &mut truth);
        truth
    }
}
