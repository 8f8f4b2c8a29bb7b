//! How the ride is judged: frequency weightings and exposure measures for people in a moving vehicle.
//!
//! ```text
//! acceleration at a seat -> weighting (BS 6841 Wb, Wd, Wf; ISO 2631-1 Wk) -> RMS, VDV, MSDV, combined RMS
//! ```
//!
//! The seed report judges rides by the BS 6841 weighted RMS of the vertical acceleration at the driver and the left rear
//! passenger (section 3.2); [`RideMeter`] gives that and its relatives, one sample at a time and without storing any.
//! [`SeatMeter`] adds the fore-aft and lateral axes, and leaves out the start of a drive.

mod biquad;
mod exposure;
mod seat;
mod weighting;

pub use exposure::{RideMeasures, RideMeter};
pub use seat::{SeatMeasures, SeatMeter};
pub use weighting::{WB, WD, WF, WK, Weighting, WeightingFilter};
