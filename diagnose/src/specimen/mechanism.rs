//! What dampers and drives share: what their models may lack, and how it is put into them.

use oleo_plant_sim::specimen::{MechanismEffects, SmoothedMotion};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::channel::StateSeries;
use super::hypothesis::Hypothesis;
use crate::effect::{ALL, Candidate, of, sensor};
use crate::excitation;
use crate::vocabulary::{EffectId, State};

/// Everything that the model may lack: physics, laws without a name, then the compared instrument.
pub fn candidates(model: &MechanismEffects, excitation: &excitation::Mechanism) -> Vec<Candidate> {
    let of_effect = |id: EffectId| {
        of(id)
            .in_mechanism()
            .map_or(vec![], |e| e.candidates(model, excitation))
    };
    let physics = ALL.iter().copied().filter(|id| id.is_physics());
    (physics.chain([EffectId::Unlisted]).chain(sensor::IN_ORDER))
        .flat_map(of_effect)
        .map(|candidate| candidate.testable_unless(excitation.still.clone()))
        .collect()
}

/// Puts the effects of a hypothesis into a model.
pub fn put(effects: &mut MechanismEffects, candidates: &[Candidate], hypothesis: &Hypothesis) {
    for (index, values) in &hypothesis.effects {
        let candidate = &candidates[*index];
        if let Some(effect) = of(candidate.id).in_mechanism() {
            effect.put(effects, candidate, values);
        }
    }
}

/// The states of a motion in which a misfit is looked for.
pub fn states(motion: &SmoothedMotion) -> Vec<StateSeries> {
    vec![
        StateSeries::new(State::Displacement, motion.displacement_m.clone()),
        StateSeries::new(State::Speed, motion.speed_m_s.clone()),
        StateSeries::new(State::Acceleration, motion.acceleration_m_s2.clone()),
    ]
}

/// Seed of the noise that is added to a motion; fixed, so that a report is the same every time.
const SEED: u64 = 1;

/// Displacements of a motion with noise of a standard deviation (m) added once more. Smoothing adds up many samples, so plus
/// or minus one standard deviation is as good as a normal number.
pub fn jittered(motion: &SmoothedMotion, noise_m: f64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    (motion.displacement_m.iter())
        .map(|x| {
            if random.next_u32() & 1 == 0 {
                x + noise_m
            } else {
                x - noise_m
            }
        })
        .collect()
}

/// The noise ratio that a complete model reaches, from what it predicts of each motion and of the same with noise added once
/// more. Only what exceeds this floor is unexplained.
pub fn floor(predictions: &[(Vec<f64>, Vec<f64>)], noise: f64) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for (as_is, jittered) in predictions {
        sum += as_is.iter().zip(jittered).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        count += as_is.len();
    }
    (1.0 + sum / (noise * noise * count.max(1) as f64)).sqrt()
}
