//! Many diagnoses at the same time, each on one thread: the cores are used best, and no diagnosis waits for another.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::error::DiagnoseError;

/// Does `work` for all cases on so many threads, and gives the results in the order of the cases. The first error sets `stop` and ends
/// the work.
///
/// # Errors
/// That of a case; [`DiagnoseError::Output`] if there is no thread to be had.
pub fn one_a_thread<C: Sync, T: Send, E: From<DiagnoseError> + Send>(
    cases: &[C],
    threads: usize,
    stop: &AtomicBool,
    work: &(dyn Fn(&C) -> Result<T, E> + Sync),
) -> Result<Vec<T>, E> {
    let next = AtomicUsize::new(0);
    let results: Mutex<Vec<Option<T>>> = Mutex::new(cases.iter().map(|_| None).collect());
    let failure: Mutex<Option<E>> = Mutex::new(None);
    let thread = || -> Result<(), E> {
        // A pool of its own: a thread that waits within a diagnosis must not begin another one meanwhile.
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build()
            .map_err(|e| DiagnoseError::Output(e.to_string()))?;
        loop {
            let k = next.fetch_add(1, Ordering::SeqCst);
            let Some(case) = cases.get(k) else { return Ok(()) };
            let result = pool.install(|| work(case))?;
            lock(&results)[k] = Some(result);
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..threads.max(1) {
            scope.spawn(|| {
                if let Err(error) = thread() {
                    next.store(cases.len(), Ordering::SeqCst);
                    lock(&failure).get_or_insert(error);
                    stop.store(true, Ordering::Relaxed);
                }
            });
        }
    });
    if let Some(error) = lock(&failure).take() {
        return Err(error);
    }
    Ok(std::mem::take(&mut *lock(&results)).into_iter().flatten().collect())
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_the_order_of_the_cases_and_an_error_ends_the_work() {
        let cases: Vec<u32> = (0..100).collect();
        for threads in [0, 1, 3] {
            let stop = AtomicBool::new(false);
            let doubled = one_a_thread(&cases, threads, &stop, &|case| Ok::<_, DiagnoseError>(2 * case));
            assert_eq!(
                doubled.expect("no error"),
                cases.iter().map(|case| 2 * case).collect::<Vec<_>>()
            );
            assert!(!stop.load(Ordering::Relaxed));
            let failed = one_a_thread(&cases, threads, &stop, &|case| match case {
                7 => Err(DiagnoseError::Interrupted),
                _ => Ok(()),
            });
            assert!(matches!(failed, Err(DiagnoseError::Interrupted)) && stop.load(Ordering::Relaxed));
        }
    }
}
