//! Finds what the sweep finds with fewer runs: the report's reference 27, here with `argmin`'s simplex search
//! (J. A. Nelder, R. Mead, *The Computer Journal* 7, 1965).
//!
//! Variables: logarithm of the gas volume and the damper factor, alike front and rear or each for itself, scaled to 0..1 over
//! the sweep's range. Outside, the nearest point inside counts, plus a penalty that leads back. The objective weighs ride
//! and handling, each over its value at a reference case (0.5 l, factor 1):
//!
//! ```text
//! J = w_ride RMS / RMS_ref + w_sickness MSDV / MSDV_ref + w_roll roll / roll_ref      (+ 10 where a run did not end well)
//! ```

use std::cell::RefCell;
use std::collections::BTreeMap;

use argmin::core::{CostFunction, Executor};
use argmin::solver::neldermead::NelderMead;
use oleo_interface::Axles;

use super::case::{Bench, Case, Handling, Ride};
use super::ledger::Ledger;
use super::sweep::{DAMPER_FACTORS, GAS_VOLUMES_M3, SweepError};

/// Cost of a run that did not end well.
const FAILED: f64 = 10.0;
/// Cost of leaving the range, per unit of the scaled variables.
const OUTSIDE: f64 = 1.0;

/// Weights of the objective.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    /// Of the mean weighted RMS.
    pub ride: f64,
    /// Of the mean motion sickness dose.
    pub sickness: f64,
    /// Of the largest roll angle.
    pub roll: f64,
}

impl Weights {
    /// The objective of a case, over its measures at the reference case. A measure that one of them lacks does not count.
    #[must_use]
    pub fn objective(
        &self,
        ride: Option<Ride>,
        handling: Option<Handling>,
        reference: (Option<Ride>, Option<Handling>),
    ) -> f64 {
        let mut value = 0.0;
        if let (Some(ride), Some(reference)) = (ride, reference.0) {
            value += self.ride * ride.mean_rms_m_s2() / reference.mean_rms_m_s2();
            value += self.sickness * ride.mean_msdv_m_s1_5() / reference.mean_msdv_m_s1_5();
            value += if ride.completed { 0.0 } else { FAILED };
        }
        if let (Some(handling), Some(reference)) = (handling, reference.1) {
            value += self.roll * handling.max_roll_rad / reference.max_roll_rad;
            value += if handling.completed { 0.0 } else { FAILED };
        }
        value
    }
}

/// What the search minimises, and under which conditions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Objective {
    /// Weights of the measures in the objective.
    pub weights: Weights,
    /// Front and rear each for itself: four variables instead of two.
    pub per_axle: bool,
    /// Most iterations of the simplex.
    pub iterations: u64,
}

/// One point the search has looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Visit {
    /// Gas volumes and damper factors of the point.
    pub case: Case,
    /// Value of the objective at the point.
    pub objective: f64,
    /// Ride there; `None` where its weights are 0.
    pub ride: Option<Ride>,
    /// Handling there; `None` where its weight is 0.
    pub handling: Option<Handling>,
}

/// The end of a search.
#[derive(Debug, Clone, PartialEq)]
pub struct Optimum {
    /// The point with the lowest objective.
    pub best: Visit,
    /// All points in the order of looking, the reference first.
    pub path: Vec<Visit>,
    /// Simulations needed (ride and handling counted apart), those found in the ledger included.
    pub runs: usize,
}

struct Search<'a> {
    bench: &'a Bench,
    ledger: &'a Ledger,
    objective: Objective,
    reference: Option<(Option<Ride>, Option<Handling>)>,
    memory: RefCell<Memory>,
    done: &'a (dyn Fn(&Visit) + Sync),
}

#[derive(Default)]
struct Memory {
    path: Vec<Visit>,
    looked: BTreeMap<[u64; 4], usize>,
    runs: usize,
    failure: Option<SweepError>,
}

impl Search<'_> {
    /// Scaled variables to a case, and how far outside they were.
    fn case(&self, x: &[f64]) -> (Case, f64) {
        let (low, high) = (libm::log(GAS_VOLUMES_M3[0]), libm::log(GAS_VOLUMES_M3[9]));
        let mut outside = 0.0;
        let mut inside = |value: f64| {
            let kept = value.clamp(0.0, 1.0);
            outside += (value - kept).abs();
            kept
        };
        let mut volume = |value: f64| libm::exp(low + (high - low) * inside(value));
        let (front_volume, rear_volume) = if self.objective.per_axle {
            (volume(x[0]), volume(x[2]))
        } else {
            (volume(x[0]), f64::NAN)
        };
        let mut factor = |value: f64| DAMPER_FACTORS[0] + (DAMPER_FACTORS[6] - DAMPER_FACTORS[0]) * inside(value);
        let (front_factor, rear_factor) = if self.objective.per_axle {
            (factor(x[1]), factor(x[3]))
        } else {
            (factor(x[1]), f64::NAN)
        };
        let case = if self.objective.per_axle {
            Case {
                gas_volume_m3: Axles::new(front_volume, rear_volume),
                damper_factor: Axles::new(front_factor, rear_factor),
            }
        } else {
            Case::alike(front_volume, front_factor)
        };
        (case, outside)
    }

    fn look(&self, case: Case) -> Result<Visit, SweepError> {
        let key = case.numbers().map(f64::to_bits);
        if let Some(visit) = self
            .memory
            .borrow()
            .looked
            .get(&key)
            .map(|i| self.memory.borrow().path[*i])
        {
            return Ok(visit);
        }
        let weights = self.objective.weights;
        let wrap = |problem| SweepError::Run { case, problem };
        let (bench, ledger) = (self.bench, self.ledger);
        let ride = || -> Result<Option<Ride>, SweepError> {
            if weights.ride == 0.0 && weights.sickness == 0.0 {
                return Ok(None);
            }
            if let Some(known) = ledger.ride(&case) {
                return Ok(Some(known));
            }
            let ride = bench.ride(&case).map_err(wrap)?;
            ledger.add_ride(&case, &ride)?;
            Ok(Some(ride))
        };
        let handling = || -> Result<Option<Handling>, SweepError> {
            if weights.roll == 0.0 {
                return Ok(None);
            }
            if let Some(known) = ledger.handling(&case) {
                return Ok(Some(known));
            }
            let handling = bench.handling(&case).map_err(wrap)?;
            ledger.add_handling(&case, &handling)?;
            Ok(Some(handling))
        };
        let (ride, handling) = rayon::join(ride, handling);
        let (ride, handling) = (ride?, handling?);
        let visit = Visit {
            case,
            objective: self.value(ride, handling),
            ride,
            handling,
        };
        let mut memory = self.memory.borrow_mut();
        memory.runs += usize::from(ride.is_some()) + usize::from(handling.is_some());
        let index = memory.path.len();
        memory.looked.insert(key, index);
        memory.path.push(visit);
        drop(memory);
        (self.done)(&visit);
        Ok(visit)
    }

    fn value(&self, ride: Option<Ride>, handling: Option<Handling>) -> f64 {
        let reference = self.reference.unwrap_or((ride, handling));
        self.objective.weights.objective(ride, handling, reference)
    }
}

impl CostFunction for &Search<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, x: &Self::Param) -> Result<f64, argmin::core::Error> {
        let (case, outside) = self.case(x);
        match self.look(case) {
            Ok(visit) => Ok(visit.objective + OUTSIDE * outside),
            Err(failure) => {
                self.memory.borrow_mut().failure = Some(failure);
                Err(argmin::core::Error::msg("a run failed"))
            }
        }
    }
}

/// Searches the sweep's range for the least objective. `done` is told of every new point.
///
/// # Errors
/// A run that could not be made, a ledger that cannot be written.
pub fn optimise(
    bench: &Bench,
    ledger: &Ledger,
    objective: Objective,
    done: &(dyn Fn(&Visit) + Sync),
) -> Result<Optimum, SweepError> {
    let memory = RefCell::new(Memory::default());
    let mut search = Search {
        bench,
        ledger,
        objective,
        reference: None,
        memory,
        done,
    };
    let reference = search.look(Case::alike(5e-4, 1.0))?;
    search.reference = Some((reference.ride, reference.handling));

    let variables = if objective.per_axle { 4 } else { 2 };
    // A simplex about the middle of the range, large enough to see across it.
    let mut simplex = vec![vec![0.4; variables]];
    for i in 0..variables {
        let mut corner = vec![0.4; variables];
        corner[i] = 0.85;
        simplex.push(corner);
    }
    let solver = NelderMead::new(simplex).with_sd_tolerance(2e-3);
    // A failed run is kept beside the path. Without one the solver has nothing to complain of, and its best is the best of the path either way.
    drop(solver.and_then(|solver| {
        Executor::new(&search, solver)
            .configure(|state| state.max_iters(objective.iterations))
            .timer(false)
            .run()
    }));
    let mut memory = search.memory.into_inner();
    if let Some(failure) = memory.failure.take() {
        return Err(failure);
    }
    let best = memory.path.iter().fold(
        reference,
        |best, visit| if visit.objective < best.objective { *visit } else { best },
    );
    Ok(Optimum {
        best,
        path: memory.path,
        runs: memory.runs,
    })
}
