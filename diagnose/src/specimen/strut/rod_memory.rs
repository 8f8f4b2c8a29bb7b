//! Simulations of the oil that are wanted again with other forces on the rod.
//!
//! Screening tries dozens of frictions, stops and laws at the seal beside one model, and a fit takes derivatives by them. None of these needs another
//! simulation of the oil. What is remembered changes no bit of a result, so that it does not matter which thread was first.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use oleo_plant_sim::model_file::{Checked, InvalidValue};
use oleo_plant_sim::strut::{self, Beginning, Inputs, Prediction, Replay, Replayed, RodCourse, StrutModel};

/// Models of which is known that they were simulated once. A fit simulates one for each of its parameters before it returns to the first.
const SEEN: usize = 48;
/// Simulations that are kept.
const KEPT: usize = 2;

/// What is remembered of one recording.
#[derive(Default)]
pub struct RodMemory {
    remembered: Mutex<Remembered>,
}

#[derive(Default)]
struct Remembered {
    /// Models without rod forces that were wanted once, the last one first.
    seen: VecDeque<(StrutModel, Beginning)>,
    /// Those that were wanted again, with what their rods went through.
    kept: VecDeque<Arc<Kept>>,
}

struct Kept {
    bare: StrutModel,
    begins: Beginning,
    prediction: Prediction,
    course: RodCourse,
}

impl Kept {
    fn is_of(&self, bare: &StrutModel, begins: Beginning) -> bool {
        self.bare == *bare && self.begins == begins
    }
}

/// A recording that is wanted under a model. The model has no instrument but that of the displacement.
#[derive(Clone, Copy)]
pub struct Wanted<'a> {
    /// What is remembered of the recording.
    pub memory: &'a RodMemory,
    pub model: &'a StrutModel,
    pub inputs: &'a Inputs,
    /// How the recording begins under the hypothesis.
    pub begins: Beginning,
}

/// How a wanted recording is come by.
enum Plan {
    /// Simulated as it is.
    AsIs,
    /// From a simulation that is remembered.
    Known(Arc<Kept>),
    /// From a simulation without the rod forces, which is kept if it is wanted again.
    Bare { bare: Box<StrutModel>, is_kept: bool },
    /// From that of another one that is wanted at the same time.
    SameAs(usize),
}

/// Predicted readings of recordings, as [`replay`](oleo_plant_sim::strut::replay()) gives them to the tolerance of the solver; four are simulated at
/// once. An impossible value in a model is the error of this one only.
pub fn replay_all(wanted: &[Wanted<'_>]) -> Vec<Result<Prediction, InvalidValue>> {
    let plans = planned(wanted);
    let simulated: Vec<Replay<'_>> = (plans.iter().zip(wanted))
        .filter_map(|(plan, wanted)| {
            let of = |model, with_course| Replay {
                model,
                inputs: wanted.inputs,
                begins: wanted.begins,
                with_course,
            };
            match plan {
                Ok(Plan::AsIs) => Some(of(wanted.model, false)),
                Ok(Plan::Bare { bare, .. }) => Some(of(bare, true)),
                Ok(Plan::Known(_) | Plan::SameAs(_)) | Err(_) => None,
            }
        })
        .collect();
    let mut simulated = strut::replay_all(&simulated).into_iter();
    let mut next = || simulated.next().unwrap_or_else(|| Ok(Replayed::default()));
    let mut by_place: Vec<Option<Arc<Kept>>> = Vec::with_capacity(wanted.len());
    let mut predicted = Vec::with_capacity(wanted.len());
    for (plan, wanted) in plans.into_iter().zip(wanted) {
        let (kept, prediction) = match plan {
            Err(invalid) => (None, Err(invalid)),
            Ok(Plan::AsIs) => (None, next().map(|replayed| replayed.prediction)),
            Ok(Plan::Known(kept)) => from_kept(Some(kept), wanted),
            Ok(Plan::SameAs(earlier)) => from_kept(by_place[earlier].clone(), wanted),
            Ok(Plan::Bare { bare, is_kept }) => match next() {
                Err(invalid) => (None, Err(invalid)),
                Ok(Replayed { prediction, course }) => {
                    let course = course.unwrap_or_default();
                    let kept = Arc::new(Kept {
                        bare: *bare,
                        begins: wanted.begins,
                        prediction,
                        course,
                    });
                    if is_kept {
                        wanted.memory.keep(&kept);
                    }
                    from_kept(Some(kept), wanted)
                }
            },
        };
        by_place.push(kept);
        predicted.push(prediction);
    }
    predicted
}

/// What a kept simulation is with the rod forces of a model. Without one, whose own simulation failed, the model says why.
fn from_kept(kept: Option<Arc<Kept>>, wanted: &Wanted<'_>) -> (Option<Arc<Kept>>, Result<Prediction, InvalidValue>) {
    let prediction = match &kept {
        Some(kept) => Ok(Prediction {
            force_n: kept.course.force_n(&wanted.model.effects),
            pressure_pa: kept.prediction.pressure_pa.clone(),
        }),
        None => strut::replay_from(wanted.model, wanted.inputs, &wanted.begins),
    };
    (kept, prediction)
}

/// Always without the rod forces where that can be: the solver of a model with laws differs in the last digits, and results must not depend on what was
/// simulated before.
fn planned(wanted: &[Wanted<'_>]) -> Vec<Result<Plan, InvalidValue>> {
    let mut plans: Vec<Result<Plan, InvalidValue>> = Vec::with_capacity(wanted.len());
    for this in wanted {
        let Some(bare) = this.model.without_rod_forces().filter(|bare| bare != this.model) else {
            plans.push(Ok(Plan::AsIs));
            continue;
        };
        if let Err(invalid) = this.model.check() {
            plans.push(Err(invalid));
            continue;
        }
        let found = this.memory.find(&bare, this.begins);
        let earlier = (plans.iter_mut().zip(wanted).enumerate()).find_map(|(k, (plan, other))| match plan {
            Ok(Plan::Bare { bare: same, is_kept })
                if std::ptr::eq(other.memory, this.memory) && **same == bare && other.begins == this.begins =>
            {
                *is_kept = true;
                Some(k)
            }
            _ => None,
        });
        plans.push(Ok(match (found, earlier) {
            (Found::Known(kept), _) => Plan::Known(kept),
            (_, Some(earlier)) => Plan::SameAs(earlier),
            (found, None) => Plan::Bare {
                bare: Box::new(bare),
                is_kept: matches!(found, Found::Again),
            },
        }));
    }
    plans
}

impl RodMemory {
    fn find(&self, bare: &StrutModel, begins: Beginning) -> Found {
        let mut remembered = self.remembered.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(kept) = remembered.kept.iter().find(|kept| kept.is_of(bare, begins)) {
            return Found::Known(Arc::clone(kept));
        }
        if remembered
            .seen
            .iter()
            .any(|(model, began)| model == bare && *began == begins)
        {
            return Found::Again;
        }
        remembered.seen.push_front((bare.clone(), begins));
        remembered.seen.truncate(SEEN);
        Found::First
    }

    fn keep(&self, kept: &Arc<Kept>) {
        let mut remembered = self.remembered.lock().unwrap_or_else(PoisonError::into_inner);
        if remembered
            .kept
            .iter()
            .all(|other| !other.is_of(&kept.bare, kept.begins))
        {
            remembered.kept.push_front(Arc::clone(kept));
            remembered.kept.truncate(KEPT);
        }
    }
}

/// What is known of a model without rod forces.
enum Found {
    First,
    Again,
    Known(Arc<Kept>),
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_interface::StrutValves;
    use oleo_plant_sim::strut::{BumpStop, replay};

    #[test]
    fn what_is_remembered_changes_no_bit() {
        let time_s: Vec<f64> = (0..=300).map(|k| 0.01 * f64::from(k)).collect();
        let displacement_m: Vec<f64> = time_s.iter().map(|t| 0.08 * libm::sin(4.0 * t)).collect();
        let signals = vec![StrutValves::new(true, false, true); time_s.len()];
        let inputs = Inputs::from_recording(&time_s, &displacement_m, &signals, 5e-6);
        let model = |k: i32| {
            let mut model = StrutModel::defender110(8000.0);
            model.effects.bump_stop = Some(BumpStop {
                bump_clearance_m: 0.05,
                rebound_clearance_m: 0.05,
                stiffness_n_m: 1e4 * f64::from(1 + k),
                progression_n_m3: 0.0,
            });
            model
        };
        let models: Vec<StrutModel> = (0..6).map(model).collect();
        let alone: Vec<Prediction> = models.iter().map(|model| replay(model, &inputs).unwrap()).collect();
        // One after the other, and any number at once.
        for at_once in [1, 2, 4, 6] {
            let memory = RodMemory::default();
            for (models, alone) in models.chunks(at_once).zip(alone.chunks(at_once)) {
                let wanted: Vec<Wanted<'_>> = (models.iter())
                    .map(|model| Wanted {
                        memory: &memory,
                        model,
                        inputs: &inputs,
                        begins: Beginning::AtRest,
                    })
                    .collect();
                for (predicted, alone) in replay_all(&wanted).into_iter().zip(alone) {
                    assert_eq!(predicted.unwrap(), *alone);
                }
            }
            let remembered = memory.remembered.lock().unwrap();
            assert_eq!((remembered.seen.len(), remembered.kept.len()), (1, 1));
        }
    }
}
