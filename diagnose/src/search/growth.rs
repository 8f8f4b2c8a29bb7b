//! The growth of a model: effects are added until none is accepted, names before wrong numbers before laws without a name.

use super::combinations::Screening;
use super::done;
use super::selection::{CandidateScore, LawPairs, Progress};
use super::selector::{Open, Screened, Selector};
use crate::error::DiagnoseError;
use crate::estimation::{Fit, Point};

/// So many faults of instruments are doubted where one law may do as well.
const DOUBTFUL_FAULTS: usize = 3;

/// So many effects with a name of any kind are, too.
const DOUBTFUL_NAMES: usize = 4;

/// A model to which nothing more can be added.
pub struct Grown {
    /// The model.
    pub best: Fit,
    /// Candidates screened beside it.
    pub screened: Vec<Screened>,
    /// Candidates screened beside the calibrated model.
    pub scores: Vec<CandidateScore>,
    /// What might join it in the place of one of its effects.
    pub open: Open,
    /// Whether laws were tried in pairs.
    pub law_pairs: LawPairs,
}

/// A model that grows anew with laws open from the beginning, and without what its other effects explain; `None` unless it is better than the model found, or
/// as good with fewer effects. Names that came before laws were tried may have a part each of what one law explains, so that no law is accepted beside them, and
/// several instruments that are all at fault, or many names of any kind, are rarer than one law of the specimen. A name is still preferred to a law that gains little more.
pub fn grown_with_laws_first(
    selector: &mut Selector<'_, '_>,
    calibrated: &Fit,
    best: &Fit,
    grown: &Grown,
    progress: Progress<'_>,
) -> Result<Option<(Grown, Fit)>, DiagnoseError> {
    let acceptance = &selector.criteria().acceptance;
    let named = |fit: &Fit| {
        (fit.point
            .effects
            .iter()
            .filter(|&&e| !selector.candidate(e).is_unlisted()))
        .count()
    };
    let incomplete = !selector.is_complete(best);
    // As many names as a model may have leave no room for a law.
    let no_room = grown.best.point.effects.len() >= acceptance.most_effects;
    let names_came_first = (grown.open != Open::Names || no_room) && named(&grown.best) > 0;
    let faults = (best.point.effects.iter()).filter(|&&e| selector.candidate(e).is_instrument_fault());
    let doubtful = faults.count() >= DOUBTFUL_FAULTS || named(best) >= DOUBTFUL_NAMES;
    if !(incomplete && names_came_first || doubtful) || !selector.can_have_two_laws() {
        return Ok(None);
    }
    let fraction = if incomplete {
        selector.fraction_of_incomplete()
    } else {
        acceptance.least_fraction
    };
    let anew = grow(selector, calibrated, calibrated.clone(), Open::Laws, progress)?;
    let other = reduced(selector, anew.best.clone(), progress)?;
    let better = selector.improves(best, &other, fraction);
    let as_good_with_fewer =
        other.point.effects.len() < best.point.effects.len() && !selector.improves(&other, best, fraction);
    Ok((better || as_good_with_fewer).then_some((anew, other)))
}

/// A model without what its other effects explain, each effect in its simplest form.
pub fn reduced(selector: &mut Selector<'_, '_>, grown: Fit, progress: Progress<'_>) -> Result<Fit, DiagnoseError> {
    progress("dropping what the others explain", done::ELIMINATION);
    selector.reduced(grown)
}

/// Adds effects to a model until none is accepted. Laws without a name are tried when no name is left and the noise is not reached, and those of many
/// starts or numbers when no other is left; a second one, beside the first, while the model is not complete. Where no law is accepted alone and the model is far from complete, laws are tried in pairs.
pub fn grow(
    selector: &mut Selector<'_, '_>,
    calibrated: &Fit,
    from: Fit,
    mut open: Open,
    progress: Progress<'_>,
) -> Result<Grown, DiagnoseError> {
    let criteria = selector.criteria();
    let laws_first = open == Open::Laws && from.point.effects.is_empty();
    let mut best = from;
    let mut law_pairs = LawPairs::NotTried;
    let mut restarted_in_vain: Option<Point> = None;
    let mut scores: Vec<CandidateScore> = Vec::new();
    let mut screened_alone: Vec<Screened> = Vec::new();
    loop {
        let screening = done::SCREENING + done::EFFECT * best.point.effects.len() as f64;
        progress("screening every candidate", screening);
        let screened = selector.screen(&best, selector.open(&best.point, open))?;
        if best.point.effects.is_empty() {
            score_alone(selector, &screened, &mut scores);
            if screened_alone.is_empty() {
                screened_alone.clone_from(&screened);
            }
        }
        progress(
            "fitting the strongest candidates",
            screening + done::FITTING_AFTER_SCREENING,
        );
        let full = best.point.effects.len() >= criteria.acceptance.most_effects;
        let next = match open {
            _ if full => None,
            Open::Laws if laws_first => selector.strongest_name_or_law(&screened, &best)?,
            Open::Names | Open::Numbers | Open::Laws => selector.strongest(&screened, &best)?,
            Open::TwoLaws => selector.strongest_name_or_law(&screened, &best)?,
        };
        if let Some(next) = next {
            best = selector.with_last_law_reshaped(next)?;
            continue;
        }
        let incomplete = !selector.is_complete(&best);
        if restarted_in_vain.as_ref() != Some(&best.point) {
            if let Some(better) = selector.restarted(&best)? {
                best = better;
                continue;
            }
            if incomplete && let Some(better) = selector.reshaped(&best, open)? {
                best = better;
                continue;
            }
            restarted_in_vain = Some(best.point.clone());
            if incomplete
                && !full
                && let Some(split) = selector.split(&best)?
            {
                best = split;
                continue;
            }
        }
        let lacks_more = !full && !selector.reaches_noise(&best);
        if !full && incomplete && matches!(open, Open::Laws | Open::TwoLaws) {
            progress("trying what is not screened", screening + done::FITTING_AFTER_SCREENING);
            let at_last = selector.open_at_last(&best.point, open);
            let screened = selector.screen_in_passing(&best, at_last)?;
            if let Some(next) = selector.strongest(&screened, &best)? {
                best = next;
                continue;
            }
        }
        if open == Open::Names
            && lacks_more
            && let Some(woken) = selector.with_dormant_numbers([&best, calibrated])?
        {
            best = woken;
            continue;
        }
        if open == Open::Names && lacks_more {
            progress(
                "trying other numbers of the model",
                screening + done::FITTING_AFTER_SCREENING,
            );
            if let Some(completed) = selector.completed_by_numbers([&best, calibrated])? {
                (best, open) = (completed, Open::Numbers);
                continue;
            }
        }
        if !full && open == Open::Names && selector.is_far_from_complete(&best, calibrated) {
            progress("trying combinations", screening + done::FITTING_AFTER_SCREENING);
            let end = Screening {
                model: &best,
                screened: &screened,
            };
            let begin = Screening {
                model: calibrated,
                screened: &screened_alone,
            };
            if let Some(next) = selector.strongest_combination(end, begin)? {
                best = next;
                continue;
            }
        }
        if open == Open::Names && lacks_more {
            progress(
                "trying pairs in the place of each effect",
                screening + done::FITTING_AFTER_SCREENING,
            );
            if let Some(pair) = selector.two_in_place_of_one(&best)? {
                best = pair;
                continue;
            }
        }
        let laws = selector.laws_of(&best.point);
        let next = match open {
            Open::Names if lacks_more => Some(Open::Laws),
            Open::Laws if !full && incomplete && selector.can_have_two_laws() => Some(Open::TwoLaws),
            _ => None,
        };
        if next == Some(Open::TwoLaws) && laws == 0 {
            if selector.is_far_from_complete(&best, calibrated) {
                progress("trying pairs of laws", screening + done::FITTING_AFTER_SCREENING);
                let end = Screening {
                    model: &best,
                    screened: &screened,
                };
                if let Some(pair) = selector.combination_beside(end, Open::TwoLaws, &best)? {
                    (best, open, law_pairs) = (pair, Open::TwoLaws, LawPairs::Found);
                    continue;
                }
                law_pairs = LawPairs::NoneAccepted;
            }
        } else if let Some(next) = next {
            open = next;
            continue;
        }
        return Ok(Grown {
            best,
            screened,
            scores,
            open: match open {
                // A second law takes no effect's place.
                Open::TwoLaws if laws < 2 => Open::Laws,
                // A law may be what looks like a wrong number.
                Open::Numbers => Open::Laws,
                open => open,
            },
            law_pairs,
        });
    }
}

/// Notes what candidates explain alone; laws without a name join when they are tried.
fn score_alone(selector: &Selector<'_, '_>, screened: &[Screened], scores: &mut Vec<CandidateScore>) {
    for (candidate, fit) in screened {
        // What swings was not tried where the residual holds no frequency.
        let was_tried = fit.is_some() || !selector.candidate(*candidate).oscillates;
        if was_tried && scores.iter().all(|s| s.candidate != *candidate) {
            scores.push(CandidateScore {
                candidate: *candidate,
                alone: fit.as_ref().map_or(f64::INFINITY, |f| selector.held_out_ratio(f)),
                added: None,
                least_sizes: vec![],
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{CUBIC, FIRST_OF_PAIR, FRICTION, NEARLY_CUBIC, RUN, Recipe, VIBRATION};
    use crate::criteria::Criteria;
    use crate::estimation::LeastSquares;
    use crate::specimen::Specimen;
    use crate::vocabulary::{Column, Site};

    /// What a model of a name becomes with laws first, where this was open before and a model may have so many effects.
    fn anew_with_laws_first(open: Open, most_effects: usize) -> Option<Vec<usize>> {
        let mut specimen = Recipe {
            truth: vec![(CUBIC, vec![0.4])],
            candidates: vec![CUBIC, FRICTION],
            ..Recipe::default()
        }
        .make();
        specimen.take_name(CUBIC, Site::Mount);
        let mut criteria = Criteria::default();
        criteria.acceptance.most_effects = most_effects;
        let problem = LeastSquares::new(&specimen, &RUN).with_criteria(criteria);
        let mut selector = Selector::new(&problem);
        let calibrated = selector.fitted(Point::nominal(&specimen)).expect("a fit");
        let start = Point::nominal(&specimen).with_effect(&specimen, FRICTION, &[0.1]);
        let best = selector.fitted(start).expect("a fit");
        let grown = Grown {
            best: best.clone(),
            screened: vec![],
            scores: vec![],
            open,
            law_pairs: LawPairs::NotTried,
        };
        let other = grown_with_laws_first(&mut selector, &calibrated, &best, &grown, &|_, _| {}).expect("fits");
        other.map(|(_, fit)| fit.point.effects)
    }

    #[test]
    fn a_name_that_came_before_laws_gives_way_to_the_law_that_explains_more() {
        assert_eq!(anew_with_laws_first(Open::Laws, 6), Some(vec![CUBIC]));
        assert_eq!(anew_with_laws_first(Open::Names, 6), None);
    }

    #[test]
    fn so_do_as_many_names_as_a_model_may_have() {
        assert_eq!(anew_with_laws_first(Open::Names, 1), Some(vec![CUBIC]));
    }

    #[test]
    fn three_faults_of_instruments_or_four_names_give_way_to_one_law_that_does_as_well_and_fewer_do_not() {
        let anew = |effects: &[usize], faults: usize| {
            let mut specimen = Recipe {
                truth: vec![(CUBIC, vec![0.4])],
                candidates: [&[CUBIC], effects].concat(),
                ..Recipe::default()
            }
            .make();
            specimen.take_name(CUBIC, Site::Mount);
            for (fault, column) in effects[..faults].iter().zip(["p1_Pa", "p2_Pa", "p3_Pa"]) {
                specimen.become_fault(*fault, Column::known(column));
            }
            let problem = LeastSquares::new(&specimen, &RUN);
            let mut selector = Selector::new(&problem);
            let calibrated = selector.fitted(Point::nominal(&specimen)).expect("a fit");
            let start = (effects.iter()).fold(Point::nominal(&specimen), |point, effect| {
                let values: Vec<f64> = specimen.candidates()[*effect]
                    .parameters
                    .iter()
                    .map(|p| p.start)
                    .collect();
                point.with_effect(&specimen, *effect, &values)
            });
            let best = selector.fitted(start).expect("a fit");
            let grown = Grown {
                best: best.clone(),
                screened: vec![],
                scores: vec![],
                open: Open::Names,
                law_pairs: LawPairs::NotTried,
            };
            let other = grown_with_laws_first(&mut selector, &calibrated, &best, &grown, &|_, _| {}).expect("fits");
            other.map(|(_, fit)| fit.point.effects.len())
        };
        assert_eq!(anew(&[NEARLY_CUBIC, FRICTION, VIBRATION], 3), Some(1));
        assert_eq!(anew(&[NEARLY_CUBIC, FRICTION, VIBRATION], 2), None);
        assert_eq!(anew(&[NEARLY_CUBIC, FRICTION, VIBRATION, FIRST_OF_PAIR], 2), Some(1));
    }
}
