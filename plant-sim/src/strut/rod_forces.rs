//! Forces between rod and cylinder other than the oil pressure: friction, stops and laws without a name.

use super::rod_friction::{RodFriction, Stroke};
use super::rod_state::RodState;
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

    /// Let the friction follow a stroke (m) that has taken `duration_s` and has led to a state.
    pub fn follow(&mut self, stroke_m: f64, duration_s: f64, rod: &RodState) {
        if !self.rubs() {
            return;
        }
        let stroke = Stroke {
            stroke_m,
            duration_s,
            displacement_m: rod.displacement_m,
            oil_force_n: rod.oil_force_n,
        };
        let own_n = self.friction.level_n(&stroke);
        let with_laws_n =
            |rod: &RodState| (self.friction_laws.iter()).fold(own_n, |level_n, law| level_n + law.value_n(rod));
        let begun = RodState {
            time_s: rod.time_s - duration_s,
            ..*rod
        };
        let levels_n = [with_laws_n(&begun), with_laws_n(rod)];
        let level_n = self.friction.held_level_n(stroke_m, levels_n);
        self.friction_n = self.friction.after_n(self.friction_n, &stroke, level_n);
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
    use super::super::rod_state::Acceleration;
    use super::super::terms::{LawArgument, SealFriction, SideLoadFriction, UnlistedLaw};
    use super::*;
    use crate::strut::motion::{Motion, Segment};
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

    #[test]
    fn levels_of_friction_add_and_a_bare_rod_has_none() {
        let mut bare = RodForces::of(&Effects::default());
        bare.follow(0.1, 1.0, &at(0.1, 8000.0));
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
        both.follow(0.1, 1.0, &at(0.1, 8000.0));
        assert!((both.friction_n() - 260.0).abs() < 1e-9);
    }

    /// A rod that moves on at 1 mm/s, sampled at an interval: its seal shears for 0.2 s to its level, which swings.
    fn creeping_n(interval_s: f64, samples: usize) -> Vec<f64> {
        let mut model = StrutModel::defender110(8000.0);
        model.effects.seal_friction = Some(SealFriction {
            coulomb_force_n: 400.0,
            breakaway_force_n: 400.0,
            stribeck_speed_m_s: 0.01,
            presliding_stiffness_n_m: 2e6,
        });
        model.effects.unlisted = vec![UnlistedLaw {
            place: LawPlace::MainSealFriction,
            depends_on: LawArgument::Phase,
            argument: (0..=40).map(|k| f64::from(k) / 40.0).collect(),
            value: (0..=40)
                .map(|k| 200.0 * libm::sin(std::f64::consts::TAU * f64::from(k) / 40.0))
                .collect(),
            time_constant_s: None,
            frequency_hz: Some(0.7),
            presliding_volume_m3: None,
            attraction: None,
        }];
        let speed_m_s = 1e-3;
        let segment = |k: usize| Segment {
            to_m: speed_m_s * interval_s * (k + 1) as f64,
            from_m_s: speed_m_s,
            to_m_s: speed_m_s,
        };
        let inputs = Inputs {
            time_s: (0..=samples).map(|k| interval_s * k as f64).collect(),
            motion: Motion {
                start_m: 0.0,
                segments: (0..samples).map(segment).collect(),
            },
            signals: vec![StrutValves::new(true, true, true); samples + 1],
        };
        replay(&model, &inputs).unwrap().force_n
    }

    #[test]
    fn friction_that_swings_is_the_same_however_coarsely_it_is_sampled() {
        let (coarse, fine) = (creeping_n(0.05, 200), creeping_n(0.001, 10_000));
        for (coarse, fine) in coarse.iter().zip(fine.iter().step_by(50)).skip(20) {
            // The level is curved within a step of 50 ms. With that at the end of each step it would be up to 20 N off.
            assert!((coarse - fine).abs() < 1.0, "{coarse} {fine}");
        }
    }
}
