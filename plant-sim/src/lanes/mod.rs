//! Numbers side by side: one number, or several in the lanes of the processor's vectors.
//!
//! What is written over [`Number`] is computed by the same operations in the same order whichever type it is compiled for, so a
//! lane holds the same bits as a single number would. Nothing is contracted to fused multiply-add.
//!
//! | module | what it holds |
//! |---|---|
//! | `number` | what the arithmetic of the strut asks of a number |
//! | `one` | a single number |
//! | `exponential`, `power` | exponentials and powers, for which the C library takes one number at a time |
//! | `four` | four numbers in the vectors that this processor has |

mod exponential;
mod four;
mod number;
mod one;
mod power;

pub use exponential::decay;
pub use four::{Four, LANES, Vectors, each_lane, vectors};
pub use number::{Mask, Number};
pub use power::power;
