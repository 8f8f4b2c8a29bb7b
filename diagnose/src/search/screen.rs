//! A quick, fair look at every candidate: what could it explain beside the model so far?
//!
//! The model so far stays simulated where it is; its own parameters respond to the candidate linearly (variable projection,
//! Golub & Pereyra, SIAM J. Numer. Anal. 10(2), 1973, with the nuisance part linearised). So a candidate costs a few
//! simulations, a fault of an instrument none, and none is judged without recalibration.
//!
//! | module | what it holds |
//! |---|---|
//! | `beside` | the model so far, and a candidate beside it |
//! | `look` | the recordings on which a candidate is looked at |
//! | `steps` | the steps of candidates to their best values, side by side |
//! | `starts` | where candidates begin, and which of them go on |
//! | `law` | the same of laws without a name, by their shapes |
//! | `swing` | the same of a law that swings in time, by its frequency |

mod beside;
mod law;
mod look;
mod starts;
mod steps;
mod swing;

pub use beside::{Screen, ScreenedCandidate, cost_of, finished};
pub use starts::{go_on, promising};
