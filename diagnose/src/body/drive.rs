//! What a drive recorded, and its stretches without a gap.

use oleo_interface::Corners;

/// A drive with an inertial unit. All series have the same length; what was not received is NaN.
#[derive(Debug, Clone, Default)]
pub struct BodyDrive {
    /// Time between two samples, s.
    pub period_s: f64,
    /// Displacement of the struts, m, compression positive.
    pub displacement_m: Corners<Vec<f64>>,
    /// Gauge pressure p1 of the struts, Pa.
    pub p1_pa: Corners<Vec<f64>>,
    /// Specific force along the unit's x, y, z, m/s2.
    pub specific_force_m_s2: [Vec<f64>; 3],
    /// Angular velocity about the unit's x, y, z, rad/s.
    pub rate_rad_s: [Vec<f64>; 3],
}

/// Longest gap that is bridged by a straight line, s: two samples of the bus, so that nothing below the band's edge is invented.
const LONGEST_GAP_S: f64 = 0.01;
/// Beginning of each stretch that is left out, s: the friction of the seals is not known until they have slid.
const SETTLING_S: f64 = 1.0;

impl BodyDrive {
    fn series_mut(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        let struts = (self.displacement_m.values_mut()).chain(self.p1_pa.values_mut());
        struts.chain(&mut self.specific_force_m_s2).chain(&mut self.rate_rad_s)
    }

    /// The stretches in which everything was received, but for single gaps.
    pub(super) fn stretches(&self) -> Vec<Self> {
        let mut bridged = self.clone();
        let most = (LONGEST_GAP_S / self.period_s).round() as usize;
        let length = bridged.series_mut().map(|series| series.len()).min().unwrap_or(0);
        let mut whole = vec![true; length];
        for series in bridged.series_mut() {
            bridge(series, most);
            for (whole, value) in whole.iter_mut().zip(series) {
                *whole &= value.is_finite();
            }
        }
        let skipped = (SETTLING_S / self.period_s).round() as usize;
        let mut stretches = Vec::new();
        let mut begin = 0;
        for part in whole.chunk_by(|a, b| a == b) {
            let end = begin + part.len();
            if part[0] && part.len() > 2 * skipped {
                stretches.push(bridged.clone().between(begin, end));
            }
            begin = end;
        }
        stretches
    }

    fn between(mut self, begin: usize, end: usize) -> Self {
        for series in self.series_mut() {
            series.truncate(end);
            series.drain(..begin);
        }
        self
    }

    /// Samples at the beginning of a stretch that are not used.
    pub(super) fn settling(&self) -> usize {
        (SETTLING_S / self.period_s).round() as usize
    }
}

/// Puts straight lines over gaps of at most this many samples.
fn bridge(series: &mut [f64], most: usize) {
    let mut last: Option<usize> = None;
    for k in 0..series.len() {
        if !series[k].is_finite() {
            continue;
        }
        if let Some(before) = last
            && k - before > 1
            && k - before - 1 <= most
        {
            let (from, to) = (series[before], series[k]);
            let step = (to - from) / (k - before) as f64;
            for (n, value) in (1..).zip(&mut series[before + 1..k]) {
                *value = from + step * f64::from(n);
            }
        }
        last = Some(k);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_gaps_are_bridged_and_long_ones_part_the_drive() {
        let mut drive = BodyDrive {
            period_s: 0.005,
            ..BodyDrive::default()
        };
        for series in drive.series_mut() {
            series.extend((0..3000).map(f64::from));
        }
        drive.rate_rad_s[1][700..702].fill(f64::NAN);
        drive
            .p1_pa
            .values_mut()
            .for_each(|series| series[1500..1503].fill(f64::NAN));
        let stretches = drive.stretches();
        let lengths: Vec<usize> = stretches.iter().map(|s| s.rate_rad_s[0].len()).collect();
        assert_eq!(lengths, [1500, 1497]);
        assert!((stretches[0].rate_rad_s[1][701] - 701.0).abs() < 1e-9);
        assert_eq!(stretches[1].rate_rad_s[2][0], 1503.0);
    }
}
