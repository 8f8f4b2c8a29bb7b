//! The picture by which people of the trade judge a specimen.

use crate::vocabulary::State;

/// What the page draws of every recording: as measured, as the recalibrated model has it and as the improved one has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Portrait {
    /// The output over states of the motion, as loops.
    Loops(&'static [State]),
    /// The output over time, and its error.
    OverTime,
}
