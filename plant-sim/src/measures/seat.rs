//! Ride comfort of one seat in three directions after BS 6841: Wb vertically, Wd fore-aft and laterally, and their combination.
//!
//! ```text
//! vertical -> Wb, Wf, Wk -> RideMeasures ---+
//! fore-aft -> Wd -> RMS --------------------+--> root sum of squares
//! lateral  -> Wd -> RMS --------------------+
//! ```
//!
//! BS 6841 multiplies all three translational axes of the seat by 1 and takes the root of the sum of squares of the weighted
//! RMS accelerations; rotation, backrest and feet, which it adds with factors of their own, are not measured here.
//! The seed report judges by the vertical axis alone.

use super::exposure::{RideMeasures, RideMeter};
use super::weighting::{WD, WeightingFilter};
use crate::vehicle::SeatAcceleration;

/// Vibration that a seat has been exposed to since scoring began.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SeatMeasures {
    /// Vertical axis: the report's weighted RMS, doses and peak.
    pub vertical: RideMeasures,
    /// BS 6841: RMS of the Wd-weighted fore-aft acceleration, m/s2.
    pub fore_aft_weighted_rms_m_s2: f64,
    /// BS 6841: RMS of the Wd-weighted lateral acceleration, m/s2.
    pub lateral_weighted_rms_m_s2: f64,
    /// BS 6841: root sum of squares of the three weighted RMS values, m/s2.
    pub combined_rms_m_s2: f64,
}

/// Takes the acceleration of a seat one sample at a time and stores no history.
///
/// ```
/// use oleo_plant_sim::measures::SeatMeter;
/// use oleo_plant_sim::vehicle::SeatAcceleration;
/// let mut meter = SeatMeter::new(0.001, 3.0);
/// for _ in 0..10_000 {
///     meter.add(SeatAcceleration { lateral_m_s2: 1.0, ..SeatAcceleration::default() });
/// }
/// let felt = meter.measures();
/// assert!((felt.vertical.duration_s - 7.0).abs() < 1e-9);
/// assert!(felt.lateral_weighted_rms_m_s2 < 0.01, "a constant push is no vibration");
/// ```
#[derive(Debug, Clone)]
pub struct SeatMeter {
    vertical: RideMeter,
    fore_aft: WeightingFilter,
    lateral: WeightingFilter,
    fore_aft_square: f64,
    lateral_square: f64,
    samples: u64,
    /// Samples seen so far, and the first that counts.
    seen: u64,
    first: u64,
}

impl SeatMeter {
    /// For samples `step_s` apart (at most 5 ms: 200 Hz). Samples of the first `from_s` seconds pass the filters and do not
    /// count.
    pub fn new(step_s: f64, from_s: f64) -> Self {
        let filter = WeightingFilter::new(&WD, 1.0 / step_s);
        Self {
            vertical: RideMeter::new(step_s),
            fore_aft: filter,
            lateral: filter,
            fore_aft_square: 0.0,
            lateral_square: 0.0,
            samples: 0,
            seen: 0,
            first: (from_s / step_s).round().max(0.0) as u64,
        }
    }

    /// Adds one sample of the seat's acceleration.
    pub fn add(&mut self, acceleration: SeatAcceleration) {
        let fore_aft = self.fore_aft.filter(acceleration.fore_aft_m_s2);
        let lateral = self.lateral.filter(acceleration.lateral_m_s2);
        self.seen += 1;
        if self.seen <= self.first {
            self.vertical.settle(acceleration.vertical_m_s2);
            return;
        }
        self.vertical.add(acceleration.vertical_m_s2);
        self.samples += 1;
        self.fore_aft_square += fore_aft * fore_aft;
        self.lateral_square += lateral * lateral;
    }

    /// The measures of all samples that counted so far; all 0 where none did.
    pub fn measures(&self) -> SeatMeasures {
        let vertical = self.vertical.measures();
        let mean = |square: f64| {
            if self.samples == 0 {
                0.0
            } else {
                square / self.samples as f64
            }
        };
        let (x, y) = (mean(self.fore_aft_square), mean(self.lateral_square));
        let z = vertical.weighted_rms_m_s2;
        SeatMeasures {
            vertical,
            fore_aft_weighted_rms_m_s2: x.sqrt(),
            lateral_weighted_rms_m_s2: y.sqrt(),
            combined_rms_m_s2: (x + y + z * z).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measures::WB;
    use core::f64::consts::{PI, SQRT_2};

    /// A sine in each direction: RMS = amplitude x weight / sqrt 2, combined = root sum of squares.
    #[test]
    fn sines_have_their_closed_form_in_each_direction() {
        let mut meter = SeatMeter::new(1e-3, 10.0);
        let sine = |f: f64, i: u64| libm::sin(2.0 * PI * f * i as f64 * 1e-3);
        for i in 0..210_000 {
            meter.add(SeatAcceleration {
                fore_aft_m_s2: 0.7 * sine(3.0, i),
                lateral_m_s2: 1.1 * sine(1.0, i),
                vertical_m_s2: 2.0 * sine(8.0, i),
            });
        }
        let felt = meter.measures();
        let expected = [
            0.7 * WD.magnitude(3.0) / SQRT_2,
            1.1 * WD.magnitude(1.0) / SQRT_2,
            2.0 * WB.magnitude(8.0) / SQRT_2,
        ];
        let found = [
            felt.fore_aft_weighted_rms_m_s2,
            felt.lateral_weighted_rms_m_s2,
            felt.vertical.weighted_rms_m_s2,
        ];
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 5e-3, "{found} {expected}");
        }
        let together = expected.iter().map(|a| a * a).sum::<f64>().sqrt();
        assert!((felt.combined_rms_m_s2 / together - 1.0).abs() < 5e-3);
        assert!((felt.vertical.duration_s - 200.0).abs() < 1e-9);
    }

    /// A kerb at the start is not scored when scoring begins after it.
    #[test]
    fn what_happens_before_scoring_begins_does_not_count() {
        let felt = |from_s: f64| {
            let mut meter = SeatMeter::new(1e-3, from_s);
            for i in 0..20_000 {
                let vertical_m_s2 = if i < 200 { 30.0 } else { 0.0 };
                meter.add(SeatAcceleration {
                    vertical_m_s2,
                    ..SeatAcceleration::default()
                });
            }
            meter.measures()
        };
        assert!(felt(0.0).vertical.weighted_rms_m_s2 > 0.5);
        assert!(felt(5.0).combined_rms_m_s2 < 1e-3);
        assert_eq!(SeatMeter::new(1e-3, 1.0).measures(), SeatMeasures::default());
    }
}
