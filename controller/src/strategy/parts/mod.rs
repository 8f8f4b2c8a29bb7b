//! What strategies are built from.

pub mod cornering;
pub(crate) mod load_transfer;
pub mod rollover_guard;
pub mod running_rms;
pub mod semi_active;
