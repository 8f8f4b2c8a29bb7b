//! Parameter estimation: how well a model with some effects and some parameter values meets the recordings, and which
//! values meet them best.
//!
//! Everything is about *free-run* simulation: the model gets the recording's inputs and nothing else, and what it predicts
//! is compared with what was measured, in units of each channel's noise.
//!
//! ```text
//! Point (which effects, coordinates z) --Evaluation--> residuals, sensitivities
//!                                                            |
//!                       Blocks (parts of recordings, folds) --+--> NormalEquations of each block
//!                                                                       |
//!                                     fit: Gauss-Newton with bounds (bounded_step) --> Fit
//!                                                                       |
//!                              held_out (folds left out), covariance, interval (blocks, jackknife)
//! ```

pub mod blocks;
pub mod bounded_step;
pub mod covariance;
mod dot;
pub mod evaluation;
pub mod fit;
pub mod gauss_newton;
pub mod held_out;
pub mod interval;
pub mod least_squares;
pub mod normal_equations;
pub mod point;

pub use blocks::{Block, Blocks};
pub use evaluation::{Evaluation, Sensitivity, Wanted};
pub use fit::{Fit, HeldOut};
pub use gauss_newton::{carried_on, fit};
pub use held_out::{cost_of_whole_recordings, held_out};
pub use least_squares::LeastSquares;
pub use normal_equations::NormalEquations;
pub use point::Point;
