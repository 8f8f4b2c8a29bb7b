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
        let laws_n = self.friction_laws.iter().map(|law| law.value_n(rod));
        let level_n = laws_n.fold(self.friction.level_n(&stroke), |level_n, law_n| level_n + law_n);
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
    use super::super::terms::{SealFriction, SideLoadFriction};
    use super::*;

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
}
