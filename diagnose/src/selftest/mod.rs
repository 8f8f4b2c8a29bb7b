//! How good the diagnosis is, measured on campaigns whose answers are known because they are made here.
//!
//! ```text
//! plan (which effects, which sizes) --> generate (strut, moves, truth, noise) --> Diagnosis::of, as for anybody's campaign
//!                                                                                        |
//!                       summary (power, confusion, coverage, calibration, false alarms) <-- trial (one line of a ledger)
//! ```
//!
//! A campaign is fixed by its name alone; trials run one a thread and are put together in the order of the plan, so the
//! tables are the same on any number of threads, and an interrupted test resumes where it stopped.

mod calibrate;
pub mod csv_rows;
mod draw;
mod excitation;
mod flaw;
mod generate;
mod hidden;
mod ledger;
mod nominal_strut;
mod page;
mod plan;
mod save;
mod statistics;
mod summary;
mod trial;

use std::sync::atomic::{AtomicBool, Ordering};

pub use draw::Draw;
pub use flaw::{Flaw, UnknownFlaw};
pub use ledger::Ledger;
pub use nominal_strut::nominal;
pub use page::{page, tables};
pub use plan::{Case, Plan, Subject, UnknownTerm};
pub use save::save;
pub use summary::Summary;
pub use trial::Trial;

use crate::error::DiagnoseError;
use crate::one_a_thread::one_a_thread;

/// Runs all cases that the ledger does not know, one a thread, and returns all trials in the order of the cases.
///
/// # Errors
/// [`DiagnoseError::Interrupted`] if the caller asked to stop; a ledger that cannot be written.
pub fn run(
    cases: &[Case],
    ledger: &Ledger,
    threads: usize,
    stop: &AtomicBool,
    finished: &(dyn Fn() + Sync),
) -> Result<Vec<Trial>, DiagnoseError> {
    one_a_thread(cases, threads, stop, &|case| {
        let trial = if let Some(known) = ledger.get(&case.name) {
            known.clone()
        } else if stop.load(Ordering::Relaxed) {
            return Err(DiagnoseError::Interrupted);
        } else {
            let trial = trial::run(case, stop)?;
            ledger.keep(&trial)?;
            trial
        };
        finished();
        Ok(trial)
    })
}
