//! How sure a report is of an effect: the evidence for it, weighed so that of the effects reported at 0.9 nine in ten are
//! there.
//!
//! Most of a wrong name's plausibility is a rival that does as well, so what counts is the lead over the strongest rival in
//! the effect's place: in standard errors over the blocks, and as a part of what the effect gains at all. (More kinds of
//! evidence, such as the gain a residual, the noise left, or whether the law has a name, predicted worse on trials that
//! were left out of the fit.)

/// What speaks for or against a reported effect.
#[derive(Debug, Clone, Copy)]
pub struct Evidence {
    /// Held-out gain in cost over the model without it, and its standard error over blocks.
    pub gain: (f64, f64),
    /// Lead in held-out cost over the strongest rival in its place, and its standard error; `None` without a rival.
    pub lead: Option<(f64, f64)>,
}

/// Names of the measures in [`Evidence::measures`].
pub const EVIDENCE: [&str; 3] = ["constant", "lead over the rival, standard errors", "lead over gain"];

/// Fitted by `oleo diagnose --self-test --seed 1 --campaigns 110`, table "Weights of the evidence": 106 reports, 98 of them
/// there. Logarithmic score, each report left out of its fit: -0.21 (-0.22 without these weights).
const WEIGHTS: [f64; EVIDENCE.len()] = [1.01, 1.82, 1.97];
/// Nothing is reported as surer than the self-test can show, or as less likely than this.
const RANGE: (f64, f64) = (0.05, 0.99);
/// A model is far off while it leaves this many times the noise ...
const FAR_OFF: f64 = 30.0;
/// ... and this part of what the recalibrated model leaves.
const LARGE_PART: f64 = 0.25;
/// The shape of a law without a name is known to this part of what the law gains.
const SHAPE: f64 = 0.01;
/// Most that is said of an effect of a model that is far off, since what else is missing may have its part, and of one that may be the shape of a law.
const MAY_BE_SOMETHING_ELSE: f64 = 0.5;

impl Evidence {
    /// The evidence as numbers of order one; standard errors logarithmic beyond one.
    #[must_use]
    pub fn measures(&self) -> [f64; EVIDENCE.len()] {
        let (lead, error) = self.lead.unwrap_or(self.gain);
        [
            1.0,
            libm::asinh(lead / error.max(1.0)) - 1.0,
            (lead / self.gain.0.max(1.0)).clamp(-1.0, 1.0),
        ]
    }

    /// Chance that the effect is there, at its place.
    #[must_use]
    pub fn confidence(&self) -> f64 {
        weighed(&self.measures(), &WEIGHTS).clamp(RANGE.0, RANGE.1)
    }
}

/// The most that a report is sure of any effect, by the noise ratios of the improved and the recalibrated model.
#[must_use]
pub fn upper_limit(improved_ratio: f64, recalibrated_ratio: f64) -> f64 {
    let is_far_off = improved_ratio > FAR_OFF && improved_ratio > LARGE_PART * recalibrated_ratio;
    if is_far_off { MAY_BE_SOMETHING_ELSE } else { RANGE.1 }
}

/// The most that a report is sure of an effect with this gain beside a law without a name that has the other one.
#[must_use]
pub fn upper_limit_beside_a_law(gain: f64, gain_of_law: f64) -> f64 {
    let may_be_shape = gain < SHAPE * gain_of_law;
    if may_be_shape { MAY_BE_SOMETHING_ELSE } else { RANGE.1 }
}

/// The most that a report is sure of a law without a name with these intervals of its numbers. Of a law none of whose numbers is certainly other than zero it
/// is not known what it looks like.
#[must_use]
pub fn upper_limit_of_law(intervals: impl IntoIterator<Item = [f64; 2]>) -> f64 {
    let may_be_nothing = intervals.into_iter().all(|[low, high]| low <= 0.0 && 0.0 <= high);
    if may_be_nothing { MAY_BE_SOMETHING_ELSE } else { RANGE.1 }
}

/// Probability from measures and weights.
#[must_use]
pub fn weighed(measures: &[f64], weights: &[f64]) -> f64 {
    let sum: f64 = measures.iter().zip(weights).map(|(m, w)| m * w).sum();
    1.0 / (1.0 + libm::exp(-sum))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_sure_in_a_model_that_is_far_off() {
        assert_eq!(upper_limit(228.0, 444.0), MAY_BE_SOMETHING_ELSE);
        assert_eq!(upper_limit(246.0, 8860.0), RANGE.1, "it explains most of it");
        assert_eq!(upper_limit(10.2, 26.9), RANGE.1, "it is near");
    }

    #[test]
    fn what_may_be_the_shape_of_a_law_is_not_sure() {
        assert_eq!(upper_limit_beside_a_law(40.0, 6e3), MAY_BE_SOMETHING_ELSE);
        assert_eq!(upper_limit_beside_a_law(6e3, 40.0), RANGE.1);
        assert_eq!(upper_limit_beside_a_law(40.0, 0.0), RANGE.1, "there is no law");
    }

    #[test]
    fn a_law_of_which_each_number_may_be_zero_is_not_sure() {
        assert_eq!(upper_limit_of_law([[-0.1, 0.2], [-0.3, 0.0]]), MAY_BE_SOMETHING_ELSE);
        assert_eq!(upper_limit_of_law([[-0.1, 0.2], [0.1, 0.3]]), RANGE.1);
    }

    #[test]
    fn a_clear_lead_is_sure_and_a_tie_is_not() {
        let at = |lead: f64, error: f64| {
            Evidence {
                gain: (1000.0, 300.0),
                lead: Some((lead, error)),
            }
            .confidence()
        };
        assert!(at(900.0, 100.0) > 0.95);
        assert!(at(1.0, 10.0) < 0.6);
        assert!(at(-200.0, 100.0) < at(0.0, 100.0) && at(0.0, 100.0) < at(300.0, 100.0));
    }
}
