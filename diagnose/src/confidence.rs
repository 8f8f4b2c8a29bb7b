//! How sure a report is of an effect: the evidence for it, weighed so that of the effects reported at 0.9 nine in ten are
//! there.

/// What speaks for or against a reported effect.
#[derive(Debug, Clone, Copy)]
pub struct Evidence {
    /// Held-out gain in cost over the model without it, and its standard error over blocks.
    pub gain: (f64, f64),
    /// Lead in held-out cost over the strongest rival in its place, and its standard error; `None` without a rival.
    pub lead: Option<(f64, f64)>,
    /// Number of residuals.
    pub residuals: usize,
    /// Held-out noise ratio of the model with it.
    pub noise_ratio: f64,
    /// True for a law without a name.
    pub nameless: bool,
}

/// Names of [`Evidence::measures`].
pub const EVIDENCE: [&str; 6] = [
    "constant",
    "lead over the rival, standard errors",
    "lead over gain",
    "gain a residual",
    "noise left",
    "no name",
];

impl Evidence {
    /// The evidence as numbers of order one, logarithmic where it spans decades.
    #[must_use]
    pub fn measures(&self) -> [f64; EVIDENCE.len()] {
        let gain = self.gain.0.max(1.0);
        let (lead, error) = self.lead.unwrap_or(self.gain);
        [
            1.0,
            libm::asinh(lead / error.max(1.0)) - 1.0,
            (lead / gain).clamp(-1.0, 1.0),
            libm::log(gain / self.residuals.max(1) as f64).clamp(-7.0, 7.0) / 3.0,
            libm::log(self.noise_ratio.clamp(1.0, 20.0)),
            f64::from(u8::from(self.nameless)),
        ]
    }
}

/// Probability from measures and weights.
#[must_use]
pub fn weighed(measures: &[f64], weights: &[f64]) -> f64 {
    let sum: f64 = measures.iter().zip(weights).map(|(m, w)| m * w).sum();
    1.0 / (1.0 + libm::exp(-sum))
}
