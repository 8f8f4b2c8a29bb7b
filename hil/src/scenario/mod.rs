//! Scenarios: what is driven, which faults occur, and which checks must be met. They make a run repeatable.
//!
//! ```text
//!   TOML --> file --> fault_entry, check_entry --> definition: a Scenario of checked values
//!             ^                                        ^
//!         built_in (by name)                  fault, check
//!                                                      |
//!                                                   as_file: TOML again
//! ```
//!
//! `docs/hil.md` is the reference for people.

mod as_file;
mod built_in;
mod changes;
pub mod check;
mod check_entry;
mod definition;
pub mod fault;
mod fault_entry;
pub mod file;
mod overrides;
mod strut_at;

pub use built_in::{BUILT_IN, named};
pub use changes::changes;
pub use check::{Check, Comparison};
pub use definition::{Clock, OnControllerLoss, Scenario};
pub use fault::{Fault, FaultKind};
pub use overrides::Overrides;
pub use strut_at::kept_as;
