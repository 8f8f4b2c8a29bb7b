//! Tests whether the residuals of the improved model are noise: whether they are white and independent of the inputs.
//!
//! A complete model leaves only sensor noise. Then no sample helps to predict the next (Ljung & Box, Biometrika 65(2),
//! 1978), and no sample correlates with the inputs (cross-correlation test, Billings & Voon, Int. J. Control 44(3), 1986).
//! With a hundred thousand samples both tests detect correlations that are far too small to matter. The report therefore also
//! gives the fraction of the residual's variance that the inputs explain, which is the most that another term could gain.

use crate::specimen::{Series, Specimen};
use crate::vocabulary::State;

/// Number of lags that are tested, in samples.
pub const LAGS: usize = 20;
/// Upper 1 % point of chi-square with [`LAGS`] degrees of freedom.
pub const CHI_SQUARE_99: f64 = 37.57;
/// Two-sided 1 % point of a normal variable when [`LAGS`] + 1 of them are looked at (Bonferroni).
const NORMAL_99: f64 = 3.49;

/// The tests of one channel's residuals.
#[derive(Debug, Clone)]
pub struct Whiteness {
    /// Autocorrelation at lags 1 to [`LAGS`].
    pub autocorrelation: Vec<f64>,
    /// Ljung-Box statistic over them; white residuals stay below [`CHI_SQUARE_99`] 99 times of 100.
    pub ljung_box: f64,
    /// The input with the largest correlation at any lag, and this correlation, -1 to 1; `None` if there is no input.
    pub input: Option<(State, f64)>,
    /// Bound below which the correlation with an independent input stays in 99 of 100 cases.
    pub bound: f64,
}

impl Whiteness {
    /// Whether the residuals are white at the 99 % level.
    #[must_use]
    pub fn is_white(&self) -> bool {
        self.ljung_box < CHI_SQUARE_99
    }

    /// Whether the residuals are independent of the inputs at the 99 % level.
    #[must_use]
    pub fn is_independent(&self) -> bool {
        self.input.is_none_or(|(_, r)| r.abs() < self.bound)
    }

    /// Fraction of the residual's variance that the strongest input explains, 0 to 1.
    #[must_use]
    pub fn explained(&self) -> f64 {
        self.input.map_or(0.0, |(_, r)| r * r)
    }
}

/// Tests every channel. Recordings are not joined at their ends.
#[must_use]
pub fn whiteness(specimen: &dyn Specimen, residuals: &[Series]) -> Vec<Whiteness> {
    let inputs: Vec<Vec<Input>> = (0..residuals.len()).map(|r| inputs(specimen, r)).collect();
    (0..specimen.channels().len())
        .map(|c| tested(&residuals.iter().map(|r| centred(&r[c])).collect::<Vec<_>>(), &inputs))
        .collect()
}

/// The state, and its series less its mean.
type Input = (State, Vec<f64>);

/// One channel: its centred residuals and the centred inputs, recording by recording.
fn tested(series: &[Vec<f64>], inputs: &[Vec<Input>]) -> Whiteness {
    let n = series.iter().map(Vec::len).sum::<usize>() as f64;
    let square: f64 = series.iter().flatten().map(|v| v * v).sum();
    let autocorrelation: Vec<f64> = (1..=LAGS)
        .map(|lag| series.iter().map(|s| lagged(s, s, lag)).sum::<f64>() / square.max(1e-300))
        .collect();
    let sum: f64 = (autocorrelation.iter().zip(1..))
        .map(|(r, lag)| r * r / (n - f64::from(lag)))
        .sum();
    let mut names: Vec<State> = Vec::new();
    for (name, _) in inputs.iter().flatten() {
        if !names.contains(name) {
            names.push(*name);
        }
    }
    let strongest = (names.iter())
        .map(|name| {
            let of = |r: usize| inputs[r].iter().find(|(n, _)| n == name).map(|(_, v)| v);
            let energy: f64 = (0..series.len()).filter_map(of).flatten().map(|v| v * v).sum();
            let scale = (energy * square).sqrt().max(1e-300);
            let at = |lag: usize| {
                let sum: f64 = (0..series.len())
                    .filter_map(|r| of(r).map(|u| lagged(u, &series[r], lag)))
                    .sum();
                sum / scale
            };
            let largest = (0..=LAGS).map(at).max_by(|a, b| a.abs().total_cmp(&b.abs()));
            (*name, largest.unwrap_or(0.0))
        })
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    Whiteness {
        autocorrelation,
        ljung_box: n * (n + 2.0) * sum,
        input: strongest,
        bound: NORMAL_99 / n.sqrt(),
    }
}

/// What the specimen was made to do: displacement and speed, or the inputs of somebody else's model.
fn inputs(specimen: &dyn Specimen, recording: usize) -> Vec<Input> {
    (specimen.states(recording).into_iter())
        .filter(|s| s.state.is_driven())
        .map(|s| (s.state, centred(&s.values)))
        .collect()
}

fn centred(values: &[f64]) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|v| v - mean).collect()
}

/// Sum of `a` with what `b` is `lag` samples later.
fn lagged(a: &[f64], b: &[f64], lag: usize) -> f64 {
    a.iter().zip(b.iter().skip(lag)).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

    const SAMPLES: usize = 20_000;

    fn noise(seed: u64) -> Vec<f64> {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        centred(
            &(0..SAMPLES)
                .map(|_| random.random_range(-1.0..1.0))
                .collect::<Vec<f64>>(),
        )
    }

    fn speed() -> Vec<f64> {
        centred(&(0..SAMPLES).map(|k| libm::sin(0.01 * k as f64)).collect::<Vec<f64>>())
    }

    /// The points are written down because statrs takes the platform's mathematics library, whose bits differ.
    #[test]
    fn points_of_the_distributions_are_those_of_the_books() {
        let chi_square = ChiSquared::new(LAGS as f64).expect("a distribution").inverse_cdf(0.99);
        assert!((chi_square - CHI_SQUARE_99).abs() < 0.005, "{chi_square}");
        let normal = Normal::standard().inverse_cdf(1.0 - 0.005 / (LAGS + 1) as f64);
        assert!((normal - NORMAL_99).abs() < 0.005, "{normal}");
    }

    #[test]
    fn noise_is_white_and_independent() {
        let w = tested(
            &[noise(1), noise(2)],
            &[vec![(State::Speed, speed())], vec![(State::Speed, speed())]],
        );
        assert!(w.ljung_box < CHI_SQUARE_99, "{}", w.ljung_box);
        assert!(w.input.is_some_and(|(_, r)| r.abs() < w.bound));
    }

    #[test]
    fn a_slow_error_is_not_white() {
        let mut slow = noise(3);
        for k in 1..SAMPLES {
            slow[k] += 0.1 * slow[k - 1];
        }
        let w = tested(&[slow], &[vec![]]);
        assert!((w.autocorrelation[0] - 0.1).abs() < 0.03, "{}", w.autocorrelation[0]);
        assert!(w.ljung_box > CHI_SQUARE_99 && w.input.is_none());
    }

    #[test]
    fn what_an_input_leaves_is_found_at_its_size() {
        let residual: Vec<f64> = noise(4).iter().zip(speed()).map(|(n, v)| n + 0.1 * v).collect();
        let w = tested(&[residual], &[vec![(State::Speed, speed())]]);
        let (name, r) = w.input.expect("an input");
        // 0.1 sine in uniform noise of variance 1/3.
        let expected = (0.005 / (0.005 + 1.0 / 3.0_f64)).sqrt();
        assert!(
            name == State::Speed && (r / expected - 1.0).abs() < 0.15 && r > w.bound,
            "{r} {expected}"
        );
    }
}
