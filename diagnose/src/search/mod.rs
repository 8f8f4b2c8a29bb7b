//! The search for missing effects: forward selection, elimination and exchange, all judged on held-out blocks.
//!
//! ```text
//! calibrate within tolerance
//!     |
//!     v            (until no candidate is accepted; then with effects that wake a number of the model; then with wrong numbers of the model, if these complete
//!     |             it; then with laws without a name; then with a second law at another place)
//! screen all candidates --> fit the finalists --> accept the best that held-out blocks confirm -----+
//!     ^       (none: two other names in the place of one, if these complete it; far above the       |
//!     |       noise pairs and triples of names; at last pairs with laws)                            |
//!     +---------------------------------------------------------------------------------------------+
//!     |
//!     v
//! eliminate what the others made superfluous --> compare each effect with its strongest rival --> Selection
//! ```
//!
//! A candidate is believed only if it improves blocks that had no say in its fit, by more than chance and by a fraction of
//! what is unexplained ([`crate::criteria`] has every threshold). Calibration within tolerance is part of every model, so it
//! can never pass for physics. When what remains is far above the noise, no model that was tried is complete, and a small
//! gain may be a wrong law that bends towards a missing one: a law must then explain much more to be reported.

mod combinations;
mod completeness;
mod done;
mod dormant;
mod elimination;
pub mod evidence;
mod fits;
mod forward;
mod growth;
mod merging;
mod numbers;
mod oscillation;
mod power;
mod reshaping;
mod restart;
mod rivals;
pub mod screen;
mod screenings;
mod select;
mod selection;
mod selector;
mod shared;
mod simplification;
mod sizes;
mod splitting;

pub use evidence::HeldOutGain;
pub use power::LeastSize;
pub use screen::Screen;
pub use select::select;
pub use selection::{CandidateScore, Fitted, LawPairs, Progress, Rival, SelectedEffect, Selection};
pub use shared::{begun_at_others, with_shared};
