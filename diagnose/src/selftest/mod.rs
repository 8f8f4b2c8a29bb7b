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
mod summary;
mod trial;

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

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
    let next = AtomicUsize::new(0);
    let results: Mutex<Vec<Option<Trial>>> = Mutex::new(vec![None; cases.len()]);
    let failure: Mutex<Option<DiagnoseError>> = Mutex::new(None);
    let work = || -> Result<(), DiagnoseError> {
        // A pool of its own: a thread that waits within a diagnosis must not begin another one meanwhile.
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build()
            .map_err(|e| DiagnoseError::Output(e.to_string()))?;
        loop {
            let k = next.fetch_add(1, Ordering::SeqCst);
            let Some(case) = cases.get(k) else { return Ok(()) };
            let trial = if let Some(known) = ledger.get(&case.name) {
                known.clone()
            } else {
                let trial = pool.install(|| trial::run(case, stop))?;
                ledger.keep(&trial)?;
                trial
            };
            lock(&results)[k] = Some(trial);
            finished();
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..threads.max(1) {
            scope.spawn(|| {
                if let Err(error) = work() {
                    stop.store(true, Ordering::Relaxed);
                    lock(&failure).get_or_insert(error);
                }
            });
        }
    });
    if let Some(error) = lock(&failure).take() {
        return Err(error);
    }
    Ok(std::mem::take(&mut *lock(&results)).into_iter().flatten().collect())
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}
