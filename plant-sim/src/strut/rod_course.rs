//! What the rod of a strut went through in a simulation, from which the force with other forces on the rod follows without another one.
//!
//! Friction, stops and laws at the seal act on the load cell only, as long as the mount does not bend: the actuator moves the rod whatever resists. So
//! a search that tries many of them beside one model simulates the oil once.

use super::model::StrutModel;
use super::rod_forces::RodForces;
use super::rod_state::{RodState, RodStep};
use super::terms::{Effects, LawArgument, LawPlace, UnlistedLaw};

/// What the rod has gone through in a simulation: every step, and its states at the samples.
#[derive(Debug, Clone, Default)]
pub struct RodCourse {
    steps: Vec<RodStep>,
    samples: Vec<Sample>,
}

#[derive(Debug, Clone, Copy)]
struct Sample {
    /// Number of steps before it.
    steps: usize,
    rod: RodState,
}

impl RodCourse {
    /// A step of the integrator has ended.
    pub(super) fn push_step(&mut self, step: RodStep) {
        self.steps.push(step);
    }

    /// A sample is due.
    pub(super) fn push_sample(&mut self, rod: RodState) {
        let steps = self.steps.len();
        self.samples.push(Sample { steps, rod });
    }

    /// Force of the load cell at the samples, N, with the rod forces of these effects: what a simulation gives with them, to the tolerance of the
    /// solver, which takes another course through models with laws. Only for effects that differ from the simulated ones in rod forces
    /// ([`StrutModel::without_rod_forces`]).
    #[must_use]
    pub fn force_n(&self, effects: &Effects) -> Vec<f64> {
        let mut forces = RodForces::of(effects);
        let mut done = 0;
        (self.samples.iter())
            .map(|sample| {
                for step in &self.steps[done..sample.steps] {
                    forces.follow(step);
                }
                done = sample.steps;
                forces.total_n(&sample.rod)
            })
            .collect()
    }
}

impl StrutModel {
    /// The model without forces on the rod besides that of the oil; `None` if one of them acts on more than the load cell, because the mount bends or
    /// because the steps of the simulation follow it.
    #[must_use]
    pub fn without_rod_forces(&self) -> Option<Self> {
        let is_at_seal = |place| matches!(place, LawPlace::MainSeal | LawPlace::MainSealFriction);
        let effects = &self.effects;
        let bends_or_sets_steps = |law: &UnlistedLaw| {
            law.place == LawPlace::Mount || (is_at_seal(law.place) && law.depends_on == LawArgument::Phase)
        };
        if effects.mount_compliance.is_some() || effects.unlisted.iter().any(bends_or_sets_steps) {
            return None;
        }
        let mut bare = self.clone();
        bare.effects.seal_friction = None;
        bare.effects.side_load_friction = None;
        bare.effects.bump_stop = None;
        bare.effects.unlisted.retain(|law| !is_at_seal(law.place));
        Some(bare)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::motion::Motion;
    use crate::strut::{
        BumpStop, Inputs, MountCompliance, SealFriction, SideLoadFriction, UnlistedLaw, replay, replay_with_course,
    };
    use oleo_interface::StrutValves;

    /// A sweep over the whole travel with a switching edge, so that steps are of unequal length.
    fn sweep() -> Inputs {
        let time_s: Vec<f64> = (0..=400).map(|k| 0.01 * f64::from(k)).collect();
        let at = |t: f64| (0.08 * libm::sin(3.0 * t), 0.24 * libm::cos(3.0 * t));
        Inputs {
            motion: Motion::through(time_s.iter().map(|t| at(*t))),
            signals: (0..time_s.len())
                .map(|k| StrutValves::new(k % 90 > 40, true, k > 200))
                .collect(),
            time_s,
        }
    }

    fn with_rod_forces() -> StrutModel {
        let mut model = StrutModel::defender110(8000.0);
        let law = |place, depends_on| UnlistedLaw {
            place,
            depends_on,
            argument: vec![0.0, 1.0],
            value: vec![20.0, 90.0],
            time_constant_s: None,
            frequency_hz: None,
            presliding_volume_m3: None,
            attraction: None,
        };
        model.effects.seal_friction = Some(SealFriction {
            coulomb_force_n: 100.0,
            breakaway_force_n: 140.0,
            stribeck_speed_m_s: 0.01,
            presliding_stiffness_n_m: 2e6,
        });
        model.effects.side_load_friction = Some(SideLoadFriction {
            coefficient: 0.02,
            overlap_growth_1_m: 1.0,
        });
        model.effects.bump_stop = Some(BumpStop {
            bump_clearance_m: 0.06,
            rebound_clearance_m: 0.06,
            stiffness_n_m: 1e5,
            progression_n_m3: 1e8,
        });
        model.effects.unlisted = vec![
            law(LawPlace::MainSeal, LawArgument::Acceleration),
            law(LawPlace::MainSealFriction, LawArgument::Time),
        ];
        model
    }

    #[test]
    fn the_force_on_a_known_course_is_that_of_a_simulation() {
        let (with_laws, inputs) = (with_rod_forces(), sweep());
        let mut named = with_laws.clone();
        named.effects.unlisted.clear();
        for (model, tolerance_n) in [(named, 0.0), (with_laws, 0.1)] {
            let simulated = replay(&model, &inputs).unwrap();
            let (bare, course) = replay_with_course(&model.without_rod_forces().unwrap(), &inputs).unwrap();
            assert_ne!(bare.force_n, simulated.force_n);
            for (a, b) in course.force_n(&model.effects).iter().zip(&simulated.force_n) {
                assert!((a - b).abs() <= tolerance_n, "{a} {b}");
            }
        }
    }

    #[test]
    fn a_mount_that_bends_hands_the_force_back_to_the_oil() {
        let mut model = with_rod_forces();
        model.effects.mount_compliance = Some(MountCompliance { stiffness_n_m: 1e7 });
        assert!(model.without_rod_forces().is_none());
    }
}
