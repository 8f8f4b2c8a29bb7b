//! How much noise a motion adds that is not known between its samples.

use oleo_plant_sim::strut::Inputs;

/// Most by which the readings may exceed what the estimate of the motion says of its own error, in its variance.
const MOST_BEYOND_ESTIMATE: f64 = 4.0;
/// Variance of the second difference of white noise of variance one.
const OF_WHITE_NOISE: f64 = 6.0;

/// Mean squares over a channel: of the difference that two motions make, of its second difference, and of the second difference
/// of the residuals.
#[derive(Clone, Copy, Default)]
pub(super) struct Unknown {
    difference: (f64, usize),
    second: (f64, usize),
    residual: (f64, usize),
}

impl Unknown {
    pub fn add(&mut self, measured: &[f64], difference: &[f64], simulated: &[f64]) {
        let square = |sum: &mut (f64, usize), v: f64| {
            if !v.is_nan() {
                *sum = (sum.0 + v * v, sum.1 + 1);
            }
        };
        let second = |a: f64, b: f64, c: f64| a - 2.0 * b + c;
        difference.iter().for_each(|d| square(&mut self.difference, *d));
        difference
            .windows(3)
            .for_each(|w| square(&mut self.second, second(w[0], w[1], w[2])));
        let residual: Vec<f64> = measured.iter().zip(simulated).map(|(m, s)| m - s).collect();
        residual
            .windows(3)
            .for_each(|w| square(&mut self.residual, second(w[0], w[1], w[2])));
    }

    /// Variance that the unknown motion adds to that of the sensor.
    pub fn of_motion(&self, sensor: f64) -> f64 {
        let mean = |(sum, count): (f64, usize)| sum / count.max(1) as f64;
        let [estimated, second, residual] = [self.difference, self.second, self.residual].map(mean);
        if second <= 0.0 {
            return 0.0;
        }
        let measured = (residual - OF_WHITE_NOISE * sensor).max(0.0) * estimated / second;
        measured.min(MOST_BEYOND_ESTIMATE * estimated)
    }
}

/// What the readings leave unknown of a motion, and what is counted as noise of it.
pub(super) struct UnknownMotion {
    /// For each recording another motion that the readings allow.
    possible: Vec<Inputs>,
    /// For each channel.
    counted: Vec<Counted>,
}

/// What the unknown motion makes of a channel under the believed model.
struct Counted {
    /// Mean square of the difference that two motions make.
    estimated: f64,
    /// By how much more the residuals show, at least 1.
    share: f64,
}

impl UnknownMotion {
    /// What was seen of each channel, with the variance that was added to its noise.
    pub fn new<'u>(possible: Vec<Inputs>, seen: impl Iterator<Item = (&'u Unknown, f64)>) -> Self {
        let counted = seen.map(|(seen, added)| {
            let (sum, count) = seen.difference;
            let estimated = sum / count.max(1) as f64;
            Counted {
                estimated,
                share: (added / estimated.max(f64::MIN_POSITIVE)).max(1.0),
            }
        });
        Self {
            counted: counted.collect(),
            possible,
        }
    }

    /// The other motion of a recording.
    pub fn possible(&self, recording: usize) -> &Inputs {
        &self.possible[recording]
    }

    /// Variance of a channel beyond what is counted as its noise, under another model with which two motions differ by this mean square.
    pub fn beyond(&self, channel: usize, mean_square: f64) -> f64 {
        let Counted { estimated, share } = self.counted[channel];
        share * (mean_square - estimated).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_another_model_makes_more_of_the_motion_is_beyond_the_noise() {
        let mut seen = Unknown::default();
        seen.add(&[1.0, 5.0, 2.0, 8.0], &[1.0, -1.0, 1.0, -1.0], &[0.0; 4]);
        let motion = UnknownMotion::new(vec![], [(&seen, 3.0)].into_iter());
        assert_eq!((motion.beyond(0, 0.5), motion.beyond(0, 1.0)), (0.0, 0.0));
        // The residuals show three times as much as the two motions differ.
        assert_eq!(motion.beyond(0, 5.0), 12.0);
        let motion = UnknownMotion::new(vec![], [(&seen, 0.0)].into_iter());
        assert_eq!(motion.beyond(0, 5.0), 4.0);
    }
}
