//! The sub-system "Pressure dependent valve switching" (figure 27): a valve acts in a step, late by the parabola that was
//! fitted to the measured response times (figure 25).

/// One valve: its signal, the state that acts, and the changes under way.
#[derive(Debug, Clone, PartialEq)]
pub struct DelayedSwitch {
    signal: bool,
    acting: bool,
    /// Times of the changes to come, in order; each reverses the state before it.
    pending: Vec<f64>,
}

impl DelayedSwitch {
    /// A valve that has been at rest for long.
    #[must_use]
    pub fn at_rest(open: bool) -> Self {
        Self {
            signal: open,
            acting: open,
            pending: Vec::new(),
        }
    }

    /// Takes the signal at `time_s` (not decreasing from call to call) and returns the state that acts then. At an edge
    /// the response time `c0 + c1 dP + c2 dP^2` (s, dP in MPa) is taken at `pressure_difference_pa`.
    ///
    /// An edge that would act before an earlier one has overtaken it: the earlier one never acts.
    pub fn update(&mut self, time_s: f64, signal: bool, pressure_difference_pa: f64, polynomial_s: &[f64]) -> bool {
        self.advance(time_s);
        if signal != self.signal {
            self.signal = signal;
            let mega = 1e-6 * pressure_difference_pa.abs();
            let delay = polynomial_s.iter().rev().fold(0.0, |sum, c| sum * mega + c).max(0.0);
            self.pending.retain(|&due| due < time_s + delay);
            // What remains reverses the state once each; one more change only where that does not end at the signal.
            let end = self.acting ^ (self.pending.len() % 2 == 1);
            if end != signal {
                self.pending.push(time_s + delay);
            }
            self.advance(time_s);
        }
        self.acting
    }

    fn advance(&mut self, time_s: f64) {
        while self.pending.first().is_some_and(|&due| due <= time_s) {
            self.pending.remove(0);
            self.acting = !self.acting;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PARABOLA: [f64; 3] = [0.04, 0.0022, 0.000_06];

    /// Time at which a signal given at 0 s acts.
    fn acts_at(pressure_pa: f64) -> f64 {
        let mut valve = DelayedSwitch::at_rest(false);
        (0..2000)
            .map(|i| 1e-4 * f64::from(i))
            .find(|&t| valve.update(t, true, pressure_pa, &PARABOLA))
            .expect("it acts")
    }

    #[test]
    fn late_by_the_parabola_and_then_at_once() {
        for (pressure_mpa, delay) in [(0.0, 0.04), (5.0, 0.0525), (-5.0, 0.0525), (10.0, 0.068)] {
            assert!(
                (acts_at(1e6 * pressure_mpa) - delay).abs() < 1.5e-4,
                "{pressure_mpa} MPa"
            );
        }
    }

    #[test]
    fn a_short_pulse_passes_late_but_whole() {
        let mut valve = DelayedSwitch::at_rest(false);
        let acting: Vec<bool> = (0..1000)
            .map(|i| valve.update(1e-3 * f64::from(i), (100..110).contains(&i), 0.0, &PARABOLA))
            .collect();
        assert!(acting[145] && !acting[139] && !acting[151]);
        assert_eq!(acting.iter().filter(|&&open| open).count(), 10);
    }

    #[test]
    fn an_edge_that_overtakes_cancels() {
        let mut valve = DelayedSwitch::at_rest(false);
        valve.update(0.0, true, 20e6, &PARABOLA);
        valve.update(0.01, false, 0.0, &PARABOLA);
        assert!((0..300).all(|i| !valve.update(0.01 + 1e-3 * f64::from(i), false, 0.0, &PARABOLA)));
    }

    #[test]
    fn a_polynomial_of_one_coefficient_is_a_constant() {
        let mut valve = DelayedSwitch::at_rest(true);
        valve.update(0.0, false, 9e6, &[0.05]);
        assert!(valve.update(0.049, false, 0.0, &[0.05]) && !valve.update(0.05, false, 0.0, &[0.05]));
    }
}
