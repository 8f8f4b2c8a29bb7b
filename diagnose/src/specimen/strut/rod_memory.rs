//! Simulations of the oil that are wanted again with other forces on the rod.
//!
//! Screening tries dozens of frictions, stops and laws at the seal beside one model, and a fit takes derivatives by them. None of these needs another
//! simulation of the oil. What is remembered changes no bit of a result, so that it does not matter which thread was first.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use oleo_plant_sim::model_file::{Checked, InvalidValue};
use oleo_plant_sim::strut::{Inputs, Prediction, RodCourse, StrutModel, replay, replay_with_course};

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
    seen: VecDeque<StrutModel>,
    /// Those that were wanted again, with what their rods went through.
    kept: VecDeque<Arc<Kept>>,
}

struct Kept {
    bare: StrutModel,
    prediction: Prediction,
    course: RodCourse,
}

impl RodMemory {
    /// Predicted readings of a recording, as [`replay`] gives them to the tolerance of the solver. The model has no instrument but that of the displacement.
    ///
    /// # Errors
    /// Impossible values in the model.
    pub fn replay(&self, model: &StrutModel, inputs: &Inputs) -> Result<Prediction, InvalidValue> {
        let Some(bare) = model.without_rod_forces().filter(|bare| bare != model) else {
            return replay(model, inputs);
        };
        model.check()?;
        // Always without the rod forces: the solver of a model with laws differs in the last digits, and results must not depend on what was
        // simulated before.
        let kept = match self.find(&bare) {
            Wanted::Known(kept) => kept,
            wanted @ (Wanted::First | Wanted::Again) => {
                let (prediction, course) = replay_with_course(&bare, inputs)?;
                let kept = Arc::new(Kept {
                    bare,
                    prediction,
                    course,
                });
                if matches!(wanted, Wanted::Again) {
                    self.keep(&kept);
                }
                kept
            }
        };
        Ok(Prediction {
            force_n: kept.course.force_n(&model.effects),
            pressure_pa: kept.prediction.pressure_pa.clone(),
        })
    }

    fn find(&self, bare: &StrutModel) -> Wanted {
        let mut remembered = self.remembered.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(kept) = remembered.kept.iter().find(|kept| kept.bare == *bare) {
            return Wanted::Known(Arc::clone(kept));
        }
        if remembered.seen.contains(bare) {
            return Wanted::Again;
        }
        remembered.seen.push_front(bare.clone());
        remembered.seen.truncate(SEEN);
        Wanted::First
    }

    fn keep(&self, kept: &Arc<Kept>) {
        let mut remembered = self.remembered.lock().unwrap_or_else(PoisonError::into_inner);
        if remembered.kept.iter().all(|other| other.bare != kept.bare) {
            remembered.kept.push_front(Arc::clone(kept));
            remembered.kept.truncate(KEPT);
        }
    }
}

enum Wanted {
    First,
    Again,
    Known(Arc<Kept>),
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_interface::StrutValves;
    use oleo_plant_sim::strut::BumpStop;

    #[test]
    fn what_is_remembered_changes_no_bit() {
        let time_s: Vec<f64> = (0..=300).map(|k| 0.01 * f64::from(k)).collect();
        let displacement_m: Vec<f64> = time_s.iter().map(|t| 0.08 * libm::sin(4.0 * t)).collect();
        let signals = vec![StrutValves::new(true, false, true); time_s.len()];
        let inputs = Inputs::from_recording(&time_s, &displacement_m, &signals, 5e-6);
        let memory = RodMemory::default();
        for k in 0..6 {
            let mut model = StrutModel::defender110(8000.0);
            model.effects.bump_stop = Some(BumpStop {
                bump_clearance_m: 0.05,
                rebound_clearance_m: 0.05,
                stiffness_n_m: 1e4 * f64::from(1 + k),
                progression_n_m3: 0.0,
            });
            assert_eq!(
                memory.replay(&model, &inputs).unwrap(),
                replay(&model, &inputs).unwrap()
            );
        }
        let remembered = memory.remembered.lock().unwrap();
        assert_eq!((remembered.seen.len(), remembered.kept.len()), (1, 1));
    }
}
