//! Finds the physics that a model leaves out.
//!
//! If simulation and recordings differ, this crate locates the misfit, names the physics that the model leaves out, models
//! it, and shows how much the prediction of held-out recordings improves. [`Campaign`] reads the recordings and the given
//! model of a specimen, [`search`] finds the missing effects, and [`Diagnosis`] states the result.
//!
//! ```text
//! recording --> campaign --> specimen (strut | gas spring | cylinder: one trait) <-- effect (what may be missing: one file each)
//!                               |
//!              estimation (residuals in noise units, sensitivities of free runs, fits with calibration within tolerance)
//!                               |
//!              search (screen all candidates, select on held-out blocks, compare with rivals)
//!                               |
//!              locate (which relation, when, under which condition) --> diagnosis --> json, page, model.toml
//! ```
//!
//! `docs/architecture.md` draws the dependencies of the modules, and the path of a column through them.

#[cfg(test)]
mod analytic;
pub mod campaign;
pub mod confidence;
pub mod criteria;
pub mod diagnosis;
pub mod effect;
pub mod error;
pub mod estimation;
pub mod excitation;
mod experiment;
pub mod json;
pub mod locate;
pub mod page;
pub mod parameter;
pub mod prediction;
pub mod recording;
pub mod search;
pub mod selftest;
pub mod specimen;
pub mod vocabulary;
pub mod whiteness;

pub use campaign::{Campaign, KeptBack, MODEL_FILE};
pub use diagnosis::Diagnosis;
pub use error::DiagnoseError;
pub use prediction::Predictions;
