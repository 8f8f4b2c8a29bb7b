//! Specimens: struts, gas springs, cylinders.
//!
//! All that the search, the report and the page know of a specimen is the trait [`Specimen`]. A kind is one folder behind it:
//!
//! | file of a kind | what it says |
//! |---|---|
//! | `mod.rs` | the columns of its recordings, the model under a hypothesis, what that predicts |
//! | `candidates.rs` (strut: `vocabulary.rs`, `apply.rs`, `laws.rs`) | what may be off within tolerance, what may be missing, how either is put into a model |
//! | what only this kind has | clocks read off at corners (gas spring), force balance (cylinder), relations between neighbours, floor of the noise, drawing (strut) |
//!
//! A new kind is a folder, a variant of [`SpecimenKind`] and the arm of [`ModelFile::read`] that the compiler then asks for.
//! A kind with one compared channel implements [`single_output::SingleOutput`] instead of the whole trait.

pub mod candidate;
pub mod channel;
pub mod contract;
mod cylinder;
pub mod drawing;
mod extent;
mod gas_spring;
mod instrument;
mod kind;
mod model_file;
pub mod relation;
pub mod single_output;
pub mod strut;

pub use candidate::{Candidate, ExclusionGroup, Hypothesis};
pub use channel::{Channel, Series, StateSeries};
pub use contract::{BelievedModel, Specimen};
pub use kind::SpecimenKind;
pub use model_file::ModelFile;
pub use relation::MeasuredRelation;
