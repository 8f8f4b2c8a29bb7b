//! What a log holds, and the words for what was read of it.

use oleo_diagnose::vehicle::Drive;
use oleo_hil::logs::Account;

/// What a log holds.
pub struct VehicleLog {
    /// The drives in the order of the log, at least one.
    pub drives: Vec<Drive>,
    /// What was read, in one sentence.
    pub in_words: String,
}

/// The end of a word for several.
pub fn plural(n: usize) -> &'static str {
    if n == 1 { "" } else { "s" }
}

/// What else was in a log.
pub fn others(foreign_frames: u64, log: &Account) -> String {
    format!(
        "{foreign_frames} frames of other devices, {} error frames, {} unreadable entries",
        log.error_frames, log.unreadable
    )
}
