//! How much noise a motion adds that is not known between its samples.

use oleo_plant_sim::strut::Inputs;

/// Most by which the readings may exceed what the estimate of the motion says of its own error, in its variance.
const MOST_BEYOND_ESTIMATE: f64 = 4.0;
/// Variance of the second difference of white noise of variance one.
const OF_WHITE_NOISE: f64 = 6.0;

/// Mean squares over a channel: of the difference that other motions make, of its second difference, and of the second difference
/// of the residuals.
#[derive(Clone, Copy, Default)]
pub(super) struct Unknown {
    difference: (f64, usize),
    second: (f64, usize),
    residual: (f64, usize),
}

impl Unknown {
    /// What another motion makes different.
    pub fn add_difference(&mut self, difference: &[f64]) {
        difference.iter().for_each(|d| square(&mut self.difference, *d));
        second_differences(difference).for_each(|d| square(&mut self.second, d));
    }

    /// What is measured and simulated.
    pub fn add_residual(&mut self, measured: &[f64], simulated: &[f64]) {
        let residual: Vec<f64> = measured.iter().zip(simulated).map(|(m, s)| m - s).collect();
        second_differences(&residual).for_each(|d| square(&mut self.residual, d));
    }

    /// Variance that the unknown motion adds to that of the sensor, over the mean square of the difference that other motions make.
    pub fn share(&self, sensor: f64) -> f64 {
        let [second, residual] = [self.second, self.residual].map(mean);
        if second <= 0.0 {
            return 0.0;
        }
        ((residual - OF_WHITE_NOISE * sensor).max(0.0) / second).min(MOST_BEYOND_ESTIMATE)
    }
}

fn square(sum: &mut (f64, usize), v: f64) {
    if !v.is_nan() {
        *sum = (sum.0 + v * v, sum.1 + 1);
    }
}

fn mean((sum, count): (f64, usize)) -> f64 {
    sum / count.max(1) as f64
}

fn second_differences(series: &[f64]) -> impl Iterator<Item = f64> {
    series.windows(3).map(|w| w[0] - 2.0 * w[1] + w[2])
}

/// What the readings leave unknown of a motion, and what is counted as noise of it.
pub(super) struct UnknownMotion {
    /// For each recording another motion that the readings allow.
    possible: Vec<Inputs>,
    /// For each channel.
    counted: Vec<Counted>,
}

/// What the unknown motion makes of a channel under the believed model.
#[derive(Clone, Copy)]
pub(super) struct Counted {
    /// Mean square of the difference that the other motion makes, in units of the noise of the samples.
    pub estimated: f64,
    /// The part of it that is in that noise.
    pub share: f64,
}

impl UnknownMotion {
    /// Another motion for each recording, and what is counted of it in each channel.
    pub const fn new(possible: Vec<Inputs>, counted: Vec<Counted>) -> Self {
        Self { possible, counted }
    }

    /// The other motion of a recording.
    pub fn possible(&self, recording: usize) -> &Inputs {
        &self.possible[recording]
    }

    /// Variance of a channel beyond what is counted as its noise, in units of it, under another model with which the motions differ by this mean
    /// square.
    pub fn beyond(&self, channel: usize, mean_square: f64) -> f64 {
        let Counted { estimated, share } = self.counted[channel];
        share.max(1.0) * (mean_square - estimated).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_is_what_the_residuals_show_beside_the_noise_of_the_sensor() {
        let mut seen = Unknown::default();
        assert_eq!(seen.share(1.0), 0.0);
        // Second differences of 4 by the other motion.
        seen.add_difference(&[1.0, -1.0, 1.0, -1.0]);
        // And of 6 by the residuals; what is missing does not count.
        seen.add_residual(&[1.5, -1.5, 1.5, f64::NAN], &[0.0; 4]);
        assert_eq!(
            (seen.share(0.0), seen.share(2.0), seen.share(10.0)),
            (36.0 / 16.0, 1.5, 0.0)
        );
        seen.add_residual(&[100.0, -100.0, 100.0], &[0.0; 3]);
        assert_eq!(seen.share(0.0), MOST_BEYOND_ESTIMATE);
    }

    #[test]
    fn only_what_another_model_makes_more_of_the_motion_is_beyond_the_noise() {
        let beyond = |share: f64, mean_square: f64| {
            let counted = vec![Counted { estimated: 1.0, share }];
            UnknownMotion::new(vec![], counted).beyond(0, mean_square)
        };
        assert_eq!((beyond(3.0, 0.5), beyond(3.0, 1.0), beyond(3.0, 5.0)), (0.0, 0.0, 12.0));
        assert_eq!(beyond(0.0, 5.0), 4.0);
    }
}
