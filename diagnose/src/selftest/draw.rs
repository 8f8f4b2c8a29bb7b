//! Random numbers of the self-test: one stream a campaign, named by text, so that a campaign is the same whatever else is run.

use std::hash::Hasher;

use fnv::FnvHasher;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A stream of random numbers.
pub struct Draw(ChaCha8Rng);

impl Draw {
    /// The stream of this name: same name, same numbers, on every machine.
    #[must_use]
    pub fn named(name: &str) -> Self {
        let mut hasher = FnvHasher::default();
        hasher.write(name.as_bytes());
        Self(ChaCha8Rng::seed_from_u64(hasher.finish()))
    }

    /// Draws a number that is uniform in 0..1.
    pub fn uniform(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / 4_294_967_296.0
    }

    /// Draws a number that is uniform between two values.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// One of the first `count` whole numbers.
    pub fn index(&mut self, count: usize) -> usize {
        ((self.uniform() * count as f64) as usize).min(count.saturating_sub(1))
    }

    /// Standard normal (Box & Muller, Ann. Math. Statist. 29(2), 1958). `rand_distr` draws other numbers, and with them every
    /// published figure of the self-test would be of other campaigns.
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.uniform(), self.uniform());
        (-2.0 * libm::log(u)).sqrt() * libm::cos(std::f64::consts::TAU * v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_have_unit_spread_and_names_tell_streams_apart() {
        let mut draw = Draw::named("1:seal_friction");
        let values: Vec<f64> = (0..20_000).map(|_| draw.normal()).collect();
        let square = values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64;
        assert!((square - 1.0).abs() < 0.03, "{square}");
        assert_eq!(values[0].to_bits(), Draw::named("1:seal_friction").normal().to_bits());
        assert_ne!(values[0].to_bits(), Draw::named("2:seal_friction").normal().to_bits());
    }
}
