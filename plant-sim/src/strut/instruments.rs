//! What the instruments of a strut show: the faults of one column put together.
//!
//! A fault changes what a column of a recording shows of the truth, in this order: lag, skew, gain, sign, drift, offset, laws without a name.
//! For an output (force, pressures) it is applied to the simulated truth. The displacement is an input: its recording is
//! given, and the truth is found by undoing the faults.

use super::motion::Motion;
use super::terms::sensor::{drift, gain, lag, skew};
use super::terms::{COLUMNS, Effects, InstrumentLaws, SensorEffect};

/// The faults of one column; every number as in its file, what is absent as no fault.
struct Faults {
    lag_s: Option<f64>,
    skew_s: Option<f64>,
    gain: f64,
    sign: f64,
    drift_per_s: f64,
    offset: f64,
}

impl Faults {
    fn of(effects: &Effects, column: &str) -> Self {
        let size = |effect: &Option<SensorEffect>| effect.as_ref().and_then(|all| all.get(column).copied());
        Self {
            lag_s: size(&effects.sensor_lag).filter(|tau| *tau > 0.0),
            skew_s: size(&effects.sensor_skew),
            gain: size(&effects.sensor_gain).unwrap_or(0.0),
            sign: size(&effects.sensor_sign).unwrap_or(1.0),
            drift_per_s: size(&effects.sensor_drift).unwrap_or(0.0),
            offset: size(&effects.sensor_offset).unwrap_or(0.0),
        }
    }

    /// What the truth is multiplied by.
    fn factor(&self) -> f64 {
        self.sign * gain::factor(self.gain)
    }

    fn changes_scale_or_zero(&self) -> bool {
        (self.factor(), self.drift_per_s, self.offset) != (1.0, 0.0, 0.0)
    }
}

/// Make of a true signal what the instrument of a column records. `times_s` increase and are as many as the samples.
///
/// ```
/// use oleo_plant_sim::strut::{Effects, record_column};
/// let mut effects = Effects::default();
/// effects.sensor_gain.get_or_insert_default().insert("p1_Pa".to_owned(), 0.02);
/// let mut p1_pa = [1.0e6, 2.0e6];
/// record_column(&effects, "p1_Pa", &[0.0, 0.1], &mut p1_pa);
/// assert_eq!(p1_pa, [1.02e6, 2.04e6]);
/// ```
pub fn record_column(effects: &Effects, column: &str, times_s: &[f64], signal: &mut [f64]) {
    let faults = Faults::of(effects, column);
    if let Some(tau) = faults.lag_s {
        lag::record(tau, times_s, signal);
    }
    if let Some(late) = faults.skew_s {
        skew::record(late, times_s, signal);
    }
    if faults.changes_scale_or_zero() {
        let (factor, begin) = (faults.factor(), times_s.first().copied().unwrap_or(0.0));
        for (value, t) in signal.iter_mut().zip(times_s) {
            *value = factor * *value + drift::shift(faults.drift_per_s, t - begin) + faults.offset;
        }
    }
    if let Some(laws) = InstrumentLaws::of(&effects.unlisted, column) {
        laws.record(times_s, signal);
    }
}

/// The true value behind the first reading of an instrument, as far as its scale and zero say: lags, skews and laws without a name are left out.
///
/// ```
/// use oleo_plant_sim::strut::{Effects, true_first_value};
/// let mut effects = Effects::default();
/// effects.sensor_gain.get_or_insert_default().insert("p1_Pa".to_owned(), 0.02);
/// assert!((true_first_value(&effects, "p1_Pa", 1.02e6) - 1.0e6).abs() < 1e-6);
/// ```
#[must_use]
pub fn true_first_value(effects: &Effects, column: &str, reading: f64) -> f64 {
    let faults = Faults::of(effects, column);
    (reading - faults.offset) / faults.factor()
}

/// The true motion behind the recording of a faulty displacement sensor. `None` if the model has no such fault.
pub(super) fn true_motion(effects: &Effects, times_s: &[f64], recorded: &Motion) -> Option<Motion> {
    let all = [
        &effects.sensor_lag,
        &effects.sensor_gain,
        &effects.sensor_drift,
        &effects.sensor_skew,
        &effects.sensor_sign,
        &effects.sensor_offset,
    ];
    let [displacement, ..] = COLUMNS;
    let laws = InstrumentLaws::of(&effects.unlisted, displacement);
    let has_fault = (all.into_iter().flatten()).any(|effect| effect.contains_key(displacement));
    if !has_fault && laws.is_none() {
        return None;
    }
    let faults = Faults::of(effects, displacement);
    let mut motion = recorded.clone();
    if let Some(laws) = laws {
        laws.undo(times_s, &mut motion);
    }
    if !has_fault {
        return Some(motion);
    }
    let begin = times_s.first().copied().unwrap_or(0.0);
    let (inverse, rate) = (1.0 / faults.factor(), faults.drift_per_s);
    motion.start_m = inverse * (motion.start_m - faults.offset);
    for (segment, t) in motion.segments.iter_mut().zip(times_s.iter().skip(1)) {
        segment.to_m = inverse * (segment.to_m - faults.offset - drift::shift(rate, t - begin));
        segment.from_m_s = inverse * (segment.from_m_s - rate);
        segment.to_m_s = inverse * (segment.to_m_s - rate);
    }
    if let Some(late) = faults.skew_s {
        skew::undo(late, times_s, &mut motion);
    }
    if let Some(tau) = faults.lag_s {
        lag::undo(tau, times_s, &mut motion);
    }
    Some(motion)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::motion::Segment;
    use crate::strut::terms::TermId;

    /// The same fault of the displacement's and of p1's instrument.
    fn only(fault: TermId, value: f64) -> Effects {
        let mut effects = Effects::default();
        let both = SensorEffect::from([("displacement_m".to_owned(), value), ("p1_Pa".to_owned(), value)]);
        *effects.sensor_fault_mut(fault).expect("a fault of an instrument") = Some(both);
        effects
    }

    #[test]
    fn every_fault_is_what_it_says_and_only_in_its_column() {
        let t: Vec<f64> = (0..400).map(|i| 0.002 * f64::from(i)).collect();
        let truth = |t: f64| 3.0 + 5.0 * t;
        for (fault, value, shown) in [
            (TermId::SensorGain, 0.1, 1.1 * truth(t[300])),
            (TermId::SensorDrift, 2.0, truth(t[300]) + 2.0 * t[300]),
            (TermId::SensorSign, -1.0, -truth(t[300])),
            (TermId::SensorOffset, 0.5, truth(t[300]) + 0.5),
            (TermId::SensorSkew, 0.013, truth(t[300] - 0.013)),
            (TermId::SensorLag, 0.02, truth(t[300] - 0.02)),
        ] {
            let mut y: Vec<f64> = t.iter().map(|t| truth(*t)).collect();
            record_column(&only(fault, value), "p1_Pa", &t, &mut y);
            assert!((y[300] - shown).abs() < 1e-6, "{fault} {value}: {} {shown}", y[300]);
            let mut other = vec![1.0; 400];
            record_column(&only(fault, value), "p2_Pa", &t, &mut other);
            assert!(other.iter().all(|v| *v == 1.0));
        }
    }

    #[test]
    fn the_faults_of_a_displacement_sensor_are_undone() {
        // A motion of constant acceleration, as the faulty sensor records it, in segments that hold it exactly.
        let t: Vec<f64> = (0..400).map(|i| 0.002 * f64::from(i)).collect();
        let a = 0.8;
        for (fault, value) in [
            (TermId::SensorLag, 0.01),
            (TermId::SensorSkew, 0.006),
            (TermId::SensorGain, 0.03),
            (TermId::SensorDrift, 1e-3),
            (TermId::SensorSign, -1.0),
            (TermId::SensorOffset, 2e-4),
        ] {
            let effects = only(fault, value);
            let mut shown: Vec<f64> = t.iter().map(|t| 0.5 * a * t * t).collect();
            record_column(&effects, "displacement_m", &t, &mut shown);
            let speed = |k: usize| {
                let (before, after) = (shown[k.max(1) - 1], shown[(k + 1).min(399)]);
                (after - before) / 0.004
            };
            let segments = (1..400).map(|k| Segment {
                to_m: shown[k],
                from_m_s: speed(k - 1),
                to_m_s: speed(k),
            });
            let recorded = Motion {
                start_m: shown[0],
                segments: segments.collect(),
            };
            let found = true_motion(&effects, &t, &recorded).expect("a faulty displacement");
            let (segment, exact) = (found.segments[250], 0.5 * a * t[251] * t[251]);
            // The lag's answer to a ramp from sample to sample is its answer to the parabola to (a/2) dt tau.
            assert!((segment.to_m - exact).abs() < 2e-5, "{fault}: {} {exact}", segment.to_m);
            assert!(
                (segment.to_m_s - a * t[251]).abs() < 5e-3,
                "{fault}: {}",
                segment.to_m_s
            );
        }
        assert!(
            true_motion(
                &Effects::default(),
                &t,
                &Motion {
                    start_m: 0.0,
                    segments: vec![]
                }
            )
            .is_none()
        );
    }
}
