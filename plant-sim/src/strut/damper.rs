//! Damper packs: the measured pressure drop of a shim stack over flow, read from drop to flow.
//!
//! The packs are those of standard Land Rover rear dampers (seed report, 3.5.2); their law is a table, not a formula,
//! because shim stacks have none that is better than the measurement.

use serde::{Deserialize, Serialize};

use super::characteristic::Characteristic;
use crate::model_file::limits::{as_many, increasing};
use crate::model_file::{Checked, InvalidValue, Limit, Range};

/// Points of a damper's characteristic as they stand in `model.toml`, both columns strictly increasing.
///
/// ```
/// use oleo_plant_sim::strut::DamperTable;
/// let damper = DamperTable {
///     flow_m3_s: vec![-1.0e-3, 0.0, 1.0e-3],
///     pressure_drop_pa: vec![-2.0e6, 0.0, 1.0e6],
/// };
/// assert!((damper.characteristic().value(0.5e6) - 0.5e-3).abs() < 1e-15);
/// assert_eq!(damper.scaled(2.0).pressure_drop_pa, [-4.0e6, 0.0, 2.0e6]);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DamperTable {
    /// Flow, m3/s, positive out of the main cylinder (jounce).
    pub flow_m3_s: Vec<f64>,
    /// Pressure drop in the direction of that flow, Pa.
    #[serde(rename = "pressure_drop_Pa")]
    pub pressure_drop_pa: Vec<f64>,
}

impl Checked for DamperTable {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::list("flow_m3_s", Range::Finite, "m3/s", |d| &d.flow_m3_s),
        Limit::list("pressure_drop_Pa", Range::Finite, "Pa", |d| &d.pressure_drop_pa),
    ];

    fn check_together(&self) -> Result<(), InvalidValue> {
        increasing("flow_m3_s", &self.flow_m3_s)?;
        increasing("pressure_drop_Pa", &self.pressure_drop_pa)?;
        as_many("pressure_drop_Pa", &self.pressure_drop_pa, "flow_m3_s", &self.flow_m3_s)
    }
}

impl DamperTable {
    /// The same shim stack with every pressure drop multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let pressure_drop_pa = self.pressure_drop_pa.iter().map(|p| p * factor).collect();
        Self {
            flow_m3_s: self.flow_m3_s.clone(),
            pressure_drop_pa,
        }
    }

    /// From pressure drop to flow, as the recordings' model reads the table.
    #[must_use]
    pub fn characteristic(&self) -> Characteristic {
        Characteristic::through(&self.pressure_drop_pa, &self.flow_m3_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> DamperTable {
        DamperTable {
            flow_m3_s: vec![-2e-3, -1e-4, 0.0, 1e-4, 2e-3],
            pressure_drop_pa: vec![-3e6, -4e5, 0.0, 2e5, 1.8e6],
        }
    }

    #[test]
    fn passes_through_its_points_and_goes_on_straight() {
        let (table, mut segment) = (table(), 0);
        let pack = table.characteristic();
        for (q, p) in table.flow_m3_s.iter().zip(&table.pressure_drop_pa) {
            assert!((pack.at(*p, &mut segment).0 - q).abs() < 1e-15);
        }
        let (q, slope) = pack.at(3.4e6, &mut segment);
        assert!((slope - 1.9e-3 / 1.6e6).abs() < 1e-18 && (q - (2e-3 + 1.6e6 * slope)).abs() < 1e-12);
    }
}
