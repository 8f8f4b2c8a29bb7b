//! All combinations of ten static gas volumes and seven damper factors, on all cores, with the same result on any number.
//!
//! Each run depends on its case alone and goes to its own place, so the order of work does not matter; what the ledger
//! knows is not run again.

use rayon::prelude::*;

use super::case::{Bench, Case, Handling, Ride, StudyError};
use super::ledger::Ledger;
use super::records::RecordsError;

/// Ten static gas volumes from 0.01 to 3.0 l, about evenly spaced in logarithm, the report's 0.1 and 0.5 l among them; m3.
pub const GAS_VOLUMES_M3: [f64; 10] = [1e-5, 2e-5, 4e-5, 7e-5, 1e-4, 2e-4, 5e-4, 9e-4, 1.6e-3, 3e-3];

/// Seven factors on the baseline damper from 0.8 to 3 (report 3.2).
pub const DAMPER_FACTORS: [f64; 7] = [0.8, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0];

/// A sweep that stopped; what was run is in the ledger.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// A run that could not be made.
    #[error("gas volume {:.3} l, damper factor {}: {problem}", 1e3 * case.gas_volume_m3.front, case.damper_factor.front)]
    Run {
        /// The case that could not be simulated.
        case: Case,
        /// Why it could not be simulated.
        problem: StudyError,
    },
    /// The ledger cannot be written.
    #[error(transparent)]
    Ledger(#[from] RecordsError),
    /// The caller asked to stop.
    #[error("the study was stopped before its end; run the same command again to resume it")]
    Stopped,
}

/// Results over the grid: `[volume][factor]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Static gas volumes of the grid, m3.
    pub gas_volumes_m3: Vec<f64>,
    /// Factors on the baseline damper.
    pub damper_factors: Vec<f64>,
    /// Results on the Belgian block, for each gas volume and each damper factor.
    pub ride: Vec<Vec<Ride>>,
    /// Results of the lane change, for each gas volume and each damper factor.
    pub handling: Vec<Vec<Handling>>,
    /// Runs made now; the others were in the ledger.
    pub runs_made: usize,
}

/// One run of the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Job {
    /// Whether it is the lane change; otherwise the rough road.
    pub handling: bool,
    /// Springs and dampers.
    pub case: Case,
}

/// Result of a [`Job`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    /// Of the rough road.
    Ride(Ride),
    /// Of the lane change.
    Handling(Handling),
}

/// All runs of a grid, the long ones first, so that no core is left with one at the end.
#[must_use]
pub fn jobs(gas_volumes_m3: &[f64], damper_factors: &[f64]) -> Vec<Job> {
    let mut jobs = Vec::new();
    for handling in [false, true] {
        for &volume in gas_volumes_m3 {
            for &factor in damper_factors {
                let case = Case::alike(volume, factor);
                jobs.push(Job { handling, case });
            }
        }
    }
    jobs
}

/// Runs what the ledger does not know of some jobs, and says of each whether it was run now. `done` is told of every finished run;
/// `stop` is asked before each.
///
/// # Errors
/// [`SweepError`]; finished runs are kept.
pub fn run_jobs(
    bench: &Bench,
    ledger: &Ledger,
    jobs: &[Job],
    done: impl Fn() + Sync,
    stop: impl Fn() -> bool + Sync,
) -> Result<Vec<(Outcome, bool)>, SweepError> {
    let one = |Job { handling, case }: &Job| -> Result<(Outcome, bool), SweepError> {
        let known = match handling {
            false => ledger.ride(case).map(Outcome::Ride),
            true => ledger.handling(case).map(Outcome::Handling),
        };
        if let Some(outcome) = known {
            done();
            return Ok((outcome, false));
        }
        if stop() {
            return Err(SweepError::Stopped);
        }
        let wrap = |problem| SweepError::Run { case: *case, problem };
        let outcome = if *handling {
            let result = bench.handling(case).map_err(wrap)?;
            ledger.add_handling(case, &result)?;
            Outcome::Handling(result)
        } else {
            let result = bench.ride(case).map_err(wrap)?;
            ledger.add_ride(case, &result)?;
            Outcome::Ride(result)
        };
        done();
        Ok((outcome, true))
    };
    let outcomes: Vec<_> = jobs.par_iter().with_max_len(1).map(one).collect();
    // The first in the order of the jobs, whichever thread was first.
    outcomes.into_iter().collect()
}

impl Surface {
    /// The results of all [`jobs`] of a grid, in their order.
    #[must_use]
    pub fn of(gas_volumes_m3: &[f64], damper_factors: &[f64], outcomes: Vec<(Outcome, bool)>) -> Self {
        let (mut ride, mut handling, mut runs_made) = (Vec::new(), Vec::new(), 0);
        for (outcome, made) in outcomes {
            runs_made += usize::from(made);
            match outcome {
                Outcome::Ride(result) => ride.push(result),
                Outcome::Handling(result) => handling.push(result),
            }
        }
        let columns = damper_factors.len().max(1);
        Self {
            gas_volumes_m3: gas_volumes_m3.to_vec(),
            damper_factors: damper_factors.to_vec(),
            ride: ride.chunks(columns).map(<[Ride]>::to_vec).collect(),
            handling: handling.chunks(columns).map(<[Handling]>::to_vec).collect(),
            runs_made,
        }
    }
}

/// Runs what is missing of the grid. `done` is told of every finished run; `stop` is asked before each.
///
/// # Errors
/// [`SweepError`]; finished runs are kept.
pub fn sweep(
    bench: &Bench,
    ledger: &Ledger,
    gas_volumes_m3: &[f64],
    damper_factors: &[f64],
    done: impl Fn() + Sync,
    stop: impl Fn() -> bool + Sync,
) -> Result<Surface, SweepError> {
    let outcomes = run_jobs(bench, ledger, &jobs(gas_volumes_m3, damper_factors), done, stop)?;
    Ok(Surface::of(gas_volumes_m3, damper_factors, outcomes))
}

#[cfg(test)]
mod tests {
    use super::super::case::Conditions;
    use super::*;
    use crate::handling::HandlingParameters;
    use crate::vehicle::VehicleParameters;

    fn bench() -> Bench {
        let conditions = Conditions {
            ride_duration_s: 2.0,
            ride_settling_s: 0.5,
            ..Conditions::default()
        };
        Bench::new(
            VehicleParameters::defender110(),
            HandlingParameters::defender110(),
            conditions,
        )
        .unwrap()
    }

    #[test]
    fn same_bits_on_one_thread_and_on_many() {
        let bench = bench();
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let ledger = Ledger::in_memory(&bench);
            pool.install(|| sweep(&bench, &ledger, &[4e-5, 5e-4], &[0.8, 2.0], || {}, || false).unwrap())
        };
        assert_eq!(on(1), on(3));
    }

    #[test]
    fn a_stopped_sweep_goes_on_where_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("runs.csv");
        let bench = bench();
        let count = std::sync::atomic::AtomicUsize::new(0);
        let add = || {
            count.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        };
        let ledger = Ledger::open(&path, &bench).unwrap();
        let full = || count.load(std::sync::atomic::Ordering::Relaxed) >= 2;
        let stopped = sweep(&bench, &ledger, &[1e-4], &[0.8, 2.0], add, full);
        assert!(matches!(stopped, Err(SweepError::Stopped)));

        let ledger = Ledger::open(&path, &bench).unwrap();
        let (kept, whole) = (
            ledger.len(),
            sweep(&bench, &ledger, &[1e-4], &[0.8, 2.0], || {}, || false).unwrap(),
        );
        assert!(kept >= 2 && whole.runs_made == 4 - kept);
        let anew = sweep(
            &bench,
            &Ledger::in_memory(&bench),
            &[1e-4],
            &[0.8, 2.0],
            || {},
            || false,
        )
        .unwrap();
        assert_eq!((whole.ride, whole.handling), (anew.ride, anew.handling));
    }
}
