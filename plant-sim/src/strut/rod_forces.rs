//! Forces between rod and cylinder other than the oil pressure: friction, stops and laws without a name.

use super::friction::{PRESLIDING_STIFFNESS_N_M, advance_friction};
use super::rod_state::RodState;
use super::terms::{BumpStop, Effects, LawPlace, SealFriction, SealLaw, SideLoadFriction};

/// Forces between rod and cylinder beside that of the oil.
#[derive(Debug, Clone)]
pub(super) struct RodForces {
    seal: Option<SealFriction>,
    side_load: Option<SideLoadFriction>,
    friction_laws: Vec<SealLaw>,
    stops: Option<BumpStop>,
    force_laws: Vec<SealLaw>,
    friction_n: f64,
}

impl RodForces {
    /// The forces of a model, on a rod whose friction has been released.
    pub fn of(effects: &Effects) -> Self {
        Self {
            seal: effects.seal_friction.clone(),
            side_load: effects.side_load_friction.clone(),
            friction_laws: SealLaw::all_at(&effects.unlisted, LawPlace::MainSealFriction),
            stops: effects.bump_stop.clone(),
            force_laws: SealLaw::all_at(&effects.unlisted, LawPlace::MainSeal),
            friction_n: 0.0,
        }
    }

    /// Let the friction follow a stroke (m) that has taken `duration_s` and has led to a state.
    #[inline(always)]
    pub fn follow(&mut self, stroke_m: f64, duration_s: f64, rod: &RodState) {
        if self.seal.is_some() || self.side_load.is_some() || !self.friction_laws.is_empty() {
            self.rub(stroke_m, duration_s, rod);
        }
    }

    fn rub(&mut self, stroke_m: f64, duration_s: f64, rod: &RodState) {
        let mut level_n = self
            .seal
            .as_ref()
            .map_or(0.0, |seal| seal.level_n(stroke_m / duration_s));
        if let Some(side) = &self.side_load {
            level_n += side.level_n(rod.oil_force_n, rod.displacement_m);
        }
        for law in &self.friction_laws {
            level_n += law.value_n(rod);
        }
        let stiffness = (self.seal.as_ref()).map_or(PRESLIDING_STIFFNESS_N_M, |seal| seal.presliding_stiffness_n_m);
        self.friction_n = advance_friction(self.friction_n, stroke_m, level_n, stiffness);
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
