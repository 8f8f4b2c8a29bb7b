//! Laws that the vocabulary has no name for: tables at places of the network, linear between their points and beyond.
//!
//! A table gives a number over one measured quantity. What the number does follows from the place: it is added (a force,
//! a volume, a flow, a drop), or it multiplies what the model has (a damper's drop, a valve's flow, a gas pressure).
//! `oleo diagnose` fits such laws; a person may write them into a model file too:
//!
//! ```toml
//! [[effects.unlisted]]
//! place = "path-1"
//! depends_on = "flow"
//! argument = [-1e-3, 0.0, 1e-3]   # m3/s
//! value = [-4e5, 0.0, 4e5]        # Pa
//! ```
//!
//! | file | what it holds |
//! |---|---|
//! | `place` | where a law may act, on what it may depend there, and what its value does |
//! | `argument` | the quantities |
//! | `law` | the table in a model file and its check |
//! | `law_table`, `remembered` | the table as the solver reads it, of one strut or of several side by side; with a memory |
//! | `path_laws`, `chamber_laws`, `seal_law` | the tables at the places of the network |
//! | `compressibility` | the equation of state of a gas that a law says |
//! | `course` | laws over time, which two kinds of argument state: time since the start, and the phase of an oscillation |
//! | `instrument_laws` | what instruments add to their readings |

mod argument;
mod chamber_laws;
mod compressibility;
mod course;
mod instrument_laws;
mod law;
mod law_table;
mod path_laws;
mod place;
mod remembered;
mod seal_law;

pub use argument::LawArgument;
pub use law::{EQUATION, UnlistedLaw};
pub use place::{LawForm, LawPlace};

pub(in crate::strut) use chamber_laws::ChamberLaws;
pub(in crate::strut) use compressibility::Compressibility;
pub(in crate::strut) use course::{Course, longest_step_s};
pub(in crate::strut) use instrument_laws::InstrumentLaws;
pub(in crate::strut) use law::law_at;
pub(in crate::strut) use law_table::LawTable;
pub(in crate::strut) use path_laws::{
    GasLawInputs, PathLaws, most_held_back_pa, passed, presliding_m3, throttle, throttled, valve_in_time,
};
pub(in crate::strut) use seal_law::SealLaw;

pub(super) use law::check_all;
