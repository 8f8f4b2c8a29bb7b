//! The instruments as candidates: every column may lag, be late, read high, or drift. They are the same for every kind
//! of specimen, and they are judged before physics is.

use super::Candidate;
use crate::parameter::Parameter;

/// Faults of the instrument behind one column.
///
/// `size` is the column's largest departure from rest; it makes gain and drift start at a visible amount.
/// `interval_s` is the sampling interval.
#[must_use]
pub fn faults(column: &str, size: f64, duration_s: f64, interval_s: f64) -> Vec<Candidate> {
    let make = |id: &'static str, parameter: Parameter, starts: Vec<Vec<f64>>| Candidate {
        id,
        place: format!("sensor:{column}"),
        label: String::new(),
        parameters: vec![parameter.on_instrument()],
        starts,
        instrument: true,
        group: "",
        untestable: None,
    };
    let unit = column.rsplit_once('_').map_or("", |(_, unit)| unit);
    let drift = size.max(1e-12) / duration_s.max(1e-9);
    let short = interval_s.max(1e-4);
    vec![
        make(
            "sensor_lag",
            Parameter::amount("time_constant_s", 0.5 * short, 1e3 * short),
            vec![],
        ),
        make(
            "sensor_skew",
            Parameter::linear("delay_s", 0.0, short, (-50.0 * short, 50.0 * short)),
            vec![],
        ),
        make(
            "sensor_gain",
            Parameter::linear("relative_error", 0.0, 0.01, (-0.6, 0.6)),
            vec![],
        ),
        make(
            "sensor_drift",
            Parameter::linear(format!("drift_{unit}_s"), 0.0, 0.01 * drift, (-drift, drift)),
            vec![],
        ),
    ]
}
