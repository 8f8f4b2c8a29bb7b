//! What strategies are built from.

pub mod cornering;
pub(crate) mod load_transfer;
pub mod rollover_guard;
#[cfg(feature = "comparison")]
pub mod running_rms;
#[cfg(feature = "comparison")]
pub mod semi_active;
