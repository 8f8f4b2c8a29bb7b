//! What strategies are built from.

pub mod cornering;
pub mod rollover_guard;
pub mod running_rms;
pub mod semi_active;
