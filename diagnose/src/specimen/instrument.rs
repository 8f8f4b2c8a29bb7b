//! The instruments as candidates: every column may lag, be late, read high, or drift. They are the same for every kind
//! of specimen, and they are judged before physics is.

use super::Candidate;
use crate::parameter::Parameter;
use crate::vocabulary::{Column, EffectId, Site};

/// Faults of the instrument behind one column.
///
/// `size` is the column's largest departure from rest; it makes gain and drift start at a visible amount.
/// `interval_s` is the sampling interval.
#[must_use]
pub fn faults(column: &Column, size: f64, duration_s: f64, interval_s: f64) -> Vec<Candidate> {
    let make = |id: EffectId, parameter: Parameter, starts: Vec<Vec<f64>>| Candidate {
        id,
        place: Site::Sensor(column.clone()).into(),
        label: String::new(),
        parameters: vec![parameter.on_instrument()],
        starts,
        group: None,
        untestable: None,
    };
    let drift = size.max(1e-12) / duration_s.max(1e-9);
    let short = interval_s.max(1e-4);
    vec![
        make(
            EffectId::SensorLag,
            Parameter::amount("time_constant_s", 0.5 * short, 1e3 * short),
            vec![],
        ),
        make(
            EffectId::SensorSkew,
            Parameter::linear("delay_s", 0.0, short, (-50.0 * short, 50.0 * short)),
            vec![],
        ),
        make(
            EffectId::SensorGain,
            Parameter::linear("relative_error", 0.0, 0.01, (-0.6, 0.6)),
            vec![],
        ),
        make(
            EffectId::SensorDrift,
            Parameter::linear(format!("drift_{}_s", column.unit()), 0.0, 0.01 * drift, (-drift, drift)),
            vec![],
        ),
    ]
}
