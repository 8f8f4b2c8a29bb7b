//! Forward selection: the best of the screened candidates joins the model, if held-out blocks confirm it.

use super::selector::{Screened, Selector, ranked, reached};
use crate::error::DiagnoseError;
use crate::estimation::Fit;

impl Selector<'_, '_> {
    /// The model with the strongest screened candidate added and everything fitted again; `None` if none is accepted.
    pub fn strongest(&mut self, screened: &[Screened], best: &Fit) -> Result<Option<Fit>, DiagnoseError> {
        let criteria = self.criteria();
        let before = self.held_out(best);
        let total: f64 = before.iter().sum();
        let mut winner: Option<(f64, Fit)> = None;
        for (screened_cost, start) in ranked(screened).into_iter().take(criteria.screening.finalists) {
            let Some(&candidate) = start.point.effects.last() else {
                continue;
            };
            let fraction = self.least_fraction(candidate, criteria.acceptance.least_fraction);
            // A screened fit is linear in the model's own parameters, so that single blocks may look worse than they are: its
            // gain must be large, not certain.
            let gain = self.gain(before, &reached(&start));
            if !gain.is_large(fraction, criteria.screening.margin, &criteria.acceptance) {
                continue;
            }
            let behind = |cost: f64| total - screened_cost < criteria.screening.gain_of_next_finalist * (total - cost);
            if winner.as_ref().is_some_and(|(cost, _)| behind(*cost)) {
                continue;
            }
            let full = self.fitted(start.point)?;
            if self.is_too_small(&full, candidate) {
                continue;
            }
            let after = self.held_out(&full);
            let cost: f64 = after.iter().sum();
            let accepted = self.accepts(&self.gain(before, after), fraction);
            if accepted && winner.as_ref().is_none_or(|(best, _)| cost < *best) {
                winner = Some((cost, full));
            }
        }
        Ok(winner.map(|(_, fit)| fit))
    }

    /// True if an effect of a fit is a fault of an instrument too small to report.
    fn is_too_small(&self, fit: &Fit, effect: usize) -> bool {
        let Some(position) = fit.point.effects.iter().position(|&e| e == effect) else {
            return false;
        };
        let least = self.criteria().acceptance.least_fault;
        let own = &fit.point.z[fit.point.coordinates_of(self.specimen(), position)];
        self.candidate(effect).is_instrument_fault() && !own.is_empty() && own.iter().all(|z| z.abs() < least)
    }
}
