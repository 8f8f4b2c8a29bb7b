//! `oleo diagnose --fmu`: somebody else's model against recordings.

#[cfg(not(feature = "fmu"))]
mod absent;
mod arguments;
#[cfg(feature = "fmu")]
mod simulator;

#[cfg(not(feature = "fmu"))]
pub use absent::run;
pub use arguments::{ForeignArgs, Recordings};
#[cfg(feature = "fmu")]
pub use simulator::run;
