//! How the ride is judged: frequency weightings and exposure measures for people in a moving vehicle.
//!
//! ```text
//! vertical acceleration at a seat -> weighting (BS 6841 Wb, Wf; ISO 2631-1 Wk) -> RMS, VDV, MSDV
//! ```
//!
//! The seed report judges rides by the BS 6841 weighted RMS of the vertical acceleration at the driver and the left rear
//! passenger (section 3.2); [`RideMeter`] gives that and its relatives, one sample at a time and without storing any.

mod biquad;
mod exposure;
mod weighting;

pub use exposure::{RideMeasures, RideMeter};
pub use weighting::{WB, WF, WK, Weighting, WeightingFilter};
