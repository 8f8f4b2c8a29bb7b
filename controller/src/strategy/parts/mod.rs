//! What strategies are built from.

pub mod cornering;
#[cfg(feature = "comparison")]
pub(crate) mod forecast;
pub(crate) mod load_transfer;
#[cfg(feature = "comparison")]
mod nell_steyn;
pub mod rollover_guard;
#[cfg(feature = "comparison")]
pub mod running_rms;
#[cfg(feature = "comparison")]
pub mod semi_active;
#[cfg(feature = "comparison")]
pub(crate) mod strut_force;
#[cfg(feature = "comparison")]
pub(crate) mod wheel;
