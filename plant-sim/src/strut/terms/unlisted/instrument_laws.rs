//! The unmodelled laws of one instrument: what it adds to the truth.

use super::argument::LawArgument;
use super::course::Course;
use super::law::{UnlistedLaw, find, law_at};
use super::place::LawPlace;
use super::remembered::Remembered;
use crate::strut::characteristic::Characteristic;
use crate::strut::motion::Motion;
use crate::strut::terms::sensor::lag;

/// What an instrument adds to its reading, over the reading itself, over time, over the rate at which it changes and over what it has changed lately.
#[derive(Debug, Clone)]
pub(in crate::strut) struct InstrumentLaws {
    reading: Option<Characteristic>,
    time: Course,
    rate: Option<Characteristic>,
    change: Remembered,
}

fn value(law: Option<&Characteristic>, argument: f64) -> f64 {
    law.map_or(0.0, |law| law.value(argument))
}

fn slope(law: Option<&Characteristic>, argument: f64) -> f64 {
    law.map_or(0.0, |law| law.at(argument, &mut 0).1)
}

impl InstrumentLaws {
    /// The laws of the instrument behind a column; `None` if there are none.
    pub fn of(laws: &[UnlistedLaw], column: &str) -> Option<Self> {
        if laws.is_empty() {
            return None;
        }
        let at = |over| law_at(laws, LawPlace::instrument(column)?, over);
        let own = Self {
            reading: at(LawArgument::Reading),
            time: Course::at(laws, LawPlace::instrument(column)?),
            rate: at(LawArgument::ReadingRate),
            change: Remembered::of(find(laws, LawPlace::instrument(column)?, LawArgument::ReadingChange)),
        };
        let is_none = own.reading.is_none() && own.time.is_none() && own.rate.is_none() && own.change.is_none();
        (!is_none).then_some(own)
    }

    /// Makes of a true signal what is recorded.
    pub fn record(&self, times_s: &[f64], signal: &mut [f64]) {
        let begin_s = times_s.first().copied().unwrap_or(0.0);
        let last = signal.len().saturating_sub(1);
        let keeps_truth = self.rate.is_some() || !self.change.is_none();
        let truth = if keeps_truth { signal.to_vec() } else { vec![] };
        let mut mean = truth.clone();
        if !self.change.is_none() {
            lag::record(self.change.time_constant_s, times_s, &mut mean);
        }
        for (k, (reading, t)) in signal.iter_mut().zip(times_s).enumerate() {
            let mut added = value(self.reading.as_ref(), *reading) + self.time.sum(t - begin_s);
            if let Some(law) = &self.rate {
                let (a, b) = (k.saturating_sub(1), (k + 1).min(last));
                if b > a {
                    added += law.value((truth[b] - truth[a]) / (times_s[b] - times_s[a]));
                }
            }
            if keeps_truth {
                added += self.change.table.amount(truth[k] - mean[k]).unwrap_or(0.0);
            }
            *reading += added;
        }
    }

    /// Makes of a recorded motion the true one.
    pub fn undo(&self, times_s: &[f64], motion: &mut Motion) {
        let begin_s = times_s.first().copied().unwrap_or(0.0);
        motion.start_m -= value(self.reading.as_ref(), motion.start_m) + self.time.sum(0.0);
        let mut from_m = motion.start_m;
        for (segment, t) in motion.segments.iter_mut().zip(times_s.iter().skip(1)) {
            let t = t - begin_s;
            let recorded_m = segment.to_m;
            let added =
                value(self.reading.as_ref(), recorded_m) + self.time.sum(t) + value(self.rate.as_ref(), segment.to_m_s);
            let drift = self.time.rate(t);
            segment.from_m_s = (1.0 - slope(self.reading.as_ref(), from_m)) * segment.from_m_s - drift;
            segment.to_m_s = (1.0 - slope(self.reading.as_ref(), recorded_m)) * segment.to_m_s - drift;
            segment.to_m -= added;
            from_m = recorded_m;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::motion::Segment;

    fn law(place: LawPlace, depends_on: LawArgument, slope: f64) -> UnlistedLaw {
        UnlistedLaw {
            place,
            depends_on,
            argument: vec![-1.0, 1.0],
            value: vec![-slope, slope],
            time_constant_s: None,
            frequency_hz: None,
            presliding_volume_m3: None,
            attraction: None,
        }
    }

    #[test]
    fn adds_what_its_laws_say() {
        let laws = [
            law(LawPlace::InstrumentP2, LawArgument::Reading, 0.1),
            law(LawPlace::InstrumentP2, LawArgument::Time, 2.0),
            law(LawPlace::InstrumentP2, LawArgument::ReadingRate, -0.01),
        ];
        assert!(InstrumentLaws::of(&laws, "p1_Pa").is_none());
        // y = 5 t: a tenth of it, 2 t, and a hundredth of its rate less.
        let times: Vec<f64> = (0..5).map(|k| 10.0 + 0.1 * f64::from(k)).collect();
        let mut signal: Vec<f64> = times.iter().map(|t| 5.0 * (t - 10.0)).collect();
        InstrumentLaws::of(&laws, "p2_Pa").unwrap().record(&times, &mut signal);
        assert!((signal[4] - (2.0 + 0.2 + 0.8 - 0.05)).abs() < 1e-9, "{}", signal[4]);
    }

    #[test]
    fn an_instrument_that_leaves_out_recent_changes_lags() {
        let times: Vec<f64> = (0..200).map(|k| 0.002 * f64::from(k)).collect();
        let truth: Vec<f64> = times.iter().map(|t| 3.0 + libm::sin(20.0 * t)).collect();
        let remembered = UnlistedLaw {
            time_constant_s: Some(0.03),
            ..law(LawPlace::InstrumentForce, LawArgument::ReadingChange, -1.0)
        };
        let (mut shown, mut lagging) = (truth.clone(), truth);
        InstrumentLaws::of(&[remembered], "force_N")
            .unwrap()
            .record(&times, &mut shown);
        lag::record(0.03, &times, &mut lagging);
        assert!(shown.iter().zip(&lagging).all(|(a, b)| (a - b).abs() < 1e-12));
    }

    #[test]
    fn a_motion_is_freed_of_a_drift() {
        let laws = [law(LawPlace::InstrumentDisplacement, LawArgument::Time, 0.01)];
        let segment = |to_m| Segment {
            to_m,
            from_m_s: 0.03,
            to_m_s: 0.03,
        };
        let mut motion = Motion {
            start_m: 0.0,
            segments: vec![segment(0.03), segment(0.06)],
        };
        let laws = InstrumentLaws::of(&laws, "displacement_m").unwrap();
        laws.undo(&[0.0, 1.0, 2.0], &mut motion);
        assert!((motion.segments[1].to_m - 0.04).abs() < 1e-12 && (motion.segments[1].to_m_s - 0.02).abs() < 1e-12);
    }
}
