//! Long work in a thread of its own, beside which Python stays alive.
//!
//! The work never touches Python: it sends how far it is, and the thread that called us hands that on, and asks whether the user
//! has stopped the work, ten times a second.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

/// Time between two looks at Ctrl-C.
const PATIENCE: Duration = Duration::from_millis(100);
/// Stack of the thread that works, as that of a program's first one.
const STACK_BYTES: usize = 8 << 20;

/// Tells a phase of the work in words, and its part that is done, 0 to 1.
pub type Tell<'t> = &'t (dyn Fn(&str, f64) + Sync);

/// Does the work with the interpreter released. It is told to stop by the flag when the user interrupts it or when `progress`, which
/// Python gave, fails.
pub fn watched<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&AtomicBool, Tell<'_>) -> T + Send,
) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    py.detach(|| {
        thread::scope(|scope| {
            let (sender, receiver) = channel::<(String, f64)>();
            let stop = &stop;
            let worker = thread::Builder::new()
                .stack_size(STACK_BYTES)
                .spawn_scoped(scope, move || {
                    work(stop, &|phase, part| {
                        // Nobody listens any more if Python's side has failed; then the flag ends the work.
                        let _ = sender.send((phase.to_owned(), part));
                    })
                })
                .map_err(|error| PyOSError::new_err(format!("no thread can be started: {error}")))?;
            let mut failure = None;
            loop {
                let news = match receiver.recv_timeout(PATIENCE) {
                    // What came meanwhile is newer.
                    Ok(news) => Some(receiver.try_iter().last().unwrap_or(news)),
                    Err(RecvTimeoutError::Timeout) => None,
                    Err(RecvTimeoutError::Disconnected) => break,
                };
                if failure.is_some() {
                    continue;
                }
                let answer = Python::attach(|py| {
                    py.check_signals()?;
                    match (&progress, news) {
                        (Some(progress), Some(news)) => progress.call1(py, news).map(drop),
                        _ => Ok(()),
                    }
                });
                if let Err(error) = answer {
                    stop.store(true, Ordering::Relaxed);
                    failure = Some(error);
                }
            }
            let result = worker.join().unwrap_or_else(|panic| resume_unwind(panic));
            failure.map_or(Ok(result), Err)
        })
    })
}
