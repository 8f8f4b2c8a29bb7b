//! A recording's inputs through a model: what the instruments should have read.

use super::input::{Motion, smooth_displacement};
use super::model::{ModelError, StrutModel};
use super::network::Strut;
use super::sensor;

/// Inputs of a recording: time, actuator motion, switching signals.
#[derive(Debug, Clone, PartialEq)]
pub struct Inputs {
    /// Sample times, s, increasing.
    pub time_s: Vec<f64>,
    /// Motion between the samples.
    pub motion: Motion,
    /// Switching signals at each sample; an edge acts from its sample on.
    pub signals: Vec<[bool; 3]>,
}

impl Inputs {
    /// Inputs from recorded columns of equal length; the displacement is smoothed by its stated noise, m.
    #[must_use]
    pub fn from_recording(time_s: &[f64], displacement_m: &[f64], signals: &[[bool; 3]], noise_m: f64) -> Self {
        let intervals = time_s.len().saturating_sub(1).max(1) as f64;
        let interval = match (time_s.first(), time_s.last()) {
            (Some(a), Some(b)) if b > a => (b - a) / intervals,
            _ => 1.0,
        };
        Self {
            time_s: time_s.to_vec(),
            motion: smooth_displacement(displacement_m, interval, noise_m),
            signals: signals.to_vec(),
        }
    }
}

/// Predicted columns, one value a sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Prediction {
    /// Load cell, N.
    pub force_n: Vec<f64>,
    /// Gauge pressures p1 to p4, Pa.
    pub pressure_pa: [Vec<f64>; 4],
}

/// Simulate a recording's inputs with a model. O(samples); the same bits every time.
///
/// # Errors
/// Impossible values in the model.
pub fn replay(model: &StrutModel, inputs: &Inputs) -> Result<Prediction, ModelError> {
    let n = inputs.time_s.len();
    let first = inputs.signals.first().copied().unwrap_or_default();
    let effects = &model.effects;
    let faulty = [
        &effects.sensor_lag,
        &effects.sensor_gain,
        &effects.sensor_drift,
        &effects.sensor_skew,
        &effects.sensor_sign,
        &effects.sensor_offset,
    ]
    .iter()
    .any(|m| m.as_ref().is_some_and(|m| m.contains_key("displacement_m")));
    let undone = faulty.then(|| sensor::undo(effects, &inputs.time_s, &inputs.motion));
    let motion = undone.as_ref().unwrap_or(&inputs.motion);
    let mut strut = Strut::at_rest_at(model, first, motion.start_m)?;
    let mut out = Prediction {
        force_n: Vec::with_capacity(n),
        pressure_pa: std::array::from_fn(|_| Vec::with_capacity(n)),
    };
    let mut keep = |o: super::network::StrutOutput| {
        out.force_n.push(o.force_n);
        out.pressure_pa
            .iter_mut()
            .zip(o.pressure_pa)
            .for_each(|(to, p)| to.push(p));
    };
    if n > 0 {
        keep(strut.output());
    }
    for (i, s) in motion.segments.iter().enumerate() {
        let dt = inputs.time_s[i + 1] - inputs.time_s[i];
        let (signals, at) = (inputs.signals[i], strut.displacement_m());
        let (begins, takes) = s.moves_within(at, dt);
        if begins > 0.0 {
            strut.advance(at, begins, signals);
        }
        let mut output = strut.advance_with_speeds(s.to_m, s.from_m_s, s.to_m_s, takes, signals);
        if begins + takes < dt {
            output = strut.advance(s.to_m, dt - (begins + takes), signals);
        }
        keep(output);
    }
    sensor::record(effects, "force_N", &inputs.time_s, &mut out.force_n);
    for (column, signal) in sensor::COLUMNS[2..].iter().zip(&mut out.pressure_pa) {
        sensor::record(effects, column, &inputs.time_s, signal);
    }
    Ok(out)
}
