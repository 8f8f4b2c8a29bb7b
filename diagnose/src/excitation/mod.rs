//! What the recordings of a specimen excite, so that effects they cannot show are listed as not tested instead of absent.
//!
//! | file | what it holds |
//! |---|---|
//! | `strut`, `cylinder`, `gas_spring`, `mechanism`, `co_simulation` | ranges and events that the effects of this kind of specimen need |
//! | `extent` | ranges of columns, duration and sampling interval |
//! | `corner` | corners of a motion, and what they say about the clocks of two columns |

mod co_simulation;
mod corner;
mod cylinder;
mod extent;
mod gas_spring;
mod mechanism;
mod strut;

pub use co_simulation::{CoSimulation, Known, Reading};
pub use corner::{Clock, corners};
pub use cylinder::{Cylinder, pressing};
pub use extent::spread;
pub use gas_spring::GasSpring;
pub use mechanism::{Channels, Mechanism};
pub use strut::{Strut, StrutColumns};
