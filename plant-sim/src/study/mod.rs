//! The design study of the seed report, section 3.2: which spring and damper suit the ride, which the handling?
//!
//! ```text
//!  case (volumes, factors) --> bench: Belgian block, lane change --> ride, handling --> ledger (append-only)
//!       ^                                                                  |
//!       +--- sweep: 10 x 7 grid, all cores ---- findings: the report's conclusions, checked
//!       +--- optimise: a library's simplex search -------- its path
//! ```

mod case;
mod element;
mod findings;
mod ledger;
mod optimise;
mod records;
mod sweep;

pub use case::{Bench, Case, Conditions, Handling, Ride, StudyError};
pub use element::GasElement;
pub use findings::{Finding, findings};
pub use ledger::Ledger;
pub use optimise::{Objective, Optimum, Visit, Weights, optimise};
pub use records::{Records, RecordsError};
pub use sweep::{DAMPER_FACTORS, GAS_VOLUMES_M3, Job, Outcome, Surface, SweepError, jobs, run_jobs, sweep};
