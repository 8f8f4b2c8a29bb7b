//! Sections of first and second order from which all filters here are built.
//!
//! Coefficients are computed once, from physical units, when the configuration is built; a tick then only multiplies and
//! adds. All sections are exact at steady state and unconditionally stable (0 < alpha < 1).

use oleo_interface::tick::TICK_S_F32 as TICK_S;

/// `y += alpha (x - y)`, the step-invariant form of a first-order lag: `alpha = 1 - exp(-T / tau)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowPass {
    alpha: f32,
}

impl LowPass {
    /// Lag with a time constant, s, above 0.
    pub fn from_time_constant_s(time_constant_s: f32) -> Self {
        Self::sampled(TICK_S, time_constant_s)
    }

    /// Lag that is stepped once in a period, s, with a time constant, s; both above 0.
    pub fn sampled(period_s: f32, time_constant_s: f32) -> Self {
        Self {
            alpha: -libm::expm1f(-period_s / time_constant_s),
        }
    }

    /// Lag of which each tick takes over this part of the difference, above 0 and below 1.
    pub const fn of_part(alpha: f32) -> Self {
        Self { alpha }
    }

    /// Lag with a corner frequency, Hz, above 0.
    pub fn from_corner_hz(corner_hz: f32) -> Self {
        Self::from_time_constant_s(time_constant_s(corner_hz))
    }

    /// One tick; returns the new output, which is the state.
    pub fn step(&self, state: &mut f32, input: f32) -> f32 {
        *state += self.alpha * (input - *state);
        *state
    }

    /// The part of the difference that the `n`-th input since the start, from 1, adds to the state, if that is the mean of all inputs
    /// until it has the memory of the lag. So a sensor that is at rest is known from its first sample, and of the first sample of one
    /// that moves no more is left than of any other.
    pub fn growing(&self, n: f32) -> f32 {
        at_least(1.0 / n, self.alpha)
    }
}

/// Time constant of a lag with a corner frequency, Hz, above 0.
fn time_constant_s(corner_hz: f32) -> f32 {
    1.0 / (2.0 * core::f32::consts::PI * corner_hz)
}

/// The greater of a value and its lower bound; the bound where the value is not a number. `f32::max` is a library call on a
/// Cortex-M4F, this takes three instructions.
pub fn at_least(value: f32, least: f32) -> f32 {
    if value > least { value } else { least }
}

/// Low-pass of second order for two inputs, of which the second is differentiated twice on its way.
///
/// ```text
///   y = H x + s^2 H u,   H = w^2 / (s^2 + 2 zeta w s + w^2)
/// ```
///
/// Two states serve both inputs, because both share the denominator (transposed direct form). The discrete form is the bilinear
/// one, which keeps the two inputs in phase: the estimate of lateral acceleration is a small difference of both. Noise of `u` is
/// amplified by no more than `w^2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondOrder {
    /// Of `x`, now; twice that of the last tick, and once that of the one before.
    input: f32,
    /// Of `u`, now; less twice that of the last tick, and once that of the one before.
    twice_differentiated: f32,
    /// Of the output one and two ticks ago.
    back: [f32; 2],
}

/// State of [`SecondOrder`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SecondOrderState([f32; 2]);

impl SecondOrderState {
    /// Without a past.
    pub const INITIAL: Self = Self([0.0; 2]);
}

impl SecondOrder {
    /// With a natural frequency, Hz, above 0 and below half the tick's rate, and a damping ratio, above 0.
    pub fn new(natural_hz: f32, damping_ratio: f32) -> Self {
        let natural = 2.0 * core::f32::consts::PI * natural_hz;
        let (rate, damping) = (2.0 / TICK_S, 2.0 * damping_ratio * natural);
        let (natural_2, rate_2) = (natural * natural, rate * rate);
        let per = 1.0 / (rate_2 + damping * rate + natural_2);
        Self {
            input: natural_2 * per,
            twice_differentiated: natural_2 * rate_2 * per,
            back: [
                2.0 * (natural_2 - rate_2) * per,
                (rate_2 - damping * rate + natural_2) * per,
            ],
        }
    }

    /// The state in which `x` and `u` have been constant for ever.
    pub fn at_rest(&self, x: f32, u: f32) -> SecondOrderState {
        let [_, last_but_one] = self.back;
        let first = (1.0 - self.input) * x - self.twice_differentiated * u;
        let second = (self.input - last_but_one) * x + self.twice_differentiated * u;
        SecondOrderState([first, second])
    }

    /// One tick; returns the output `y` for the input `x` alone.
    pub fn low_pass(&self, state: &mut SecondOrderState, x: f32) -> f32 {
        let ([last, last_but_one], [first, second]) = (self.back, state.0);
        let x = self.input * x;
        let output = x + first;
        state.0 = [2.0 * x - last * output + second, x - last_but_one * output];
        output
    }

    /// One tick; returns the output `y` for the inputs `x` and `u`.
    pub fn step(&self, state: &mut SecondOrderState, x: f32, u: f32) -> f32 {
        let ([last, last_but_one], [first, second]) = (self.back, state.0);
        let (x, u) = (self.input * x, self.twice_differentiated * u);
        let output = x + u + first;
        state.0 = [2.0 * (x - u) - last * output + second, x + u - last_but_one * output];
        output
    }
}

/// Derivative behind two first-order lags of the same corner frequency. A plain difference would turn each 0.01 mm step of
/// the displacement signal into 2 mm/s of speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Derivative {
    lag: LowPass,
    per_period: f32,
}

/// State of [`Derivative`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DerivativeState {
    lagged: f32,
    rate: f32,
}

impl DerivativeState {
    /// The state in which the input has been 0 for ever.
    pub const INITIAL: Self = Self::at_rest(0.0);

    /// The state in which the input has been constant for ever.
    pub const fn at_rest(input: f32) -> Self {
        Self {
            lagged: input,
            rate: 0.0,
        }
    }
}

impl Derivative {
    /// Both lags with this corner frequency, Hz, above 0.
    pub fn from_corner_hz(corner_hz: f32) -> Self {
        Self::sampled(TICK_S, corner_hz)
    }

    /// The same for a filter that is stepped once in a period, s, above 0.
    pub fn sampled(period_s: f32, corner_hz: f32) -> Self {
        Self {
            lag: LowPass::sampled(period_s, time_constant_s(corner_hz)),
            per_period: 1.0 / period_s,
        }
    }

    /// One step; returns the derivative per second.
    pub fn step(&self, state: &mut DerivativeState, input: f32) -> f32 {
        let before = state.lagged;
        let slope = (self.lag.step(&mut state.lagged, input) - before) * self.per_period;
        self.lag.step(&mut state.rate, slope)
    }
}

/// Leaky integrator `v = k (v + a T)`. It integrates above its corner frequency and returns to zero below it, so that a
/// constant error of an estimated acceleration does not add up.
#[cfg(feature = "comparison")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeakyIntegrator {
    keep: f32,
}

#[cfg(feature = "comparison")]
impl LeakyIntegrator {
    /// Integrates above a corner frequency, Hz, above 0.
    pub fn from_corner_hz(corner_hz: f32) -> Self {
        Self {
            keep: libm::expf(-TICK_S * 2.0 * core::f32::consts::PI * corner_hz),
        }
    }

    /// One tick; returns the new output, which is the state.
    pub fn step(&self, state: &mut f32, input: f32) -> f32 {
        *state = self.keep * (*state + input * TICK_S);
        *state
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Amplitude of the response to a sine of amplitude 1, after settling.
    fn gain(frequency_hz: f32, mut filter: impl FnMut(f32) -> f32) -> f32 {
        let mut peak = 0.0f32;
        for n in 0..8000 {
            let y = filter(libm::sinf(
                2.0 * core::f32::consts::PI * frequency_hz * n as f32 * TICK_S,
            ));
            if n > 6000 {
                peak = peak.max(y.abs());
            }
        }
        peak
    }

    #[test]
    fn low_pass_reaches_63_per_cent_after_its_time_constant() {
        let (filter, mut state) = (LowPass::from_time_constant_s(0.1), 0.0);
        for _ in 0..20 {
            filter.step(&mut state, 1.0); // 20 ticks are 0.1 s
        }
        assert!((state - (1.0 - libm::expf(-1.0))).abs() < 1e-5);
    }

    #[test]
    fn low_pass_is_3_db_down_at_its_corner() {
        let (filter, mut state) = (LowPass::from_corner_hz(1.0), 0.0);
        assert!((gain(1.0, |x| filter.step(&mut state, x)) - core::f32::consts::FRAC_1_SQRT_2).abs() < 0.02);
    }

    #[test]
    fn second_order_passes_one_input_and_differentiates_the_other_twice() {
        // At its natural frequency the gain of H is 1 / (2 zeta), and the second derivative multiplies it by w^2.
        let filter = SecondOrder::new(1.5, 0.7);
        let omega_2 = (2.0 * core::f32::consts::PI * 1.5) * (2.0 * core::f32::consts::PI * 1.5);
        let mut state = filter.at_rest(0.0, 0.0);
        assert!((gain(1.5, |x| filter.step(&mut state, x, 0.0)) * 1.4 - 1.0).abs() < 0.03);
        let mut state = filter.at_rest(0.0, 0.0);
        assert!((gain(1.5, |u| filter.step(&mut state, 0.0, u)) * 1.4 / omega_2 - 1.0).abs() < 0.03);
        // Far below its corner it is the second derivative itself.
        let mut state = filter.at_rest(0.0, 0.0);
        let slow_2 = omega_2 / 100.0;
        assert!((gain(0.15, |u| filter.step(&mut state, 0.0, u)) / slow_2 - 1.0).abs() < 0.02);
        // At rest nothing moves, but for the rounding of the large second input.
        let mut state = filter.at_rest(3.0, -0.4);
        for _ in 0..100 {
            assert!((filter.step(&mut state, 3.0, -0.4) - 3.0).abs() < 5e-3);
        }
    }

    #[test]
    fn derivative_of_a_slow_sine() {
        let (filter, mut state) = (Derivative::from_corner_hz(18.0), DerivativeState::at_rest(0.0));
        let omega = 2.0 * core::f32::consts::PI;
        assert!((gain(1.0, |x| filter.step(&mut state, x)) / omega - 1.0).abs() < 0.01);
    }

    #[test]
    fn derivative_at_its_corner_is_6_db_down() {
        // The analogue gain of two lags at their corner frequency is one half; at 200 Hz sampling the step-invariant form is
        // within a tenth of it.
        let (filter, mut state) = (Derivative::from_corner_hz(18.0), DerivativeState::at_rest(0.0));
        let omega = 2.0 * core::f32::consts::PI * 18.0;
        let measured = gain(18.0, |x| filter.step(&mut state, x)) / omega;
        assert!((measured - 0.5).abs() < 0.06, "{measured}");
    }

    #[cfg(feature = "comparison")]
    #[test]
    fn leaky_integrator_integrates_and_forgets() {
        let (filter, mut state) = (LeakyIntegrator::from_corner_hz(0.2), 0.0);
        let omega = 2.0 * core::f32::consts::PI * 1.5;
        assert!((gain(1.5, |x| filter.step(&mut state, x)) * omega - 1.0).abs() < 0.03);
        for _ in 0..4000 {
            filter.step(&mut state, 0.0);
        }
        assert!(state.abs() < 1e-6);
    }
}
