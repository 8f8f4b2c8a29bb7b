//! Rivals: for each effect of a model, what does best in its place.

use super::selection::{Rival, SelectedEffect};
use super::selector::{Selector, ranked};
use crate::criteria::Criteria;
use crate::effect::Candidate;
use crate::error::DiagnoseError;
use crate::estimation::Fit;

/// The effects of a model with their rivals, and the model in which a rival does better.
pub struct Comparison {
    /// Effects, the one of largest gain first.
    pub effects: Vec<SelectedEffect>,
    /// The best model with a rival in the place of an effect, where one is better.
    pub better: Option<Fit>,
}

impl Selector<'_, '_> {
    /// Takes each effect out of the model in turn and fits the strongest other candidate in its place.
    pub fn compare_with_rivals(&mut self, best: &Fit, with_laws: bool) -> Result<Comparison, DiagnoseError> {
        let costs = self.held_out(best);
        let mut effects = Vec::new();
        let mut better: Option<(f64, Fit)> = None;
        for (position, &candidate) in best.point.effects.iter().enumerate() {
            let less = self.fitted(best.point.without_effect(self.specimen(), position))?;
            let without = self.held_out(&less);
            let gain = self.gain(without, costs);
            let mut rival = None;
            if let Some((other, full)) = self.strongest_rival(&less, candidate, best, gain.total, with_laws)? {
                let found = self.rival(other, &full, best, gain.total);
                let lead = found.lead.total;
                if self.takes_the_place(&found, &full, candidate, best, gain.total)
                    && better.as_ref().is_none_or(|(least, _)| lead < *least)
                {
                    better = Some((lead, full));
                }
                rival = Some(found);
            }
            effects.push(SelectedEffect {
                candidate,
                gain,
                ratio_without: self.noise_ratio(without),
                rival,
            });
        }
        effects.sort_by(|a, b| b.gain.total.total_cmp(&a.gain.total));
        Ok(Comparison {
            effects,
            better: better.map(|(_, fit)| fit),
        })
    }

    /// The strongest candidate in the place of an effect: fitted in full where it may catch up, screened where it cannot.
    fn strongest_rival(
        &mut self,
        less: &Fit,
        candidate: usize,
        best: &Fit,
        gain: f64,
        with_laws: bool,
    ) -> Result<Option<(usize, Fit)>, DiagnoseError> {
        let mut candidates = self.open(&less.point, with_laws);
        candidates.retain(|&c| c != candidate && !includes(self.candidate(c), self.candidate(candidate)));
        let screened = self.screen(less, candidates)?;
        let Some((cost, start)) = ranked(&screened).into_iter().next() else {
            return Ok(None);
        };
        let rival = start.point.effects.last().copied().unwrap_or(candidate);
        let total: f64 = self.held_out(best).iter().sum();
        let full = if cost - total < self.criteria().rivalry.contender * gain {
            self.fitted(start.point)?
        } else {
            start
        };
        Ok(Some((rival, full)))
    }

    /// How far the model found leads over the one with a rival in the place of an effect.
    fn rival(&self, candidate: usize, full: &Fit, best: &Fit, gain: f64) -> Rival {
        let Criteria {
            rivalry, acceptance, ..
        } = self.criteria();
        let lead = self.gain(self.held_out(full), self.held_out(best));
        let told_apart = lead.is_large(0.0, rivalry.ambiguity_margin, acceptance);
        Rival {
            candidate,
            lead,
            ambiguous: !told_apart && lead.total < rivalry.ambiguity_lead * gain,
        }
    }

    /// True if the rival belongs into the model in the place of the effect: it is clearly better, or it is the same effect in
    /// fewer places and does as well (one damper fades, not both).
    fn takes_the_place(&self, rival: &Rival, full: &Fit, candidate: usize, best: &Fit, gain: f64) -> bool {
        let criteria = self.criteria();
        let named = |fit: &Fit| fit.point.effects.iter().all(|&e| !self.candidate(e).is_unlisted());
        // A name gives way to a law without one only if the law is clearly better.
        let least = if named(best) && !named(full) {
            criteria.rivalry.lead_over_named * gain
        } else {
            0.0
        };
        let residuals = self.problem.residuals() as f64;
        let clearly = rival.lead.total < -criteria.acceptance.least_gain_of(residuals).max(least);
        let (effect, other) = (self.candidate(candidate), self.candidate(rival.candidate));
        let simpler = other.id == effect.id
            && other.parameters.len() < effect.parameters.len()
            && !self.accepts(&rival.lead, 0.0);
        clearly || simpler
    }
}

/// True if one candidate holds another in itself, so that it is no rival: a law without a name in the same place, or the same
/// effect there and elsewhere too.
fn includes(wider: &Candidate, effect: &Candidate) -> bool {
    let law = !effect.is_unlisted() && wider.is_unlisted() && wider.place == effect.place;
    let more_places = wider.id == effect.id
        && wider.parameters.len() > effect.parameters.len()
        && wider.place.contains(&effect.place);
    law || more_places
}
