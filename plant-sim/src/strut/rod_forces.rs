//! Forces between rod and cylinder other than the oil pressure: friction, stops and laws without a name.

use super::rod_friction::{RodFriction, Stroke};
use super::rod_state::{RodState, RodStep};
use super::terms::{BumpStop, Effects, LawPlace, SealLaw};

/// Forces between rod and cylinder beside that of the oil.
#[derive(Debug, Clone)]
pub(super) struct RodForces {
    friction: RodFriction,
    friction_laws: Vec<SealLaw>,
    stops: Option<BumpStop>,
    force_laws: Vec<SealLaw>,
    friction_n: f64,
}

impl RodForces {
    /// The forces of a model, on a rod whose friction has been released.
    pub fn of(effects: &Effects) -> Self {
        Self {
            friction: RodFriction::of(effects),
            friction_laws: SealLaw::all_at(&effects.unlisted, LawPlace::MainSealFriction),
            stops: effects.bump_stop.clone(),
            force_laws: SealLaw::all_at(&effects.unlisted, LawPlace::MainSeal),
            friction_n: 0.0,
        }
    }

    /// What rubs, where no law without a name rubs beside it.
    pub fn lawless_friction(&self) -> Option<&RodFriction> {
        self.friction_laws.is_empty().then_some(&self.friction)
    }

    /// Whether anything rubs.
    #[inline(always)]
    pub fn rubs(&self) -> bool {
        !self.friction.is_none() || !self.friction_laws.is_empty()
    }

    /// Lets the friction follow a step.
    pub fn follow(&mut self, step: &RodStep) {
        let stroke = Stroke {
            stroke_m: step.stroke_m,
            duration_s: step.duration_s,
            displacement_m: step.end.displacement_m,
            oil_forces_n: [step.begun_oil_force_n, step.end.oil_force_n],
        };
        self.friction_n = if self.friction_laws.is_empty() {
            self.friction.after_n(self.friction_n, &stroke)
        } else {
            let [begin_n, end_n] = self.friction.levels_n(&stroke);
            let with_laws_n = |own_n: f64, rod: &RodState| {
                (self.friction_laws.iter()).fold(own_n, |level_n, law| level_n + law.value_n(rod))
            };
            let levels_n = [with_laws_n(begin_n, &step.begun()), with_laws_n(end_n, &step.end)];
            self.friction.between_n(self.friction_n, step.stroke_m, levels_n)
        };
    }

    /// Puts the friction at a value that it had, N.
    pub fn set_friction_n(&mut self, friction_n: f64) {
        self.friction_n = friction_n;
    }

    /// Friction, N, positive against jounce.
    pub fn friction_n(&self) -> f64 {
        self.friction_n
    }

    /// Force on the load cell in a state: that of the oil and all of these, N, compression positive.
    #[inline]
    pub fn total_n(&self, rod: &RodState) -> f64 {
        let mut force_n = rod.oil_force_n + self.friction_n;
        if let Some(stops) = &self.stops {
            force_n += stops.force_n(rod.displacement_m);
        }
        for law in &self.force_laws {
            force_n += law.value_n(rod);
        }
        force_n
    }
}

#[cfg(test)]
mod tests {
    use super::super::friction::PRESLIDING_STIFFNESS_N_M;
    use super::super::rod_state::Acceleration;
    use super::super::terms::{LawArgument, SealFriction, SideLoadFriction, UnlistedLaw};
    use super::*;
    use crate::strut::motion::Motion;
    use crate::strut::{Inputs, StrutModel, replay};
    use oleo_interface::StrutValves;

    fn at(displacement_m: f64, oil_force_n: f64) -> RodState {
        RodState {
            displacement_m,
            speed_m_s: 0.1,
            acceleration: Acceleration::default(),
            p1_pa: 4e6,
            oil_force_n,
            time_s: 0.0,
        }
    }

    /// A step of a second from zero, under an oil force that stays.
    fn moved(displacement_m: f64, oil_force_n: f64) -> RodStep {
        RodStep {
            stroke_m: displacement_m,
            duration_s: 1.0,
            begun_p1_pa: 4e6,
            begun_oil_force_n: oil_force_n,
            end: at(displacement_m, oil_force_n),
        }
    }

    #[test]
    fn levels_of_friction_add_and_a_bare_rod_has_none() {
        let mut bare = RodForces::of(&Effects::default());
        bare.follow(&moved(0.1, 8000.0));
        assert_eq!(bare.total_n(&at(0.1, 8000.0)), 8000.0);
        let mut both = RodForces::of(&Effects {
            seal_friction: Some(SealFriction {
                coulomb_force_n: 100.0,
                breakaway_force_n: 100.0,
                stribeck_speed_m_s: 0.01,
                presliding_stiffness_n_m: 2e6,
            }),
            side_load_friction: Some(SideLoadFriction {
                coefficient: 0.02,
                overlap_growth_1_m: 0.0,
            }),
            ..Effects::default()
        });
        both.follow(&moved(0.1, 8000.0));
        assert!((both.friction_n() - 260.0).abs() < 1e-9);
    }

    /// Force, N, of a strut with closed valves whose rod is at a displacement (m) with a speed (m/s) at a time, sampled at an interval.
    fn recorded_n(model: &StrutModel, interval_s: f64, samples: usize, rod: impl Fn(f64) -> (f64, f64)) -> Vec<f64> {
        let time_s: Vec<f64> = (0..=samples).map(|k| interval_s * k as f64).collect();
        let inputs = Inputs {
            motion: Motion::through(time_s.iter().map(|t| rod(*t))),
            signals: vec![StrutValves::default(); samples + 1],
            time_s,
        };
        replay(model, &inputs).unwrap().force_n
    }

    /// Force of a strut whose rod moves on at 1 mm/s, sampled at an interval: its seal shears for 0.2 s to its level, to which a law adds.
    fn creeping_n(law: &UnlistedLaw, interval_s: f64, samples: usize) -> Vec<f64> {
        let mut model = StrutModel::defender110(8000.0);
        model.effects.seal_friction = Some(SealFriction {
            coulomb_force_n: 400.0,
            breakaway_force_n: 400.0,
            stribeck_speed_m_s: 0.01,
            presliding_stiffness_n_m: 2e6,
        });
        model.effects.unlisted = vec![law.clone()];
        let speed_m_s = 1e-3;
        recorded_n(&model, interval_s, samples, |t| (speed_m_s * t, speed_m_s))
    }

    /// A law of friction that grows evenly, by 4 kN from zero to a hundredth.
    fn of_friction(depends_on: LawArgument) -> UnlistedLaw {
        UnlistedLaw {
            place: LawPlace::MainSealFriction,
            depends_on,
            argument: vec![0.0, 0.01],
            value: vec![0.0, 4000.0],
            time_constant_s: None,
            frequency_hz: None,
            presliding_volume_m3: None,
            attraction: None,
        }
    }

    #[test]
    fn friction_over_the_displacement_is_the_same_however_coarsely_it_is_sampled() {
        let law = of_friction(LawArgument::Displacement);
        let (coarse, fine) = (creeping_n(&law, 0.05, 200), creeping_n(&law, 0.001, 10_000));
        // It grows by 20 N a step, of which a fiftieth is left out. With that at the end of each step it would be up to 6 N off.
        for (coarse, fine) in coarse.iter().zip(fine.iter().step_by(50)).skip(20) {
            assert!((coarse - fine).abs() < 0.4, "{coarse} {fine}");
        }
    }

    #[test]
    fn friction_that_swings_is_the_same_however_coarsely_it_is_sampled() {
        let law = UnlistedLaw {
            argument: (0..=40).map(|k| f64::from(k) / 40.0).collect(),
            value: (0..=40)
                .map(|k| 200.0 * libm::sin(std::f64::consts::TAU * f64::from(k) / 40.0))
                .collect(),
            frequency_hz: Some(0.7),
            ..of_friction(LawArgument::Phase)
        };
        let (coarse, fine) = (creeping_n(&law, 0.05, 200), creeping_n(&law, 0.001, 10_000));
        // Within a step the level is curved: by an eighth of the square of what its phase turns. With that at the end of each step it would be up to 20 N off.
        let turned = std::f64::consts::TAU * 0.7 * 0.05;
        let curved_n = 200.0 * turned * turned / 8.0;
        for (coarse, fine) in coarse.iter().zip(fine.iter().step_by(50)).skip(20) {
            assert!((coarse - fine).abs() < curved_n, "{coarse} {fine}");
        }
    }

    #[test]
    fn friction_that_follows_the_force_is_the_same_however_coarsely_it_is_sampled() {
        let mut model = StrutModel::defender110(8000.0);
        model.effects.seal_friction = None;
        model.effects.side_load_friction = Some(SideLoadFriction {
            coefficient: 0.2,
            overlap_growth_1_m: 0.0,
        });
        let (stroke_m, w, interval_s) = (0.025, 4.0 * std::f64::consts::PI, 0.002);
        let swinging_n = |interval_s: f64, samples: usize| {
            recorded_n(&model, interval_s, samples, |t| {
                (stroke_m * libm::sin(w * t), stroke_m * w * libm::cos(w * t))
            })
        };
        let (coarse, fine) = (swinging_n(interval_s, 1000), swinging_n(interval_s / 20.0, 20_000));
        // Where the rod turns within a step, the way back is not seen, and the seal shears by twice as much. With the level at the end of each step it would
        // be up to 23 N off.
        let back_m = stroke_m * w * w * interval_s * interval_s / 8.0;
        let unseen_n = 2.0 * PRESLIDING_STIFFNESS_N_M * back_m;
        // The speed jumps at the first sample.
        for (coarse, fine) in coarse.iter().zip(fine.iter().step_by(20)).skip(2) {
            assert!((coarse - fine).abs() < unseen_n + 1.0, "{coarse} {fine}");
        }
    }
}
