//! Specimens: struts, gas springs, cylinders, dampers, drives.
//!
//! All that the search, the report and the page know of a specimen is the trait [`Specimen`]. A kind is one folder behind it:
//!
//! | file of a kind | what it says |
//! |---|---|
//! | `mod.rs` | the columns of its recordings, the model under a hypothesis, what that predicts |
//! | `calibration.rs` | what may be off within tolerance, and how it is put into a model |
//! | what only this kind has | force balance (cylinder), relations between neighbours, floor of the noise, drawing (strut) |
//!
//! Damper and drive are mechanisms with one degree of freedom and the same effects; `mechanism` holds what they share.
//!
//! `co_simulation` is no kind of model file: it is somebody else's model, which is simulated elsewhere and named on the command line.
//!
//! What a model may lack is not here: each effect says what it does in each kind of specimen ([`crate::effect`]).
//!
//! A new kind is a folder, a variant of [`SpecimenKind`](crate::vocabulary::SpecimenKind), a [`Kind`](crate::effect::Kind) with
//! what its recordings excite, and the arms that the compiler then asks for: in [`ModelFile::read`] and in
//! [`Effect`](crate::effect::Effect).
//! A kind with one compared channel implements [`single_output::SingleOutput`] instead of the whole trait.

pub mod channel;
pub mod co_simulation;
pub mod contract;
mod cylinder;
mod damper;
pub mod drawing;
mod drive;
mod folding;
mod gas_spring;
mod hypothesis;
mod mechanism;
mod model_file;
mod portrait;
pub mod relation;
pub mod single_output;
pub mod strut;

pub use channel::{Channel, Series, StateSeries};
pub use contract::{BelievedModel, Specimen};
pub use folding::Folding;
pub use hypothesis::Hypothesis;
pub use model_file::ModelFile;
pub use portrait::Portrait;
pub use relation::MeasuredRelation;
