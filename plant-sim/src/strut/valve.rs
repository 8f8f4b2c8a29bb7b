//! Solenoid valves: when they begin to move after an edge of the switching signal, and how far they are open.
//!
//! Total response `c0 + c1 dP + c2 dP^2` over the pressure difference at the edge (seed report, figure 25); 5 % of the
//! change after `initial_delay_fraction` of it, 95 % after all of it (report, 3.5.3). The movement is the straight line
//! through those two points, or a step at the total response.

/// Movement of one valve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ValveMotion {
    signal: bool,
    from: f64,
    to: f64,
    /// Times on the strut's clock between which the opening changes, s.
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

    /// An edge at `now_s`: the movement starts anew from the opening reached.
    ///
    /// `total_s` is the response time to 95 %, `initial_s` to 5 %; `gradual` as the model has it.
    pub fn switch(&mut self, open: bool, now_s: f64, total_s: f64, initial_s: f64, gradual: bool) {
        self.from = self.opening(now_s);
        self.to = f64::from(u8::from(open));
        self.signal = open;
        if gradual {
            let overhang = (total_s - initial_s) * (0.05 / 0.9);
            self.begins_s = now_s + initial_s - overhang;
            self.ends_s = now_s + total_s + overhang;
        } else {
            self.begins_s = now_s + total_s;
            self.ends_s = self.begins_s;
        }
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

    #[test]
    fn passes_five_and_ninety_five_per_cent() {
        let mut v = ValveMotion::at_rest(false);
        v.switch(true, 1.0, 0.05, 0.02, true);
        assert!((v.opening(1.02) - 0.05).abs() < 1e-12 && (v.opening(1.05) - 0.95).abs() < 1e-12);
        assert_eq!((v.opening(1.0), v.opening(1.06)), (0.0, 1.0));
    }

    #[test]
    fn an_edge_in_movement_starts_from_the_opening_reached() {
        let mut v = ValveMotion::at_rest(false);
        v.switch(true, 0.0, 0.05, 0.02, true);
        let reached = v.opening(0.035);
        v.switch(false, 0.035, 0.05, 0.02, true);
        assert_eq!(v.opening(0.036), reached);
        assert_eq!(v.opening(0.2), 0.0);
    }

    #[test]
    fn a_step_waits_for_the_total_response() {
        let mut v = ValveMotion::at_rest(true);
        v.switch(false, 0.0, 0.05, 0.02, false);
        assert_eq!((v.opening(0.049), v.opening(0.05)), (1.0, 0.0));
    }
}
