//! Effects of the oil, the gas or the design that some corners show, tried at the corners that do not show them, and those that all corners show with numbers
//! that contradict each other.
//!
//! What all four struts share may be too weak to be found at each of them: one strut moves less than the others, or something else explains it as well
//! there. Where two or three corners show such an effect with estimates that agree, and the recordings of every other corner do not speak against it
//! ([`with_shared`]), it is an effect of the vehicle. Where one corner alone shows it, the recordings of all others must speak for it, with the number of this one.
//! Where all corners show it and do not agree, the search may have ended in a minimum at one of them that is not the lowest: each is fitted once more from the
//! numbers of all others ([`begun_at_others`]).

use std::ops::RangeInclusive;
use std::sync::atomic::AtomicBool;

use oleo_interface::{Corner, Corners};

use super::campaign::VehicleCampaign;
use super::common::{common, is_shared};
use super::pooling::Pooled;
use crate::diagnosis::{Diagnosis, Effect};
use crate::effect::Candidate;
use crate::error::DiagnoseError;
use crate::estimation::{LeastSquares, interval};
use crate::parameter::Parameter;
use crate::search::{begun_at_others, with_shared};

/// By how much the cost of every other corner falls with what one corner alone shows, if it is an effect of the vehicle: three standard deviations of its size,
/// which is not fitted there. An effect of one corner makes the cost of the others rise. Where it takes the place of another effect, [`with_shared`] allows more.
const SPEAKS_FOR_IT: f64 = 9.0;

/// The diagnoses of the corners, with what all of them share.
///
/// # Errors
/// [`DiagnoseError::Interrupted`] once the caller asked to stop.
pub fn with_what_all_share(
    campaign: &VehicleCampaign,
    mut corners: Corners<Diagnosis>,
    stop: &AtomicBool,
) -> Result<Corners<Diagnosis>, DiagnoseError> {
    let struts = Corners::from_fn(|corner| LeastSquares::new(&*campaign.corners[corner].specimen, stop));
    for effect in shown_by_all(&struts, &corners) {
        if !agree_on(
            effect,
            &corners.each_ref().map(|diagnosis| diagnosis.effects.as_slice()),
        ) {
            begin_at_others(effect, &struts, &mut corners)?;
        }
    }
    for effect in shown_by_some(&struts, &corners) {
        let mut with_it = shared_by_all(effect, &struts, &corners)?;
        let effects = Corners::from_fn(|c| with_it[c].as_ref().unwrap_or(&corners[c]).effects.as_slice());
        if agree_on(effect, &effects) {
            for (corner, diagnosis) in corners.iter_mut() {
                if let Some(with_it) = with_it[corner].take() {
                    *diagnosis = with_it;
                }
            }
        }
    }
    Ok(corners)
}

/// Whether all corners have an effect with one value.
fn agree_on(effect: &Candidate, effects: &Corners<&[Effect]>) -> bool {
    let first = effects[Corner::FrontLeft];
    (common(effects).iter())
        .map(|c| &first[c.positions[Corner::FrontLeft]])
        .any(|e| (e.id, &e.label) == (effect.id, &effect.label))
}

/// Candidates that one to three corners have in their models, of effects that a vehicle's struts share.
fn shown_by_some<'a>(struts: &Corners<LeastSquares<'a>>, corners: &Corners<Diagnosis>) -> Vec<&'a Candidate> {
    shown_by(1..=3, struts, corners)
}

/// Candidates that all corners have in their models, of effects that a vehicle's struts share.
fn shown_by_all<'a>(struts: &Corners<LeastSquares<'a>>, corners: &Corners<Diagnosis>) -> Vec<&'a Candidate> {
    shown_by(4..=4, struts, corners)
}

/// Candidates that so many corners have in their models, of effects that a vehicle's struts share.
fn shown_by<'a>(
    many: RangeInclusive<usize>,
    struts: &Corners<LeastSquares<'a>>,
    corners: &Corners<Diagnosis>,
) -> Vec<&'a Candidate> {
    let mut shown: Vec<(&Candidate, usize)> = Vec::new();
    for (corner, diagnosis) in corners.iter() {
        let candidates = struts[corner].specimen().candidates();
        for &effect in &diagnosis.selection.best.point.effects {
            let candidate = &candidates[effect];
            match shown.iter_mut().find(|(other, _)| is_same(other, candidate)) {
                Some((_, times)) => *times += 1,
                None if is_shared(candidate.id) => shown.push((candidate, 1)),
                None => {}
            }
        }
    }
    let wanted = |&(candidate, times): &(&'a Candidate, usize)| many.contains(&times).then_some(candidate);
    shown.iter().filter_map(wanted).collect()
}

fn is_same(one: &Candidate, other: &Candidate) -> bool {
    (one.id, &one.place, &one.label) == (other.id, &other.place, &other.label)
}

/// Fits each corner once more from the numbers with which every other one shows an effect, and keeps what is better.
fn begin_at_others(
    effect: &Candidate,
    struts: &Corners<LeastSquares<'_>>,
    corners: &mut Corners<Diagnosis>,
) -> Result<(), DiagnoseError> {
    let shown = Corners::from_fn(|corner| numbers_of(effect, &struts[corner], &corners[corner]));
    for (corner, diagnosis) in corners.iter_mut() {
        let Some((candidate, _)) = shown[corner] else { continue };
        let parameters = &struts[corner].specimen().candidates()[candidate].parameters;
        let others = shown.iter().filter(|(other, _)| *other != corner);
        let starts: Vec<Vec<f64>> = others
            .filter_map(|(_, shown)| shown.as_ref())
            .map(|(_, numbers)| parameters.iter().zip(numbers).map(|(p, &value)| p.z(value)).collect())
            .collect();
        if let Some(selection) = begun_at_others(&struts[corner], &diagnosis.selection, candidate, &starts)? {
            *diagnosis = Diagnosis::of_selection(&struts[corner], selection)?;
        }
    }
    Ok(())
}

/// The candidate of an effect in the model of a corner, and its numbers there.
fn numbers_of(effect: &Candidate, strut: &LeastSquares<'_>, diagnosis: &Diagnosis) -> Option<(usize, Vec<f64>)> {
    let (specimen, point) = (strut.specimen(), &diagnosis.selection.best.point);
    let position = (point.effects.iter()).position(|&e| is_same(&specimen.candidates()[e], effect))?;
    let parameters = point.parameters(specimen);
    let own = point.coordinates_of(specimen, position);
    Some((
        point.effects[position],
        own.map(|k| parameters[k].value(point.z[k])).collect(),
    ))
}

/// The diagnoses with an effect, of the corners that do not show it; none unless it joins the model of all of them.
fn shared_by_all(
    effect: &Candidate,
    struts: &Corners<LeastSquares<'_>>,
    corners: &Corners<Diagnosis>,
) -> Result<Corners<Option<Diagnosis>>, DiagnoseError> {
    let mut estimates = Vec::new();
    let mut others = Vec::new();
    for (corner, diagnosis) in corners.iter() {
        let candidates = struts[corner].specimen().candidates();
        let effects = &diagnosis.selection.best.point.effects;
        match effects.iter().position(|&e| is_same(&candidates[e], effect)) {
            Some(position) => estimates.push(estimated(&struts[corner], diagnosis, position)?),
            None => others.push((corner, candidates.iter().position(|c| is_same(c, effect)))),
        }
    }
    let better_by = if estimates.len() == 1 { SPEAKS_FOR_IT } else { 0.0 };
    let mut with_it = Corners::from_fn(|_| None);
    for (corner, candidate) in others {
        let (strut, found) = (&struts[corner], &corners[corner].selection);
        let known =
            candidate.and_then(|c| Some((c, pooled(&estimates, &strut.specimen().candidates()[c].parameters)?)));
        let joined = match known {
            Some((candidate, coordinates)) => with_shared(strut, found, candidate, &coordinates, better_by)?,
            None => None,
        };
        let Some(selection) = joined else {
            return Ok(Corners::from_fn(|_| None));
        };
        with_it[corner] = Some(Diagnosis::of_selection(strut, selection)?);
    }
    Ok(with_it)
}

/// The numbers of an effect as a corner shows them: each with the value one standard deviation away.
fn estimated(strut: &LeastSquares<'_>, diagnosis: &Diagnosis, position: usize) -> Result<Vec<[f64; 2]>, DiagnoseError> {
    let best = &diagnosis.selection.best;
    let parameters = best.point.parameters(strut.specimen());
    let deviations = interval::deviations(strut, &interval::derived_from_both_sides(strut, best)?)?;
    let own = best.point.coordinates_of(strut.specimen(), position);
    Ok(own
        .map(|k| [0.0, deviations[k]].map(|step| parameters[k].value(best.point.z[k] + step)))
        .collect())
}

/// The mean of what the corners show, as coordinates of parameters; `None` if they contradict each other.
fn pooled(estimates: &[Vec<[f64; 2]>], parameters: &[Parameter]) -> Option<Vec<f64>> {
    (parameters.iter().enumerate())
        .map(|(k, parameter)| {
            let of_corners = estimates.iter().map(|numbers| {
                let [z, one_away] = numbers.get(k).map_or([f64::NAN; 2], |v| v.map(|v| parameter.z(v)));
                (z, one_away - z)
            });
            Some(Pooled::of(of_corners)?.mean)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn estimates_that_agree_are_pooled_by_their_variances() {
        let modulus = [Parameter::log("bulk_modulus_Pa", 1.4e9, (1e8, 1e10))];
        let two = |second: [f64; 2]| pooled(&[vec![[1.40e9, 1.41e9]], vec![second]], &modulus);
        let mean = |z: Option<Vec<f64>>| modulus[0].value(z.expect("they agree")[0]);
        assert!((mean(two([1.42e9, 1.43e9])) / 1.41e9 - 1.0).abs() < 1e-3);
        // One that knows little has little say, and one that knows nothing has none.
        assert!((mean(two([1.6e9, 1.8e9])) / 1.40e9 - 1.0).abs() < 1e-3);
        assert!((mean(two([1.6e9, f64::INFINITY])) / 1.40e9 - 1.0).abs() < 1e-9);
        assert_eq!(two([1.5e9, 1.51e9]), None);
        let unknown = vec![[1.5e9, f64::INFINITY]];
        assert_eq!(pooled(&[unknown.clone(), unknown], &modulus), None);
    }

    #[test]
    fn of_one_corner_it_is_what_this_shows_and_of_none_with_this_number_nothing() {
        let size = [Parameter::amount("share", 0.1, 1.0)];
        assert_eq!(pooled(&[vec![[0.2, 0.21]]], &size), Some(vec![2.0]));
        assert_eq!(pooled(&[vec![], vec![]], &size), None);
    }
}
