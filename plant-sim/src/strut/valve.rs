//! Solenoid valves: when they begin to move after an edge of the switching signal, and how far they are open.
//!
//! 5 % of the change has happened after a fraction of the total response, 95 % after all of it (report, 3.5.3). The total
//! response is a polynomial of the pressure difference at the edge (term `valve_delay`); the way between the two points
//! is the term `valve_transition`.

use serde::{Deserialize, Serialize};

use super::terms::ValveTransition;

/// Movement of one valve. All times are on one clock, that of its owner.
///
/// ```
/// use oleo_plant_sim::strut::ValveMotion;
/// let mut valve = ValveMotion::at_rest(false);
/// valve.switch(true, 10.0, 0.05, 0.02, None);
/// assert_eq!((valve.opening(10.04), valve.opening(10.06)), (0.0, 1.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ValveMotion {
    signal: bool,
    from: f64,
    to: f64,
    /// Times between which the opening changes, s.
    begins_s: f64,
    ends_s: f64,
}

impl ValveMotion {
    /// A valve that has been at rest for long.
    #[must_use]
    pub fn at_rest(open: bool) -> Self {
        let u = f64::from(u8::from(open));
        Self {
            signal: open,
            from: u,
            to: u,
            begins_s: f64::NEG_INFINITY,
            ends_s: f64::NEG_INFINITY,
        }
    }

    /// The switching signal last seen.
    #[must_use]
    pub fn signal(&self) -> bool {
        self.signal
    }

    /// An edge of the switching signal at `now_s`: the movement starts anew from the opening reached.
    ///
    /// 5 % of the change has happened after `initial_s`, 95 % after `total_s`. Without a transition the valve moves in a step
    /// after `total_s`.
    pub fn switch(
        &mut self,
        open: bool,
        now_s: f64,
        total_s: f64,
        initial_s: f64,
        transition: Option<&ValveTransition>,
    ) {
        self.from = self.opening(now_s);
        self.to = f64::from(u8::from(open));
        self.signal = open;
        (self.begins_s, self.ends_s) = match transition {
            Some(transition) => transition.movement_s(now_s, initial_s, total_s),
            None => (now_s + total_s, now_s + total_s),
        };
    }

    /// Let the movement that an edge at `now_s` has begun in a step take a time (s) instead: 95 % of it are done at the step.
    pub fn take(&mut self, duration_s: f64, now_s: f64) {
        let duration_s = duration_s.clamp(0.0, (self.ends_s - now_s) / 0.95);
        self.begins_s -= 0.95 * duration_s;
        self.ends_s += 0.05 * duration_s;
    }

    /// Opening at a time, 0 closed, 1 open.
    #[inline]
    #[must_use]
    pub fn opening(&self, time_s: f64) -> f64 {
        if time_s >= self.ends_s {
            self.to
        } else if time_s <= self.begins_s {
            self.from
        } else {
            self.from + (self.to - self.from) * ((time_s - self.begins_s) / (self.ends_s - self.begins_s))
        }
    }

    /// The earliest kink of the movement after a time, infinite when there is none.
    #[inline]
    #[must_use]
    pub fn next_kink_s(&self, time_s: f64) -> f64 {
        if time_s < self.begins_s {
            self.begins_s
        } else if time_s < self.ends_s {
            self.ends_s
        } else {
            f64::INFINITY
        }
    }

    /// Time from which on the valve has done with its last movement, and neither moves nor is about to, s.
    #[inline]
    #[must_use]
    pub fn settled_s(&self) -> f64 {
        self.ends_s
    }

    /// Opening from then on.
    #[inline]
    #[must_use]
    pub fn settled_opening(&self) -> f64 {
        self.to
    }

    /// Whether the valve moves at a time.
    #[inline]
    #[must_use]
    pub fn moving(&self, time_s: f64) -> bool {
        time_s >= self.begins_s && time_s < self.ends_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::terms::TransitionShape;

    const LINEAR: ValveTransition = ValveTransition {
        shape: TransitionShape::Linear,
    };

    #[test]
    fn passes_five_and_ninety_five_per_cent() {
        let mut v = ValveMotion::at_rest(false);
        v.switch(true, 1.0, 0.05, 0.02, Some(&LINEAR));
        assert!((v.opening(1.02) - 0.05).abs() < 1e-12 && (v.opening(1.05) - 0.95).abs() < 1e-12);
        assert_eq!((v.opening(1.0), v.opening(1.06)), (0.0, 1.0));
    }

    #[test]
    fn a_step_that_takes_time_is_done_by_95_per_cent_and_does_not_begin_before_its_edge() {
        let mut v = ValveMotion::at_rest(false);
        v.switch(true, 1.0, 0.05, 0.02, None);
        v.take(0.02, 1.0);
        assert!((v.opening(1.05) - 0.95).abs() < 1e-12 && (v.opening(1.041) - 0.5).abs() < 1e-12);
        v.switch(false, 2.0, 0.05, 0.02, None);
        v.take(1.0, 2.0);
        assert!(v.opening(2.0) == 1.0 && (v.opening(2.05) - 0.05).abs() < 1e-12);
    }

    #[test]
    fn an_edge_in_movement_starts_from_the_opening_reached() {
        let mut v = ValveMotion::at_rest(false);
        v.switch(true, 0.0, 0.05, 0.02, Some(&LINEAR));
        let reached = v.opening(0.035);
        v.switch(false, 0.035, 0.05, 0.02, Some(&LINEAR));
        assert_eq!(v.opening(0.036), reached);
        assert_eq!(v.opening(0.2), 0.0);
    }

    #[test]
    fn a_step_waits_for_the_total_response() {
        let mut v = ValveMotion::at_rest(true);
        v.switch(false, 0.0, 0.05, 0.02, None);
        assert_eq!((v.opening(0.049), v.opening(0.05)), (1.0, 0.0));
    }
}
