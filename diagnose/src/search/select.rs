//! The search from the believed model to the improved one.

use super::done;
use super::growth::{Grown, grow, grown_with_laws_first, reduced};
use super::oscillation::Oscillations;
use super::selection::{CandidateScore, Progress, Selection};
use super::selector::{Open, Screened, Selector};
use crate::error::DiagnoseError;
use crate::estimation::{Fit, LeastSquares, Point};
use crate::specimen::Series;

/// Runs the whole search. The first page of this crate has an example, in which [`crate::Diagnosis::of`] runs it.
///
/// # Errors
/// A believed model that cannot be simulated; [`DiagnoseError::Interrupted`] once the caller asked to stop.
pub fn select(problem: &LeastSquares<'_>, progress: Progress<'_>) -> Result<Selection, DiagnoseError> {
    let mut selector = Selector::new(problem);
    progress("calibrating within tolerance", done::CALIBRATION);
    let calibrated = selector.fitted(Point::nominal(problem.specimen()))?;
    let mut grown = grow(&mut selector, &calibrated, calibrated.clone(), Open::Names, progress)?;
    let mut best = reduced(&mut selector, grown.best.clone(), progress)?;
    if let Some(open) = selector.open_once_more(&best, &grown) {
        let first = grown;
        grown = grow(&mut selector, &calibrated, best, open, progress)?;
        grown.scores = first.scores;
        grown.law_pairs = grown.law_pairs.max(first.law_pairs);
        best = reduced(&mut selector, grown.best.clone(), progress)?;
    }
    if let Some(other) = selector.with_numbers_in_place_of_faults(&calibrated, &best)? {
        best = other;
        grown.open = Open::Laws;
    }
    if let Some(anew) = grown_with_laws_first(&mut selector, &calibrated, &best, &grown, progress)? {
        let first = grown;
        (grown, best) = anew;
        grown.scores = first.scores;
        grown.law_pairs = grown.law_pairs.max(first.law_pairs);
    }
    if let Some(merged) = selector.merged(&best)? {
        best = merged;
    }
    let effects_grown = grown.best.point.effects.len();
    let Grown {
        mut screened,
        mut scores,
        open,
        law_pairs,
        ..
    } = grown;
    let acceptance = &problem.criteria.acceptance;

    progress("testing rivals in the place of each effect", done::RIVALS);
    let mut comparison = selector.compare_with_rivals(&best, open)?;
    let mut exchanged = false;
    for _ in 0..problem.criteria.rivalry.exchanges {
        let Some(better) = comparison.better.take() else { break };
        let after = selector.eliminate(better, acceptance.least_fraction)?;
        // A rival that gains more, but in a few blocks only, is not accepted and leaves with what it took the place of.
        if selector.improves(&after, &best, acceptance.least_fraction_incomplete) {
            break;
        }
        best = after;
        exchanged = true;
        comparison = selector.compare_with_rivals(&best, open)?;
    }
    if exchanged || best.point.effects.len() != effects_grown {
        let open = selector.open(&best.point, open);
        screened = selector.screen(&best, open)?;
    }
    selector.score_added(&screened, &best, &mut scores);
    let improved_ratio = selector.held_out_ratio(&best);
    let incomplete = !selector.is_complete(&best);
    let of_excitation_hz = if incomplete && open != Open::Names {
        let left = problem.evaluation.residuals_at(&best.point)?;
        let left: Vec<&Series> = left.iter().collect();
        Oscillations::of(problem.specimen()).of_excitation(&left)
    } else {
        vec![]
    };
    Ok(Selection {
        calibrated_ratio: selector.held_out_ratio(&calibrated),
        improved_ratio,
        incomplete,
        complete_where_fitted: selector.complete_where_fitted(&best),
        effects: comparison.effects,
        of_excitation_hz,
        law_pairs,
        calibrated,
        best,
        scores,
    })
}

impl Selector<'_, '_> {
    /// Notes what candidates would explain beside the improved model, and from which sizes they would have shown.
    pub fn score_added(&self, screened: &[Screened], best: &Fit, scores: &mut [CandidateScore]) {
        for (candidate, fit) in screened {
            if let (Some(score), Some(fit)) = (scores.iter_mut().find(|s| s.candidate == *candidate), fit) {
                score.added = Some(self.held_out_ratio(fit));
                score.least_sizes = self.least_sizes(best, *candidate, fit);
            }
        }
    }

    /// What may join a model that is not complete, and has lost effects that came before laws were tried: they had a part of what a
    /// law explains, so that it was not accepted beside them, or they were so many that none was tried. `None` if there is no reason to
    /// go on.
    fn open_once_more(&self, reduced: &Fit, grown: &Grown) -> Option<Open> {
        let has_lost = reduced.point.effects.len() < grown.best.point.effects.len();
        let incomplete = !self.is_complete(reduced);
        let worth_it = has_lost && incomplete && self.can_have_two_laws();
        match self.laws_of(&reduced.point) {
            0 if worth_it => Some(Open::Laws),
            1 if worth_it => Some(Open::TwoLaws),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{
        CUBIC, FIRST_OF_PAIR, FORTY_SINES, FREQUENCY, FRICTION, FRICTION_OF_BOTH, GAIN, NEARLY_CUBIC, RUN, Recipe,
        SECOND_OF_PAIR, TABLE, VIBRATION,
    };
    use crate::criteria::Criteria;
    use crate::effect::Joins;
    use crate::estimation::covariance::deviations;
    use crate::search::LawPairs;
    use crate::vocabulary::Site;
    use std::sync::atomic::AtomicBool;

    fn selected(recipe: &Recipe) -> Selection {
        select(&LeastSquares::new(&recipe.make(), &RUN), &|_, _| {}).expect("a selection")
    }

    fn found(selection: &Selection) -> Vec<usize> {
        let mut effects = selection.best.point.effects.clone();
        effects.sort_unstable();
        effects
    }

    #[test]
    fn a_wrong_number_is_asked_before_laws_and_is_the_answer_only_if_nothing_is_left() {
        let with = |truth: Vec<(usize, Vec<f64>)>| {
            let mut specimen = Recipe {
                truth,
                candidates: vec![CUBIC, FRICTION, VIBRATION],
                ..Recipe::default()
            }
            .make();
            specimen.become_number(FRICTION);
            specimen.take_name(CUBIC, Site::Mount);
            found(&select(&LeastSquares::new(&specimen, &RUN), &|_, _| {}).expect("a selection"))
        };
        let (law, number, name) = ((CUBIC, vec![0.4]), (FRICTION, vec![0.1]), (VIBRATION, vec![0.1, 1.03]));
        assert_eq!(with(vec![number.clone()]), [FRICTION]);
        assert_eq!(with(vec![number.clone(), name]), [FRICTION, VIBRATION]);
        // The number explains a part of what the law does.
        assert_eq!(with(vec![law.clone()]), [CUBIC]);
        assert_eq!(with(vec![law, number]), [CUBIC, FRICTION]);
        assert_eq!(with(vec![]), [] as [usize; 0]);
    }

    #[test]
    fn nothing_is_found_where_nothing_is_missing() {
        for seed in 0..12 {
            let s = selected(&Recipe {
                seed,
                ..Recipe::default()
            });
            assert!(s.effects.is_empty() && !s.incomplete, "seed {seed}: {:?}", s.effects);
            assert!((s.improved_ratio - 1.0).abs() < 0.04, "{}", s.improved_ratio);
        }
    }

    #[test]
    fn the_missing_law_is_found_and_sized() {
        for seed in 0..6 {
            let s = selected(&Recipe {
                seed,
                truth: vec![(FRICTION, vec![0.1])],
                ..Recipe::default()
            });
            assert_eq!(found(&s), [FRICTION], "seed {seed}");
            assert!(!s.incomplete && s.effects[0].ambiguous_rival().is_none());
            assert!(s.calibrated_ratio > 2.0 && s.improved_ratio < 1.05);
            let (z, sd) = (s.best.point.z[2], deviations(&s.best)[2]);
            // One coordinate is 0.05.
            assert!((0.05 * z - 0.1).abs() < 4.0 * 0.05 * sd + 1e-3, "{z} +- {sd}");
        }
    }

    #[test]
    fn two_missing_laws_are_found_together() {
        let s = selected(&Recipe {
            truth: vec![(FRICTION, vec![0.08]), (CUBIC, vec![0.2])],
            candidates: vec![CUBIC, FRICTION, VIBRATION, FORTY_SINES, GAIN],
            ..Recipe::default()
        });
        assert_eq!(found(&s), [CUBIC, FRICTION]);
        assert!(s.effects[0].gain.total >= s.effects[1].gain.total);
    }

    #[test]
    fn laws_of_nearly_one_shape_are_called_ambiguous() {
        let s = selected(&Recipe {
            truth: vec![(CUBIC, vec![0.2])],
            ..Recipe::default()
        });
        let effect = &s.effects[0];
        assert_eq!(s.effects.len(), 1);
        let pair = [effect.candidate, effect.ambiguous_rival().expect("a rival")];
        assert!(pair.contains(&CUBIC) && pair.contains(&NEARLY_CUBIC), "{pair:?}");
    }

    #[test]
    fn held_out_blocks_reject_what_fits_only_the_noise() {
        for seed in 0..6 {
            let specimen = Recipe {
                seed,
                candidates: vec![FORTY_SINES],
                ..Recipe::default()
            }
            .make();
            let problem = LeastSquares::new(&specimen, &RUN);
            let s = select(&problem, &|_, _| {}).expect("a selection");
            assert!(s.effects.is_empty(), "seed {seed}");
            // In the fit itself forty numbers gain what would have been accepted.
            let start = Point::nominal(&specimen).with_effect(&specimen, FORTY_SINES, &[0.0; 40]);
            let full = crate::estimation::fit(&problem, start, problem.criteria.fitting.converged).expect("a fit");
            let gained = s.calibrated.cost - full.cost;
            let least = problem.criteria.acceptance.least_gain;
            assert!(gained > 0.6 * least, "seed {seed}: {gained}");
            // On held-out blocks they lose about as much.
            assert!(s.scores[0].alone > s.calibrated_ratio, "seed {seed}: {:?}", s.scores);
        }
    }

    #[test]
    fn a_local_minimum_is_left_through_the_starts() {
        let recipe = Recipe {
            truth: vec![(VIBRATION, vec![0.1, FREQUENCY])],
            ..Recipe::default()
        };
        let search = |starts: Vec<Vec<f64>>| {
            let mut specimen = recipe.make();
            specimen.give_starts(VIBRATION, starts);
            select(&LeastSquares::new(&specimen, &RUN), &|_, _| {}).expect("a selection")
        };
        let without = search(vec![]);
        assert!(!found(&without).contains(&VIBRATION) && without.incomplete);
        let with = search((0..30).map(|k| vec![0.0, 0.5 + 0.115 * f64::from(k)]).collect());
        assert_eq!(found(&with), [VIBRATION]);
        let frequency = 1.0 + 0.05 * with.best.point.z[3];
        assert!((frequency - FREQUENCY).abs() < 0.005, "{frequency}");
        assert!(!with.incomplete);
    }

    #[test]
    fn a_law_without_a_name_is_tried_only_when_no_name_explains_what_is_left() {
        let recipe = |candidates: Vec<usize>| Recipe {
            truth: vec![(CUBIC, vec![0.3])],
            candidates,
            ..Recipe::default()
        };
        let named = selected(&recipe(vec![CUBIC, FRICTION, TABLE]));
        assert_eq!(found(&named), [CUBIC]);
        assert!(named.scores.iter().all(|s| s.candidate != TABLE), "never screened");
        let nameless = selected(&recipe(vec![FRICTION, TABLE]));
        assert_eq!(found(&nameless), [TABLE]);
        assert!(nameless.improved_ratio < 0.7 * nameless.calibrated_ratio);
    }

    #[test]
    fn what_is_not_screened_is_tried_when_nothing_else_joins() {
        let found_if = |joins| {
            let mut specimen = Recipe {
                truth: vec![(CUBIC, vec![0.4])],
                candidates: vec![CUBIC, FRICTION],
                ..Recipe::default()
            }
            .make();
            specimen.take_name(CUBIC, Site::Mount);
            specimen.become_joining(CUBIC, joins);
            let s = select(&LeastSquares::new(&specimen, &RUN), &|_, _| {}).expect("a selection");
            (found(&s), s.incomplete)
        };
        assert_eq!(found_if(Joins::AtLast), (vec![CUBIC], false));
        let (effects, incomplete) = found_if(Joins::InPlace);
        assert!(!effects.contains(&CUBIC) && incomplete, "{effects:?}");
    }

    /// What the search finds where these are laws without a name, at places of their own.
    fn found_of_laws(laws: &[(usize, Site)], truth: &[(usize, f64)], one_place: bool) -> (Vec<usize>, LawPairs) {
        let mut specimen = Recipe {
            truth: truth.iter().map(|&(law, size)| (law, vec![size])).collect(),
            candidates: [&[FRICTION][..], &laws.iter().map(|law| law.0).collect::<Vec<_>>()].concat(),
            ..Recipe::default()
        }
        .make();
        for (law, site) in laws {
            specimen.take_name(*law, if one_place { Site::Chamber } else { site.clone() });
        }
        let s = select(&LeastSquares::new(&specimen, &RUN), &|_, _| {}).expect("a selection");
        (found(&s), s.law_pairs)
    }

    #[test]
    fn a_second_law_is_found_beside_the_first_if_it_acts_elsewhere() {
        let laws = [(CUBIC, Site::Mount), (FIRST_OF_PAIR, Site::EndStop)];
        let truth = [(CUBIC, 0.4), (FIRST_OF_PAIR, 0.2)];
        assert_eq!(
            found_of_laws(&laws, &truth, false),
            (vec![CUBIC, FIRST_OF_PAIR], LawPairs::NotTried)
        );
        assert_eq!(found_of_laws(&laws, &truth, true).0.len(), 1);
        // One law that suffices gets no company.
        assert_eq!(found_of_laws(&laws, &truth[..1], false).0, [CUBIC]);
    }

    #[test]
    fn laws_of_which_none_helps_alone_are_found_as_a_pair() {
        let laws = [
            (CUBIC, Site::Mount),
            (FIRST_OF_PAIR, Site::EndStop),
            (SECOND_OF_PAIR, Site::MainChamber),
        ];
        let truth = [(FIRST_OF_PAIR, 1.5), (SECOND_OF_PAIR, 1.5)];
        assert_eq!(
            found_of_laws(&laws, &truth, false),
            (vec![FIRST_OF_PAIR, SECOND_OF_PAIR], LawPairs::Found)
        );
        assert_eq!(found_of_laws(&laws, &truth, true), (vec![], LawPairs::NoneAccepted));
    }

    #[test]
    fn an_effect_in_fewer_places_is_reported_where_it_does_as_well() {
        let s = selected(&Recipe {
            truth: vec![(FRICTION, vec![0.1])],
            candidates: vec![FRICTION, FRICTION_OF_BOTH],
            ..Recipe::default()
        });
        assert_eq!(found(&s), [FRICTION]);
        let s = selected(&Recipe {
            truth: vec![(FRICTION_OF_BOTH, vec![0.15, 0.04])],
            candidates: vec![FRICTION, FRICTION_OF_BOTH],
            ..Recipe::default()
        });
        assert_eq!(found(&s), [FRICTION_OF_BOTH]);
    }

    #[test]
    fn a_misfit_that_no_candidate_explains_leaves_the_model_incomplete() {
        let s = selected(&Recipe {
            truth: vec![(CUBIC, vec![0.3])],
            candidates: vec![FRICTION, VIBRATION],
            ..Recipe::default()
        });
        assert!(s.effects.is_empty() && s.incomplete);
    }

    #[test]
    fn thresholds_are_those_of_the_criteria() {
        let specimen = Recipe {
            truth: vec![(FRICTION, vec![0.1])],
            ..Recipe::default()
        }
        .make();
        let mut criteria = Criteria::default();
        criteria.acceptance.least_gain = 1e9;
        let problem = LeastSquares::new(&specimen, &RUN).with_criteria(criteria);
        let s = select(&problem, &|_, _| {}).expect("a selection");
        assert!(s.effects.is_empty() && s.incomplete);
    }

    #[test]
    fn the_same_bits_on_any_number_of_threads() {
        let recipe = Recipe {
            truth: vec![(FRICTION, vec![0.1]), (VIBRATION, vec![0.1, 1.03])],
            ..Recipe::default()
        };
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a pool");
            let s = pool.install(|| selected(&recipe));
            (
                found(&s),
                s.best.point.z.iter().map(|z| z.to_bits()).collect::<Vec<_>>(),
                s.improved_ratio.to_bits(),
            )
        };
        assert_eq!(run(1), run(3));
    }

    #[test]
    fn it_ends_when_asked_to_stop() {
        let (specimen, stop) = (Recipe::default().make(), AtomicBool::new(true));
        let stopped = select(&LeastSquares::new(&specimen, &stop), &|_, _| {});
        assert!(matches!(stopped, Err(DiagnoseError::Interrupted)));
    }
}
