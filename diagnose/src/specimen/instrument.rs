//! The instruments as candidates: every column may lag, be late, have a wrong gain, or drift. They are the same for every
//! kind of specimen, and they are judged before physics is.

use oleo_plant_sim::strut::SensorEffect;

use super::candidate::Candidate;
use crate::parameter::Parameter;
use crate::vocabulary::{Column, EffectId, Site};

/// Shortest sampling interval that starts and ranges are made from, s.
const LEAST_INTERVAL_S: f64 = 1e-4;

/// Faults of the instrument behind one column.
///
/// `size` is the column's largest departure from rest, in its unit; it makes gain and drift start at a visible amount.
/// `interval_s` is the sampling interval.
#[must_use]
pub fn faults(column: &Column, size: f64, duration_s: f64, interval_s: f64) -> Vec<Candidate> {
    let make = |id: EffectId, parameter: Parameter| Candidate {
        id,
        place: Site::Sensor(column.clone()).into(),
        label: String::new(),
        parameters: vec![parameter.on_instrument()],
        starts: vec![],
        group: None,
        untestable: None,
    };
    let drift = size.max(1e-12) / duration_s.max(1e-9);
    let short = interval_s.max(LEAST_INTERVAL_S);
    vec![
        make(
            EffectId::SensorLag,
            Parameter::amount("time_constant_s", 0.5 * short, 1e3 * short),
        ),
        make(
            EffectId::SensorSkew,
            Parameter::linear("delay_s", 0.0, short, (-50.0 * short, 50.0 * short)),
        ),
        make(
            EffectId::SensorGain,
            Parameter::linear("relative_error", 0.0, 0.01, (-0.6, 0.6)),
        ),
        make(
            EffectId::SensorDrift,
            Parameter::linear(format!("drift_{}_s", column.unit()), 0.0, 0.01 * drift, (-drift, drift)),
        ),
    ]
}

/// The tables of a model file that hold instrument faults by column.
pub struct FaultTables<'m> {
    /// First-order lags, s.
    pub lag: &'m mut Option<SensorEffect>,
    /// Delays, s.
    pub skew: &'m mut Option<SensorEffect>,
    /// Relative gain errors.
    pub gain: &'m mut Option<SensorEffect>,
    /// Drifts, unit of the column per second.
    pub drift: &'m mut Option<SensorEffect>,
}

impl FaultTables<'_> {
    /// Writes a fault into its table; what is no fault of an instrument changes nothing.
    pub fn put(self, candidate: &Candidate, value: f64) {
        let table = match candidate.id {
            EffectId::SensorLag => self.lag,
            EffectId::SensorSkew => self.skew,
            EffectId::SensorGain => self.gain,
            EffectId::SensorDrift => self.drift,
            _ => return,
        };
        if let Some(column) = candidate.place.sensor() {
            table.get_or_insert_default().insert(column.to_string(), value);
        }
    }
}
