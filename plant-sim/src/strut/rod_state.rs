//! Where the rod of a strut is and how it moves, for the forces on it and for laws over them.

use serde::{Deserialize, Serialize};

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

/// What a rod has gone through in a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct RodStep {
    /// The way that it took, m, jounce positive.
    pub stroke_m: f64,
    /// The time that it took, s.
    pub duration_s: f64,
    /// Gauge pressure p1 at its beginning, Pa.
    pub begun_p1_pa: f64,
    /// Force of the oil on the rod at its beginning, N.
    pub begun_oil_force_n: f64,
    /// The state that it has led to.
    pub end: RodState,
}

impl RodStep {
    /// The state at its beginning, except that speed and acceleration are those of the end.
    pub fn begun(&self) -> RodState {
        RodState {
            displacement_m: self.end.displacement_m - self.stroke_m,
            p1_pa: self.begun_p1_pa,
            oil_force_n: self.begun_oil_force_n,
            time_s: self.end.time_s - self.duration_s,
            ..self.end
        }
    }
}

/// Acceleration of the rod at the end of an interval, from the speeds gained in this interval and in the one before. It is worked out
/// where a law asks for it only.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
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

    /// A known acceleration, m/s2.
    pub const fn known(m_s2: f64) -> Self {
        Self {
            gained_m_s: [0.0, m_s2],
            duration_s: [0.0, 1.0],
        }
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
