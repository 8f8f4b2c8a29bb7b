//! The sprung mass of a vehicle in the balance, from what its bus carried in a drive with an inertial unit: forces of struts and anti-roll bars
//! against measured accelerations, with no knowledge of the road.
//!
//! ```text
//!   believed vehicle ---------------+
//!   drive --> stretches --> band ---+--> balance (three rows) --> fit --> findings: what is named, how large, how sure
//! ```
//!
//! What the struts push the body with is known from p1, the piston's area, the believed friction of the seal and the believed stops; what the bars
//! do to it from the difference of two displacements. Below 6 Hz both sides of the balance are the same linear combination of smooth
//! series, so that noise of the rates is small beside the motion although it is differentiated (`band`).
//!
//! | file | what it holds |
//! |---|---|
//! | `believed` | masses, places, bars and struts as they are believed |
//! | `drive` | what a drive recorded, and its stretches without a gap |
//! | `band` | one low pass for all series, and the derivative in it |
//! | `level` | the unit's axes turned to the body's |
//! | `balance` | heave, pitch and roll of the body as rows of a linear problem |
//! | `fit` | least squares over blocks, with the covariance of their means |
//! | `findings` | the rule by which something is named |
//! | `as_found` | the vehicle with what was named |

mod as_found;
mod balance;
mod band;
mod believed;
mod drive;
mod findings;
mod fit;
mod level;

pub use believed::Believed;
pub use drive::BodyDrive;
pub use findings::{BodyEffect, BodyEffectId, BodyEstimate, BodyFindings, find};
