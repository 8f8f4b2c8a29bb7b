//! How much noise a motion adds that is not known between its samples.

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

    /// Mean square of the difference that two motions make.
    pub fn estimated(&self) -> f64 {
        let (sum, count) = self.difference;
        sum / count.max(1) as f64
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
