//! The vocabulary of recordings, model files and reports, as types.
//!
//! Each of them is text in a file and a type everywhere else: a name that is not in the vocabulary cannot be written, and
//! a `match` that forgets one does not compile. The texts are those of the recordings' README.
//!
//! | type | what it names | text |
//! |---|---|---|
//! | [`EffectId`] | a law or fault that a model may lack | `gas_heat_transfer` |
//! | [`Place`] | where in the specimen it acts | `accumulator-1`, `front-left/accumulator-2` |
//! | [`Column`] | a column of a recording | `p1_Pa` |
//! | [`SpecimenKind`] | what was recorded | `gas spring` |
//! | [`State`] | a quantity that a residual may depend on | `speed, m/s` |

mod column;
mod effect_id;
mod place;
mod specimen_kind;
mod state;

pub use column::Column;
pub use effect_id::EffectId;
pub use place::{Branch, Place, PlaceError, Site, VehiclePart};
pub use specimen_kind::SpecimenKind;
pub use state::State;
