//! What recordings say of the instruments that made them, whatever the specimen did.
//!
//! A diagnosis judges residuals by the noise that the model file states. Where an instrument is not as stated, a complete model
//! looks incomplete, or physics is found that bends towards the instrument. What can be measured from the recordings is
//! therefore measured before anything is simulated:
//!
//! ```text
//! steps of the converter --> jitter of the sampling --> noise and its colour --> spikes --> mains hum --> Examined
//! ```
//!
//! Nothing here simulates. The motion of a specimen is slow beside the samples, so that high differences of successive samples
//! hold the noise and next to nothing else; medians make up for the few samples at corners and valve edges where they do. In a vehicle
//! wheels move about as fast as the bus samples, and readings less what the believed model makes of them take the place of readings. An
//! instrument that is as stated is left exactly as it is: no reading, no noise and no result changes.

mod differences;
mod examined;
mod finding;
mod hum;
mod jitter;
mod noise;
mod spikes;
mod steps;

pub use examined::{Examined, Stated};
pub use finding::{Finding, Flaw};
