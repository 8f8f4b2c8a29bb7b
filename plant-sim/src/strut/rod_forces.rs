//! Forces between rod and cylinder other than the oil pressure: friction, stops and laws without a name.

use super::friction::{PRESLIDING_STIFFNESS_N_M, advance_friction};
use super::terms::{BumpStop, Effects, LawPlace, SealFriction, SealLaw, SideLoadFriction};

/// Forces between rod and cylinder beside that of the oil.
#[derive(Debug, Clone)]
pub(super) struct RodForces {
    seal: Option<SealFriction>,
    side_load: Option<SideLoadFriction>,
    friction_law: Option<SealLaw>,
    stops: Option<BumpStop>,
    force_law: Option<SealLaw>,
    friction_n: f64,
}

/// Where the rod is, how fast it moves, and what presses on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct RodState {
    /// Displacement, m, compression positive.
    pub displacement_m: f64,
    /// Speed of the rod, m/s, positive in jounce.
    pub speed_m_s: f64,
    /// Acceleration of the rod, positive in jounce.
    pub acceleration: Acceleration,
    /// Gauge pressure p1, Pa.
    pub p1_pa: f64,
    /// Force of the oil on the rod, N.
    pub oil_force_n: f64,
    /// Time since the start, s.
    pub time_s: f64,
}

/// Acceleration of the rod at the end of an interval, from the speeds gained in this interval and in the one before. It is worked out
/// where a law asks for it only.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Acceleration {
    gained_m_s: [f64; 2],
    duration_s: [f64; 2],
}

impl Acceleration {
    /// Takes the speed that was gained in the next interval, m/s, and its duration, s.
    pub fn follow(&mut self, gained_m_s: f64, duration_s: f64) {
        let ([_, gained], [_, lasted]) = (self.gained_m_s, self.duration_s);
        *self = Self {
            gained_m_s: [gained, gained_m_s],
            duration_s: [lasted, duration_s],
        };
    }

    /// Acceleration now, m/s2. The mean ones of the two intervals belong to their middles, and a line through them leads here.
    pub fn now_m_s2(&self) -> f64 {
        let ([gained_before, gained], [before, last]) = (self.gained_m_s, self.duration_s);
        if last == 0.0 {
            return 0.0;
        }
        let mean = gained / last;
        if before == 0.0 {
            return mean;
        }
        mean + (mean - gained_before / before) * last / (before + last)
    }
}

impl RodForces {
    /// The forces of a model, on a rod whose friction has been released.
    pub fn of(effects: &Effects) -> Self {
        Self {
            seal: effects.seal_friction.clone(),
            side_load: effects.side_load_friction.clone(),
            friction_law: SealLaw::at(&effects.unlisted, LawPlace::MainSealFriction),
            stops: effects.bump_stop.clone(),
            force_law: SealLaw::at(&effects.unlisted, LawPlace::MainSeal),
            friction_n: 0.0,
        }
    }

    /// Let the friction follow a stroke (m) that has taken `duration_s` and has led to a state.
    pub fn follow(&mut self, stroke_m: f64, duration_s: f64, rod: &RodState) {
        if self.seal.is_none() && self.side_load.is_none() && self.friction_law.is_none() {
            return;
        }
        let mut level_n = self
            .seal
            .as_ref()
            .map_or(0.0, |seal| seal.level_n(stroke_m / duration_s));
        if let Some(side) = &self.side_load {
            level_n += side.level_n(rod.oil_force_n, rod.displacement_m);
        }
        if let Some(law) = &self.friction_law {
            level_n += law.value_n(rod);
        }
        let stiffness = (self.seal.as_ref()).map_or(PRESLIDING_STIFFNESS_N_M, |seal| seal.presliding_stiffness_n_m);
        self.friction_n = advance_friction(self.friction_n, stroke_m, level_n, stiffness);
    }

    /// Friction, N, positive against jounce.
    pub fn friction_n(&self) -> f64 {
        self.friction_n
    }

    /// Force on the load cell in a state: that of the oil and all of these, N, compression positive.
    pub fn total_n(&self, rod: &RodState) -> f64 {
        let mut force_n = rod.oil_force_n + self.friction_n;
        if let Some(stops) = &self.stops {
            force_n += stops.force_n(rod.displacement_m);
        }
        if let Some(law) = &self.force_law {
            force_n += law.value_n(rod);
        }
        force_n
    }
}

#[cfg(test)]
mod tests {
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
    fn an_acceleration_that_grows_evenly_is_known_at_the_end_of_each_interval() {
        let mut acceleration = Acceleration::default();
        assert_eq!(acceleration.now_m_s2(), 0.0);
        // v = t^2, so that a = 2 t.
        let mut time_s = 0.0;
        for duration_s in [0.01, 0.02, 0.005, 0.01] {
            let end_s = time_s + duration_s;
            acceleration.follow(end_s * end_s - time_s * time_s, duration_s);
            time_s = end_s;
        }
        assert!((acceleration.now_m_s2() - 2.0 * time_s).abs() < 1e-12);
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
