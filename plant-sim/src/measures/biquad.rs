//! Second-order sections that keep the magnitude of their analogue originals up to half the sampling rate.
//!
//! The bilinear transform squeezes all frequencies into the Nyquist band: the weightings' low pass at 100 Hz cannot be
//! had from it at 200 or 250 Hz sampling. Here (M. Vicanek, *Matched Second Order Digital Filters*, 2016) the poles
//! are those of the impulse-invariant transform, `exp(s T)`, and the numerator is solved for so that the squared magnitude
//! equals the analogue's at 0, at half the sampling rate and at one frequency between. High passes far below the
//! sampling rate keep their double zero at 0 instead and take the pre-warped bilinear transform, exact at their corner.

use core::f64::consts::PI;

/// `(n0 + n1 s + n2 s^2) / (1 + s / (Q w) + (s / w)^2)` with `w = 2 pi f`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Analogue {
    /// Numerator coefficients of 1, s, s^2.
    pub(super) numerator: [f64; 3],
    /// Natural frequency of the poles, Hz.
    pub(super) pole_hz: f64,
    /// Quality factor of the poles.
    pub(super) pole_q: f64,
}

impl Analogue {
    /// Squared magnitude at a frequency.
    pub(super) fn power(&self, frequency_hz: f64) -> f64 {
        let w = 2.0 * PI * frequency_hz;
        let [n0, n1, n2] = self.numerator;
        let (re, im) = (n0 - n2 * w * w, n1 * w);
        let x = frequency_hz / self.pole_hz;
        let (dre, dim) = (1.0 - x * x, x / self.pole_q);
        (re * re + im * im) / (dre * dre + dim * dim)
    }
}

/// A digital second-order section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Biquad {
    b: [f64; 3],
    a: [f64; 2],
}

impl Biquad {
    /// Changes nothing.
    pub(super) const THROUGH: Self = Self {
        b: [1.0, 0.0, 0.0],
        a: [0.0; 2],
    };

    /// Matched in magnitude to an analogue section.
    pub(super) fn matched(section: &Analogue, sampling_hz: f64) -> Self {
        let wt = 2.0 * PI * section.pole_hz / sampling_hz;
        let damping = 0.5 / section.pole_q;
        let radius = libm::exp(-damping * wt);
        let a1 = if damping <= 1.0 {
            -2.0 * radius * libm::cos((1.0 - damping * damping).sqrt() * wt)
        } else {
            -2.0 * radius * libm::cosh((damping * damping - 1.0).sqrt() * wt)
        };
        let a2 = radius * radius;
        let (sum, difference) = (1.0 + a1 + a2, 1.0 - a1 + a2);
        let (a0_2, a1_2, a2_2) = (sum * sum, difference * difference, -4.0 * a2);

        let middle_hz = section.pole_hz.min(0.42 * sampling_hz);
        let half_sine = libm::sin(PI * middle_hz / sampling_hz);
        let p1 = half_sine * half_sine;
        let p0 = 1.0 - p1;
        let p2 = 4.0 * p0 * p1;

        let b0_2 = a0_2 * section.power(0.0);
        let b1_2 = a1_2 * section.power(0.5 * sampling_hz);
        let wanted = (a0_2 * p0 + a1_2 * p1 + a2_2 * p2) * section.power(middle_hz);
        let b2_2 = (wanted - b0_2 * p0 - b1_2 * p1) / p2;

        let (root0, root1) = (b0_2.sqrt(), b1_2.sqrt());
        let w = 0.5 * (root0 + root1);
        let b0 = 0.5 * (w + (w * w + b2_2).max(0.0).sqrt());
        let b = [b0, 0.5 * (root0 - root1), -b2_2 / (4.0 * b0)];
        Self { b, a: [a1, a2] }
    }

    /// High pass `(s/w)^2 / (1 + s / (Q w) + (s/w)^2)`, exact at its corner.
    pub(super) fn high_pass(corner_hz: f64, q: f64, sampling_hz: f64) -> Self {
        let k = libm::tan(PI * corner_hz / sampling_hz);
        let scale = 1.0 / (1.0 + k / q + k * k);
        Self {
            b: [scale, -2.0 * scale, scale],
            a: [2.0 * (k * k - 1.0) * scale, (1.0 - k / q + k * k) * scale],
        }
    }

    /// Squared magnitude at a frequency.
    #[cfg(test)]
    pub(super) fn power(&self, frequency_hz: f64, sampling_hz: f64) -> f64 {
        let (s1, c1) = libm::sincos(2.0 * PI * frequency_hz / sampling_hz);
        let (s2, c2) = libm::sincos(4.0 * PI * frequency_hz / sampling_hz);
        let square = |k0: f64, k1: f64, k2: f64| {
            let (re, im) = (k0 + k1 * c1 + k2 * c2, k1 * s1 + k2 * s2);
            re * re + im * im
        };
        square(self.b[0], self.b[1], self.b[2]) / square(1.0, self.a[0], self.a[1])
    }
}

/// The sections of one place in several chains with their states (transposed direct form II), side by side: the processor does the same
/// operation for several at once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Abreast<const N: usize> {
    b: [[f64; N]; 3],
    a: [[f64; N]; 2],
    state: [[f64; N]; 2],
}

impl<const N: usize> Abreast<N> {
    pub(super) fn of(sections: [Biquad; N]) -> Self {
        Self {
            b: core::array::from_fn(|k| sections.map(|section| section.b[k])),
            a: core::array::from_fn(|k| sections.map(|section| section.a[k])),
            state: [[0.0; N]; 2],
        }
    }

    /// Filters one sample of each chain.
    #[inline]
    pub(super) fn filter(&mut self, input: [f64; N]) -> [f64; N] {
        let ([b0, b1, b2], [a1, a2], [first, second]) = (&self.b, &self.a, &mut self.state);
        core::array::from_fn(|k| {
            let output = b0[k] * input[k] + first[k];
            first[k] = b1[k] * input[k] - a1[k] * output + second[k];
            second[k] = b2[k] * input[k] - a2[k] * output;
            output
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matched_low_pass_follows_its_original_to_half_the_sampling_rate() {
        let section = Analogue {
            numerator: [1.0, 0.0, 0.0],
            pole_hz: 30.0,
            pole_q: 0.71,
        };
        let digital = Biquad::matched(&section, 200.0);
        let ratio = |f: f64| (digital.power(f, 200.0) / section.power(f)).sqrt();
        for exact_hz in [1e-3, 30.0, 100.0] {
            assert!(
                (ratio(exact_hz) - 1.0).abs() < 1e-6,
                "{exact_hz} Hz {}",
                ratio(exact_hz)
            );
        }
        // Between the pole and half the sampling rate nothing is matched; the bilinear transform loses all there.
        for i in 1..100 {
            let f = f64::from(i);
            assert!((ratio(f) - 1.0).abs() < 0.15, "{f} Hz {}", ratio(f));
        }
    }

    #[test]
    fn high_pass_blocks_constant_input_and_passes_its_corner_with_q() {
        let section = Biquad::high_pass(0.4, 0.71, 1000.0);
        assert!((section.power(0.4, 1000.0).sqrt() / 0.71 - 1.0).abs() < 1e-6);
        let mut filter = Abreast::of([section]);
        let [last] = (0..20_000).map(|_| filter.filter([1.0])).last().unwrap();
        assert!(last.abs() < 1e-6);
    }
}
