//! Every threshold of the search, each with its reason.
//!
//! The search asks many small questions: is this gain more than chance, is this model complete, is this rival as good. What
//! is enough is stated here and nowhere else. [`Criteria::default`] holds the values that all published figures were made
//! with; a test of the search may change one and see what follows.
//!
//! *Cost* is a sum of squared residuals in units of the channels' noise; *gain* is how much of it a model takes away; both are
//! judged on blocks that had no say in the fit (held out) unless said otherwise. *Unexplained* is the cost beyond one per
//! residual.

/// All thresholds of the search.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Criteria {
    /// How far fits are carried, and when the linear approximation of a held-out fit is believed.
    pub fitting: Fitting,
    /// How candidates are screened before any is fitted in full.
    pub screening: Screening,
    /// How combinations of effects are tried where no single one is accepted.
    pub combinations: Combinations,
    /// When an effect is accepted into the model.
    pub acceptance: Acceptance,
    /// When a model counts as complete.
    pub completeness: Completeness,
    /// When an effect is told from its rival.
    pub rivalry: Rivalry,
}

/// How hard a fit tries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Most Jacobians that are computed. A fit that has not converged by then says so ([`crate::estimation::Fit`]).
    pub linearisations: usize,
    /// The fit ends when a step gains less than this fraction of the cost.
    pub tolerance: f64,
}

/// How far fits are carried, and when the linear approximation of a held-out fit is believed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fitting {
    /// A fit whose figures are reported. It is bounded: a model that still lacks something may creep, at a gain of nothing that
    /// matters, to numbers from which what it lacks is no longer found.
    pub converged: Effort,
    /// A fit that goes on where nothing can be added and the model is not complete.
    pub continued: Effort,
    /// A fit that starts close to its end: without one fold, or without one effect for the share of the misfit.
    pub quick: Effort,
    /// Largest change of a coordinate that leaving out a fold may make in the linear approximation. Coordinates are of
    /// order one, so a larger change leaves the region in which the derivatives were taken.
    pub largest_linear_step: f64,
    /// Where the linear approximation puts the held-out cost above this multiple of the fitted cost, the folds are fitted
    /// one by one instead.
    pub linear_limit: f64,
}

impl Default for Fitting {
    fn default() -> Self {
        Self {
            converged: Effort {
                linearisations: 8,
                tolerance: 3e-5,
            },
            continued: Effort {
                linearisations: 40,
                tolerance: 3e-5,
            },
            quick: Effort {
                linearisations: 2,
                tolerance: 1e-3,
            },
            largest_linear_step: 1.5,
            linear_limit: 1.5,
        }
    }
}

/// How candidates are screened before any is fitted in full.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Screening {
    /// Steps that every candidate gets, from each of its starts; a law only from the shape that explains most in a regression.
    pub first_steps: usize,
    /// Where the noise ratio of the model so far is gross, the first steps look at the recordings that hold this part of its cost. An effect that only shows in
    /// the others is found once they hold more.
    pub part_for_first_steps: f64,
    /// Candidates are also started at sizes up to the largest possible where the noise ratio of the model so far is above
    /// this. The bound limits the time of the search; what it costs below has not been measured.
    pub gross_noise_ratio: f64,
    /// Larger sizes are not tried once one costs this many times as much as none of the effect.
    pub size_overshoot: f64,
    /// How many of the starting sizes are stepped on from: those of lowest cost ...
    pub sizes_refined: usize,
    /// ... that cost less than this many times what the start at size zero has reached, and ...
    pub size_contender: f64,
    /// ... gain at least this part of what the best of all candidates gains. With sizes a decade apart the right effect gains nearly half of what it
    /// explains, where it is linear in its size.
    pub gain_of_size: f64,
    /// From how many starts of an effect a model is fitted again that is not complete when nothing can be added.
    pub shapes_restarted: usize,
    /// Further steps that the promising ones get.
    pub more_steps: usize,
    /// How many candidates are promising: those of lowest cost after the first steps.
    pub promising: usize,
    /// How many of them are fitted in full in each round.
    pub finalists: usize,
    /// Screening is linear in the model's own parameters and underestimates what a candidate gains: one that reaches this
    /// fraction of what acceptance asks is still fitted in full.
    pub margin: f64,
    /// The same of a fit of a finalist that has not converged. One that reaches less is not carried on.
    pub margin_of_quick_fit: f64,
    /// Promising candidates get further steps if their first ones gained at least this fraction of what those of the best gained.
    pub gain_of_promising: f64,
    /// Once a finalist is fitted, the next is fitted only if its screened gain is at least this fraction of that gain.
    pub gain_of_next_finalist: f64,
}

impl Default for Screening {
    fn default() -> Self {
        Self {
            first_steps: 1,
            part_for_first_steps: 0.7,
            gross_noise_ratio: 10.0,
            size_overshoot: 1.5,
            sizes_refined: 2,
            size_contender: 3.0,
            gain_of_size: 0.05,
            shapes_restarted: 8,
            more_steps: 3,
            promising: 6,
            finalists: 3,
            margin: 0.6,
            margin_of_quick_fit: 0.9,
            gain_of_promising: 0.1,
            gain_of_next_finalist: 0.5,
        }
    }
}

/// How combinations of effects are tried where no single one is accepted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Combinations {
    /// They are tried if the held-out noise ratio exceeds this multiple of what counts as complete. Closer to the noise a pair
    /// could bend towards what is left, and most models that are so close lack one weak effect and not two.
    pub far_from_complete: f64,
    /// They are tried while at least this part of the cost of the calibrated model is left. A search that has explained more is
    /// not stuck; what remains is a shape that the laws lack, towards which pairs only bend.
    pub least_part_left: f64,
    /// Most effects of a combination.
    pub largest: usize,
    /// Combinations of one size from which the next larger ones are made.
    pub beam: usize,
    /// Combinations of one size that are fitted in full.
    pub finalists: usize,
    /// Largest correlation between parameters of two effects of a combination. Beyond it they nearly cancel each other.
    pub largest_correlation: f64,
    /// Candidates that pairs are made from: those of lowest cost. One of a pair must be among them.
    pub seeds: usize,
    /// The same where simulations are slow.
    pub seeds_of_slow: usize,
    /// Most effects of a combination where simulations are slow.
    pub largest_of_slow: usize,
}

impl Default for Combinations {
    fn default() -> Self {
        Self {
            far_from_complete: 3.0,
            least_part_left: 0.01,
            largest: 3,
            beam: 3,
            finalists: 3,
            largest_correlation: 0.98,
            seeds: 8,
            seeds_of_slow: 3,
            largest_of_slow: 2,
        }
    }
}

/// When an effect is accepted into the model.
///
/// A gain must be large enough in three ways (absolute, for each residual, as a fraction of what is unexplained) and more
/// than chance in one of three (standard errors of the sum, standard errors of the mean logarithm, sign test over blocks).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Acceptance {
    /// Most effects of a model. More than this many were never concealed together, and each doubles the ways to be wrong.
    pub most_effects: usize,
    /// Smallest gain. For one parameter 30 is more than five standard deviations of chance, whatever the number of samples.
    pub least_gain: f64,
    /// Smallest gain for each residual. Smoothing a measured displacement leaves errors that a late or lagging sensor can
    /// imitate; on complete models they gained at most 0.0035.
    pub least_gain_per_residual: f64,
    /// Smallest gain in its own standard errors, taken from blocks.
    pub least_standard_errors: f64,
    /// Change of one block's cost that counts in the sign test.
    pub block_gain: f64,
    /// The sign test asks for this many better blocks for each worse one ...
    pub better_blocks_per_worse: usize,
    /// ... and for this many more.
    pub better_blocks_besides: usize,
    /// Smallest fraction of the unexplained cost that an effect must explain where the final model reaches the noise.
    pub least_fraction: f64,
    /// The same where it does not: small gains may then be a wrong law that bends towards a missing one. Also asked of
    /// every law without a name, which can bend to much.
    pub least_fraction_incomplete: f64,
    /// The same for a specimen recorded under several conditions whose few parameters those conditions pin down.
    pub least_fraction_conditions: f64,
    /// Largest cost of two whole recordings, each predicted by a fit of the other, over that without the effect. A single motion
    /// determines the parameters of a law badly, so a little worse is no evidence against it.
    pub whole_recordings: f64,
    /// A fault of an instrument below this fraction of a visible one is not reported: a clock off by a hundredth of a
    /// sample, a gain off by a thousandth.
    pub least_fault: f64,
    /// A fit that is already known is repeated from another start if that start is better than the known fit by this
    /// fraction of [`Self::least_gain`]: the known fit had ended in a local minimum.
    pub better_start: f64,
}

impl Default for Acceptance {
    fn default() -> Self {
        Self {
            most_effects: 6,
            least_gain: 30.0,
            least_gain_per_residual: 0.008,
            least_standard_errors: 2.5,
            block_gain: 6.0,
            better_blocks_per_worse: 3,
            better_blocks_besides: 4,
            least_fraction: 0.08,
            least_fraction_incomplete: 0.35,
            least_fraction_conditions: 0.1,
            whole_recordings: 1.05,
            least_fault: 0.1,
            better_start: 0.1,
        }
    }
}

impl Acceptance {
    /// Smallest gain for a number of residuals.
    #[must_use]
    pub fn least_gain_of(&self, residuals: f64) -> f64 {
        self.least_gain.max(self.least_gain_per_residual * residuals)
    }

    /// By how much the cost of a fit must be lower than that of a known one of the same effects to be another minimum.
    #[must_use]
    pub fn gain_of_other_minimum(&self) -> f64 {
        self.better_start * self.least_gain
    }
}

/// When a model counts as complete.
///
/// The floor is the noise ratio that a complete model reaches although its inputs are noisy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Completeness {
    /// Held-out noise ratio up to which a model is complete where the inputs' noise does not come through.
    pub noise_ratio: f64,
    /// The same as a multiple of the floor; the larger of the two counts.
    pub over_floor: f64,
    /// Laws without a name are tried above this held-out noise ratio, and above the floor.
    pub law_noise_ratio: f64,
}

impl Default for Completeness {
    fn default() -> Self {
        Self {
            noise_ratio: 1.15,
            over_floor: 1.07,
            law_noise_ratio: 1.06,
        }
    }
}

/// When an effect is told from its rival.
///
/// The *lead* is the held-out cost of the model with the rival in the effect's place less that of the model found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rivalry {
    /// The screened rival is fitted in full if its cost exceeds that of the model found by less than this fraction of the
    /// effect's gain; a rival further behind cannot catch up.
    pub contender: f64,
    /// The pair is ambiguous unless the lead is at least this fraction of the smallest gain that is accepted ...
    pub ambiguity_margin: f64,
    /// ... and only where the lead is below this fraction of the effect's gain: a rival that itself explains nearly nothing is
    /// no ambiguity.
    pub ambiguity_lead: f64,
    /// A law without a name takes the place of a named effect only if it leads by this fraction of the effect's gain.
    pub lead_over_named: f64,
    /// How often a rival that is better takes the place of an effect, after which all are compared anew.
    pub exchanges: usize,
}

impl Default for Rivalry {
    fn default() -> Self {
        Self {
            contender: 0.5,
            ambiguity_margin: 0.25,
            ambiguity_lead: 0.2,
            lead_over_named: 0.1,
            exchanges: 2,
        }
    }
}
