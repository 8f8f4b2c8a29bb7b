//! The strut as the report first modelled it: its SIMULINK model (section 3.6, figures 26 to 30), kept because it is the
//! baseline others know and the measure of what the second generation gains.
//!
//! ```text
//!  signals --> [pressure dependent valve switching, one a valve] --> delayed signals
//!                   ^ damper force / area, spring force / area            |
//!                   |                                                     v
//!  displacement, speed ------------> valve 3 open?  yes: [soft spring]  table(x) + low or high damping table(v)
//!                                                   no:  [stiff spring] table(x) + low or high damping table(v)
//!                                                        (damper 2 and valve 2 inactive)
//! ```
//!
//! Tables come from isothermal compression and are read with linear interpolation ([`LookUpTable`], [`Characteristics`]); a valve
//! acts at once, but late, by the parabola in pressure difference ([`DelayedSwitch`]). The model knows no trapped gas: between
//! springs it may be switched at the reference position only, and elsewhere the force jumps, as the report's figure 33 shows.

mod characteristics;
mod look_up;
mod model;
mod switching;

#[cfg(test)]
pub(crate) use characteristics::isothermal_force_n;
pub use characteristics::{Characteristics, Damping, Spring};
pub use look_up::LookUpTable;
pub use model::{FirstGenerationOutput, FirstGenerationStrut};
pub use switching::DelayedSwitch;
