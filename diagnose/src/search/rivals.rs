//! Rivals: for each effect of a model, what does best in its place.

use super::selection::{Fitted, Rival, SelectedEffect};
use super::selector::{Open, Selector, ranked};
use super::simplification::is_form_of;
use crate::criteria::Criteria;
use crate::effect::{Candidate, Joins};
use crate::error::DiagnoseError;
use crate::estimation::{Fit, Point};

/// The effects of a model with their rivals, and the model in which a rival does better.
pub struct Comparison {
    /// Effects, the one of largest gain first.
    pub effects: Vec<SelectedEffect>,
    /// The best model with a rival in the place of an effect, where one is better.
    pub better: Option<Fit>,
}

/// What may stand in the place of an effect.
enum Kind {
    /// Another effect, or a law without a name.
    Other,
    /// A wrong number of the model. The tolerances speak against it, so that one that only does as well is said and makes the effect no less sure.
    Number,
    /// Another form of the effect, which speaks no less for it.
    Form,
    /// A name in the place of what has none. It takes the place where it does as well.
    Name,
}

impl Selector<'_, '_> {
    /// Takes each effect out of the model in turn and fits the strongest other candidate in its place.
    pub fn compare_with_rivals(&mut self, best: &Fit, open: Open) -> Result<Comparison, DiagnoseError> {
        let costs = self.held_out(best);
        let mut effects = Vec::new();
        let mut better: Option<(f64, Fit)> = None;
        // The effect that joined last first: what was screened before it joined is still remembered.
        for (position, &candidate) in best.point.effects.iter().enumerate().rev() {
            let less = self.fitted(best.point.without_effect(self.specimen(), position))?;
            let without = self.held_out(&less);
            let gain = self.gain(without, costs);
            let (mut rival, mut as_good) = (None, None);
            let open = self.open(&less.point, open);
            let numbers = self.numbers_beside(&less.point, &open);
            let effect = self.candidate(candidate);
            let (forms, rivals): (Vec<usize>, Vec<usize>) =
                (open.into_iter()).partition(|&c| is_equal_form(self.candidate(c), effect));
            let names = (rivals.iter().copied())
                .filter(|&c| is_name_of(self.candidate(c), effect))
                .collect();
            for (kind, candidates) in [
                (Kind::Other, rivals),
                (Kind::Number, numbers),
                (Kind::Form, forms),
                (Kind::Name, names),
            ] {
                let Some((other, full)) = self.strongest_rival(&less, candidate, best, gain.total, candidates)? else {
                    continue;
                };
                let found = self.rival(other, &full, best, gain.total);
                match kind {
                    Kind::Other => rival = Some(found),
                    Kind::Number if found.ambiguous => as_good = full.point.hypothesis(self.specimen()).effects.pop(),
                    Kind::Number | Kind::Form | Kind::Name => {}
                }
                let lead = found.lead.total;
                if self.takes_the_place(&found, &full, candidate, best, gain.total)
                    && better.as_ref().is_none_or(|(least, _)| lead < *least)
                {
                    better = Some((lead, full));
                }
            }
            effects.push(SelectedEffect {
                candidate,
                gain,
                ratio_without: self.noise_ratio(without),
                without: less.point,
                rival,
                as_good: as_good.map(|(candidate, values)| Fitted { candidate, values }),
            });
        }
        effects.sort_by(|a, b| b.gain.total.total_cmp(&a.gain.total));
        Ok(Comparison {
            effects,
            better: better.map(|(_, fit)| fit),
        })
    }

    /// Wrong numbers that might be in a model and are not among these rivals.
    fn numbers_beside(&self, point: &Point, rivals: &[usize]) -> Vec<usize> {
        let all = self.open(point, Open::Numbers).into_iter();
        all.filter(|c| self.candidate(*c).is_believed_number && !rivals.contains(c))
            .collect()
    }

    /// The strongest candidate in the place of an effect: fitted in full where it may catch up, screened where it cannot.
    fn strongest_rival(
        &mut self,
        less: &Fit,
        candidate: usize,
        best: &Fit,
        gain: f64,
        mut candidates: Vec<usize>,
    ) -> Result<Option<(usize, Fit)>, DiagnoseError> {
        candidates.retain(|&c| c != candidate && !includes(self.candidate(c), self.candidate(candidate)));
        if candidates.is_empty() {
            return Ok(None);
        }
        let screened = self.screen(less, candidates)?;
        let Some((cost, start)) = ranked(&screened).into_iter().next() else {
            return Ok(None);
        };
        let rival = start.point.effects.last().copied().unwrap_or(candidate);
        let total: f64 = self.held_out(best).iter().sum();
        if cost - total >= self.criteria().rivalry.contender * gain {
            return Ok(Some((rival, start.clone())));
        }
        let full = self.fitted_if_simulated(start.point.clone())?;
        let full = full.unwrap_or_else(|| start.clone());
        // A law that was shaped to the recordings is compared with one elsewhere that is, too.
        let (effect, other) = (self.candidate(candidate), self.candidate(rival));
        let shaped = effect.joins != Joins::Screened && other.is_law() && other.place != effect.place;
        let last = full.point.effects.len() - 1;
        let full = match shaped.then(|| self.reshaped_at(&full, last)).transpose()?.flatten() {
            Some(other) => other,
            None => full,
        };
        Ok(Some((full.point.effects.last().copied().unwrap_or(rival), full)))
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

    /// True if the rival belongs into the model in the place of the effect: it is clearly better, or it does as well and is the same effect in
    /// fewer places (one damper fades, not both) or a name in the place of what has none.
    fn takes_the_place(&self, rival: &Rival, full: &Fit, candidate: usize, best: &Fit, gain: f64) -> bool {
        let criteria = self.criteria();
        let named = |fit: &Fit| fit.point.effects.iter().all(|&e| !self.candidate(e).is_unlisted());
        // A name gives way to a law without one only if the law is clearly better, and to a wrong number only if that is certainly better.
        let is_number = self.candidate(rival.candidate).is_believed_number;
        let least = if named(best) && !named(full) && !is_number {
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
        let certainly = !is_number || self.improves(best, full, 0.0);
        let named_as_well = is_name_of(other, effect) && !self.improves(full, best, 0.0);
        ((clearly && certainly) || simpler || named_as_well) && !self.predicts_recordings_worse(best, full)
    }
}

/// True if one candidate holds another in itself, so that it is no rival: a law without a name in the same place, or the same
/// effect there and elsewhere too.
fn includes(wider: &Candidate, effect: &Candidate) -> bool {
    let law = !effect.is_unlisted() && wider.is_law() && wider.place == effect.place;
    let more_places = wider.id == effect.id
        && wider.parameters.len() > effect.parameters.len()
        && wider.place.contains(&effect.place);
    let more_numbers = is_form_of(effect, wider) && wider.parameters.len() > effect.parameters.len();
    law || more_places || more_numbers
}

/// True if a candidate has a name and may be what the effect, which has none, is: physics of a wrong number, and of a law what is at its place with no
/// more numbers.
fn is_name_of(other: &Candidate, effect: &Candidate) -> bool {
    let of_number = effect.is_believed_number && !other.is_instrument_fault();
    let of_law = effect.is_law() && other.place == effect.place && other.parameters.len() <= effect.parameters.len();
    !other.is_unlisted() && (of_number || of_law)
}

/// True if a candidate is another form of the same effect with as many numbers.
fn is_equal_form(other: &Candidate, effect: &Candidate) -> bool {
    is_form_of(other, effect) && other.id == effect.id && other.parameters.len() == effect.parameters.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{Analytic, CUBIC, FRICTION, FRICTION_OF_BOTH, NEARLY_CUBIC, RUN, Recipe, TABLE, VIBRATION};
    use crate::estimation::{LeastSquares, Point};
    use crate::specimen::Specimen;
    use crate::vocabulary::Site;

    fn specimen(truth: &[(usize, &[f64])], candidates: &[usize]) -> Analytic {
        Recipe {
            truth: truth.iter().map(|&(law, values)| (law, values.to_vec())).collect(),
            candidates: candidates.to_vec(),
            ..Recipe::default()
        }
        .make()
    }

    /// The comparison for a model with these effects, fitted from these values.
    fn compared(specimen: &Analytic, criteria: Criteria, model: &[(usize, &[f64])]) -> Comparison {
        compared_from(specimen, criteria, model, Open::Laws)
    }

    /// The same where this may join.
    fn compared_from(specimen: &Analytic, criteria: Criteria, model: &[(usize, &[f64])], open: Open) -> Comparison {
        let problem = LeastSquares::new(specimen, &RUN).with_criteria(criteria);
        let mut selector = Selector::new(&problem);
        let start = (model.iter()).fold(Point::nominal(specimen), |p, (e, v)| p.with_effect(specimen, *e, v));
        let best = selector.fitted(start).expect("a fit");
        selector.compare_with_rivals(&best, open).expect("a comparison")
    }

    fn usual(specimen: &Analytic, model: &[(usize, &[f64])]) -> Comparison {
        compared(specimen, Criteria::default(), model)
    }

    fn better(comparison: Comparison) -> Option<Vec<usize>> {
        comparison.better.map(|fit| fit.point.effects)
    }

    #[test]
    fn a_wrong_number_takes_the_place_of_a_name_only_if_it_is_certainly_better_and_is_else_said_beside_it() {
        let compared = |name: usize, truth: usize, size: f64| {
            let mut specimen = specimen(&[(truth, &[size])], &[name, CUBIC]);
            specimen.become_number(CUBIC);
            let problem = LeastSquares::new(&specimen, &RUN);
            let mut selector = Selector::new(&problem);
            let start = Point::nominal(&specimen).with_effect(&specimen, name, &[0.1]);
            let best = selector.fitted(start).expect("a fit");
            let comparison = selector.compare_with_rivals(&best, Open::Names).expect("a comparison");
            assert!(comparison.effects[0].rival.is_none());
            let as_good = comparison.effects[0].as_good.clone();
            (comparison.better.map(|fit| fit.point.effects), as_good)
        };
        assert_eq!(compared(FRICTION, CUBIC, 0.4).0, Some(vec![CUBIC]));
        assert_eq!(compared(NEARLY_CUBIC, NEARLY_CUBIC, 9.0), (None, None));
        for truth in [NEARLY_CUBIC, CUBIC] {
            let (better, as_good) = compared(NEARLY_CUBIC, truth, 0.4);
            let number = as_good.expect("a number that does as well");
            assert!(better.is_none() && number.candidate == CUBIC);
            assert!((number.values[0] - 0.4).abs() < 0.02, "{number:?}");
        }
    }

    #[test]
    fn a_name_takes_the_place_of_a_wrong_number_if_it_does_as_well() {
        let becomes = |name: usize, truth: usize| {
            let mut specimen = specimen(&[(truth, &[0.4])], &[name, CUBIC]);
            specimen.become_number(CUBIC);
            better(compared_from(
                &specimen,
                Criteria::default(),
                &[(CUBIC, &[0.3])],
                Open::Numbers,
            ))
        };
        assert_eq!(becomes(NEARLY_CUBIC, CUBIC), Some(vec![NEARLY_CUBIC]));
        assert_eq!(becomes(FRICTION, CUBIC), None);
    }

    #[test]
    fn a_name_takes_the_place_of_a_law_at_its_place_if_it_does_as_well() {
        let becomes = |site: Site, truth: usize| {
            let mut specimen = specimen(&[(truth, &[0.4])], &[NEARLY_CUBIC, FRICTION, CUBIC]);
            specimen.take_name(CUBIC, site);
            better(usual(&specimen, &[(CUBIC, &[0.3])]))
        };
        assert_eq!(becomes(Site::Chamber, CUBIC), Some(vec![NEARLY_CUBIC]));
        assert_eq!(becomes(Site::Mount, CUBIC), None);
        // Friction explains next to nothing of it.
        assert_eq!(becomes(Site::MainSeal, CUBIC), None);
    }

    /// A vibration `a sin(w t)` is orthogonal to all else in the model, so that leaving it out costs the sum of its squares
    /// over the noise: `n a^2 / (2 s^2)`.
    #[test]
    fn the_gain_of_an_effect_is_the_sum_of_its_squares_over_the_noise() {
        let truth: [(usize, &[f64]); 2] = [(VIBRATION, &[0.1, 2.3]), (CUBIC, &[0.05])];
        let specimen = specimen(&truth, &[VIBRATION, CUBIC, FRICTION]);
        let comparison = usual(&specimen, &[truth[1], truth[0]]);
        let effects = &comparison.effects;
        assert_eq!(
            effects.iter().map(|e| e.candidate).collect::<Vec<_>>(),
            [VIBRATION, CUBIC]
        );
        assert!(
            effects[0].gain.total > effects[1].gain.total,
            "the largest gain comes first"
        );
        let samples = specimen.samples() as f64;
        let expected = samples * 0.1 * 0.1 / (2.0 * specimen.channels()[1].noise * specimen.channels()[1].noise);
        let gained = effects[0].gain.total;
        assert!((gained / expected - 1.0).abs() < 0.05, "{gained} {expected}");
        // Beside a cost of one for each of two residuals a sample.
        let ratio = ((2.0 * samples + expected) / (2.0 * samples)).sqrt();
        assert!(
            (effects[0].ratio_without / ratio - 1.0).abs() < 0.03,
            "{}",
            effects[0].ratio_without
        );
        // Friction explains next to nothing in its place, and so is no ambiguity.
        let rival = effects[0].rival.expect("a rival");
        assert!(rival.candidate == FRICTION && !rival.ambiguous && rival.lead.total > 0.9 * gained);
        assert!(comparison.better.is_none());
    }

    /// The cubic law and `x |x|^2.02` differ by two per cent of their logarithm's slope: beside 0.05 N of noise that is
    /// nothing where the law makes 0.2 N at 1 m, and much where it makes 4.5 N.
    #[test]
    fn what_cannot_be_told_apart_is_ambiguous_and_what_can_is_not() {
        let rival = |size: f64| {
            let specimen = specimen(&[(CUBIC, &[size])], &[CUBIC, NEARLY_CUBIC, FRICTION]);
            let comparison = usual(&specimen, &[(CUBIC, &[size])]);
            assert_eq!(comparison.effects.len(), 1);
            let rival = comparison.effects[0].rival.expect("a rival");
            assert_eq!(rival.candidate, NEARLY_CUBIC);
            rival
        };
        let (weak, strong) = (rival(0.2), rival(4.5));
        assert!(weak.ambiguous && !strong.ambiguous, "{weak:?} {strong:?}");
        assert!(
            strong.lead.total > 20.0 && weak.lead.total.abs() < 10.0,
            "{weak:?} {strong:?}"
        );
    }

    #[test]
    fn a_rival_that_is_clearly_better_takes_the_place() {
        let specimen = specimen(&[(CUBIC, &[0.3])], &[CUBIC, VIBRATION, FRICTION]);
        assert_eq!(better(usual(&specimen, &[(FRICTION, &[0.1])])), Some(vec![CUBIC]));
        assert_eq!(better(usual(&specimen, &[(CUBIC, &[0.3])])), None);
    }

    #[test]
    fn a_name_gives_way_to_a_law_without_one_only_if_that_leads_clearly() {
        // A force that the cubic law follows in part: it rises, and falls again at the ends.
        let rise_and_fall: &[f64] = &[0.1, -0.3, -0.2, -0.1, 0.1, 0.2, 0.3, -0.1];
        let specimen = specimen(&[(TABLE, rise_and_fall)], &[CUBIC, TABLE]);
        let with = |lead_over_named: f64| {
            let mut criteria = Criteria::default();
            criteria.rivalry.lead_over_named = lead_over_named;
            better(compared(&specimen, criteria, &[(CUBIC, &[0.0])]))
        };
        assert_eq!(with(Criteria::default().rivalry.lead_over_named), Some(vec![TABLE]));
        assert_eq!(with(1e6), None);
        // A law that only imitates what has a name does not take its place.
        let specimen = self::specimen(&[(CUBIC, &[0.3])], &[CUBIC, TABLE]);
        assert_eq!(better(usual(&specimen, &[(CUBIC, &[0.3])])), None);
    }

    #[test]
    fn the_same_effect_in_fewer_places_takes_the_place_where_it_does_as_well() {
        let one_number = specimen(&[(FRICTION, &[0.1])], &[FRICTION, FRICTION_OF_BOTH]);
        let of_both: [(usize, &[f64]); 1] = [(FRICTION_OF_BOTH, &[0.1, 0.1])];
        assert_eq!(better(usual(&one_number, &of_both)), Some(vec![FRICTION]));
        let two_numbers = specimen(&[(FRICTION_OF_BOTH, &[0.15, 0.04])], &[FRICTION, FRICTION_OF_BOTH]);
        assert_eq!(better(usual(&two_numbers, &of_both)), None);
    }

    #[test]
    fn what_holds_the_effect_in_itself_is_no_rival() {
        // The wider friction would do as well with any truth, so no effect could ever be told from it.
        let specimen = specimen(&[(FRICTION, &[0.1])], &[FRICTION, FRICTION_OF_BOTH]);
        let comparison = usual(&specimen, &[(FRICTION, &[0.1])]);
        assert!(comparison.effects[0].rival.is_none() && comparison.better.is_none());

        let all = specimen.candidates();
        let mut law = all[TABLE].clone();
        assert!(!includes(&law, &all[CUBIC]), "another place");
        law.place = all[CUBIC].place.clone();
        assert!(
            includes(&law, &all[CUBIC]),
            "a law in the same place can take every shape"
        );
        assert!(!includes(&all[CUBIC], &law), "a name is no wider than a law");
        law.is_believed_number = true;
        assert!(!includes(&law, &all[CUBIC]), "a number is as rigid as a name");
        let mut form = all[FRICTION].clone();
        form.label = "another form".to_owned();
        assert!(is_equal_form(&form, &all[FRICTION]));
        assert!(!is_equal_form(&all[FRICTION_OF_BOTH], &all[FRICTION]), "more numbers");
        assert!(!is_equal_form(&all[CUBIC], &all[FRICTION]), "another effect");
        assert!(includes(&all[FRICTION_OF_BOTH], &all[FRICTION]) && !includes(&all[FRICTION], &all[FRICTION_OF_BOTH]));
    }

    #[test]
    fn a_law_that_was_shaped_is_compared_with_a_rival_that_is() {
        let rival = |joins| {
            let mut specimen = specimen(&[(CUBIC, &[0.4])], &[CUBIC, NEARLY_CUBIC, FRICTION]);
            specimen.take_name(CUBIC, Site::MainSeal);
            specimen.become_joining(CUBIC, joins);
            for law in [NEARLY_CUBIC, FRICTION] {
                specimen.take_name(law, Site::Mount);
            }
            specimen.become_joining(NEARLY_CUBIC, Joins::InPlace);
            let mut criteria = Criteria::default();
            // What is screened is so far behind that it would not be fitted.
            criteria.rivalry.contender = 10.0;
            let compared = compared(&specimen, criteria, &[(CUBIC, &[0.3])]);
            let rival = compared.effects[0].rival.as_ref().expect("a rival");
            (rival.candidate, rival.ambiguous)
        };
        assert_eq!(rival(Joins::InPlace), (NEARLY_CUBIC, true));
        assert_eq!(rival(Joins::Screened), (FRICTION, false));
    }
}
