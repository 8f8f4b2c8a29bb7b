//! Fractions of the work that are done when a phase of the search begins, 0 to 1, for a model that lacks two or three effects.

pub const CALIBRATION: f64 = 0.02;
/// The first screening; each effect that was added is [`EFFECT`] more.
pub const SCREENING: f64 = 0.1;
pub const EFFECT: f64 = 0.12;
/// Screening all candidates takes about as long as fitting the finalists.
pub const FITTING_AFTER_SCREENING: f64 = 0.06;
pub const ELIMINATION: f64 = 0.8;
pub const RIVALS: f64 = 0.88;
