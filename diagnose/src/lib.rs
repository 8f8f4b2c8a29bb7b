//! Finds the physics that a model leaves out.
//!
//! The user's words: *when simulation and real recordings differ, the tool should locate the mismatch, say what physics
//! was left out, model it and show the fit improve.* [`Campaign`] reads recordings and the belief about a specimen;
//! [`search`] finds what is missing; the report says where, what, and how much better the model became.
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
//! `docs/architecture.md` draws who may know whom, and the way of a column through all of it.

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
