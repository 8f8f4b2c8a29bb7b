//! Locates the misfit: the recording, the time, the condition, and the relation that does not hold.

pub mod condition;
pub mod decay;
pub mod relations;

use std::sync::Arc;

use crate::effect::{Candidate, ShowsIn, of};
use crate::error::DiagnoseError;
use crate::estimation::LeastSquares;
use crate::search::Selection;
use crate::specimen::{Series, Specimen, StateSeries};
use crate::vocabulary::{Column, Place, Site, State};
use condition::Condition;
pub use relations::{ChangedRelation, relations_changed_alone};

/// A place with the misfit that is caused there.
#[derive(Debug, Clone)]
pub struct Location {
    /// Place where the effect acts.
    pub place: Place,
    /// Fraction of the calibrated model's misfit beyond noise that disappears with the effect at this place.
    pub share_of_excess: f64,
    /// Index of the recording in which the misfit is largest.
    pub recording: usize,
    /// Start and end of the interval with the most misfit, s.
    pub t_s: [f64; 2],
    /// Condition in which the misfit occurs, over all recordings.
    pub condition: Condition,
    /// Index of the channel in which the misfit is largest.
    pub channel: usize,
    /// Index of the candidate that explains the misfit; `None` for an unexplained misfit.
    pub candidate: Option<usize>,
    /// Residuals, in units of noise, of the best model without that effect: all recordings.
    pub without: Arc<Vec<Series>>,
}

/// A misfit below this many times the noise variance per sample gets no location.
const LEAST_EXCESS: f64 = 0.03;
/// A decay of this part of the largest misfit is what the misfit is about.
const LEAST_DECAY: f64 = 0.25;
/// A region that holds this much more of the misfit than of the samples says more than a decay.
const SHARP: f64 = 0.8;

/// Locations of every effect that was found and of the unexplained misfit, with the largest share first.
///
/// # Errors
/// As the simulation of a model without an effect.
pub fn locate(
    problem: &LeastSquares<'_>,
    selection: &Selection,
    calibrated: &[Series],
    improved: &[Series],
) -> Result<Vec<Location>, DiagnoseError> {
    let specimen = problem.specimen();
    let count = problem.residuals() as f64;
    let total = |r: &[Series]| {
        r.iter()
            .flatten()
            .map(|c| c.iter().map(|v| v * v).sum::<f64>())
            .sum::<f64>()
    };
    let excess = (total(calibrated) - count).max(1.0);
    let states = states(specimen, every(specimen));
    let mut out = Vec::new();
    for effect in &selection.effects {
        let without = Arc::new(problem.evaluation.residuals_at(&effect.without)?);
        let share = ((total(&without) - total(improved)) / excess).clamp(0.0, 1.0);
        for (place, channels, part) in places(specimen, &specimen.candidates()[effect.candidate], &without, improved) {
            let found = strongest(specimen, &states, &channels, &without, improved);
            out.push(Location {
                place,
                share_of_excess: share * part,
                candidate: Some(effect.candidate),
                without: without.clone(),
                ..found
            });
        }
    }
    if selection.incomplete {
        let none: Vec<Series> = improved
            .iter()
            .map(|r| r.iter().map(|c| vec![0.0; c.len()]).collect())
            .collect();
        let channels: Vec<usize> = (0..specimen.channels().len()).collect();
        out.push(Location {
            place: Site::Unknown.into(),
            share_of_excess: ((total(improved) - count) / excess).clamp(0.0, 1.0),
            without: Arc::new(improved.to_vec()),
            ..strongest(specimen, &states, &channels, improved, &none)
        });
    }
    out.sort_by(|a, b| b.share_of_excess.total_cmp(&a.share_of_excess));
    Ok(out)
}

/// Where a candidate acts, the channels to look in, and its part of the misfit. One that acts in two accumulators or in
/// both paths has two places; the pressure beyond each tells how much is there.
fn places(
    specimen: &dyn Specimen,
    candidate: &Candidate,
    without: &[Series],
    with: &[Series],
) -> Vec<(Place, Vec<usize>, f64)> {
    let channel = |column: &Column| specimen.channels().iter().position(|c| c.column == *column);
    let place = &candidate.place;
    let parts = match place.site {
        Site::Accumulators | Site::Paths => place.site.parts(),
        _ => {
            let mut channels: Vec<usize> = match of(candidate.id).shows_in() {
                ShowsIn::NextToItsPlace => specimen.nearest_channels(place).iter().filter_map(channel).collect(),
                ShowsIn::EveryChannel => vec![],
            };
            if channels.is_empty() {
                channels = (0..specimen.channels().len()).collect();
            }
            return vec![(place.clone(), channels, 1.0)];
        }
    };
    let parts: Vec<(Place, Option<usize>)> = (parts.into_iter())
        .map(|site| {
            let part = place.with_site(site);
            let beyond = specimen.nearest_channels(&part).last().and_then(channel);
            (part, beyond)
        })
        .collect();
    let misfit = |c: Option<usize>| -> f64 {
        c.map_or(0.0, |c| {
            (0..without.len())
                .map(|r| gain(without, with, r, c).iter().sum::<f64>())
                .sum::<f64>()
                .max(0.0)
        })
    };
    let all: f64 = parts.iter().map(|(_, c)| misfit(*c)).sum();
    let equal = 1.0 / parts.len() as f64;
    parts
        .into_iter()
        .map(|(part, c)| {
            let fraction = if all > 0.0 { misfit(c) / all } else { equal };
            (part, c.into_iter().collect(), fraction)
        })
        .collect()
}

/// Squared misfit a sample that goes with the effect.
fn gain(without: &[Series], with: &[Series], recording: usize, channel: usize) -> Vec<f64> {
    (without[recording][channel].iter().zip(&with[recording][channel]))
        .map(|(a, b)| a * a - b * b)
        .collect()
}

/// Where `without` is worst against `with`, in the given channels.
fn strongest(
    specimen: &dyn Specimen,
    states: &[StateSeries],
    channels: &[usize],
    without: &[Series],
    with: &[Series],
) -> Location {
    let (mut worst, mut recording, mut channel) = (f64::MIN, 0, 0);
    for r in 0..without.len() {
        for &c in channels {
            let sum: f64 = gain(without, with, r, c).iter().sum();
            if sum > worst {
                (worst, recording, channel) = (sum, r, c);
            }
        }
    }
    // The condition is looked for in all recordings: what one of them alone suggests may be its excitation.
    let every = every(specimen);
    let misfit: Vec<f64> = (0..without.len())
        .flat_map(|r| gain(without, with, r, channel).into_iter().step_by(every))
        .collect();
    let difference = |r: usize| -> Vec<f64> {
        (without[r][channel].iter().zip(&with[r][channel]))
            .map(|(a, b)| a - b)
            .collect()
    };
    let residual: Vec<f64> = (0..without.len())
        .flat_map(|r| difference(r).into_iter().step_by(every))
        .collect();
    let mut condition = Condition::of(states, &misfit, &residual);
    let (from, to) = window(&gain(without, with, recording, channel));
    let time = specimen.time_s(recording);
    let mut t_s = [time[from], time[to]];

    // A decay while nothing moves says more than any stretch of a state. What is left unexplained (`with` is nothing) is a
    // mixture, of which one hold tells little.
    let named = with.iter().flatten().flatten().any(|v| *v != 0.0);
    let decays = (0..if named { without.len() } else { 0 }).filter_map(|r| {
        let speed = speed(specimen, r)?;
        Some((r, decay::largest(specimen.time_s(r), &speed, &difference(r))?))
    });
    let largest = residual.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    if let Some((r, found)) = decays.max_by(|a, b| a.1.size.total_cmp(&b.1.size))
        && found.size > LEAST_DECAY * largest
    {
        let constant = oleo_report::significant(found.time_constant_s, 2);
        condition.decays = true;
        let sharp = (condition.region.as_ref()).is_some_and(|region| region.concentration() > SHARP);
        if sharp {
            condition.text += &format!("; decays with a time constant of {constant} s while nothing moves");
        } else {
            let time = specimen.time_s(r);
            recording = r;
            t_s = [time[found.samples.0], time[found.samples.1]];
            let region = condition
                .region
                .as_ref()
                .map_or(String::new(), |r| format!("; {}", r.words()));
            condition.text = format!("after a step, decays with a time constant of {constant} s{region}");
        }
    }
    Location {
        place: Site::Unknown.into(),
        share_of_excess: 0.0,
        recording,
        t_s,
        condition,
        channel,
        candidate: None,
        without: Arc::default(),
    }
}

/// The tenth of the recording with the largest sum.
fn window(gain: &[f64]) -> (usize, usize) {
    let n = gain.len();
    let width = (n / 10).max(1);
    let mut sum: f64 = gain[..width].iter().sum();
    let (mut best, mut at) = (sum, 0);
    for k in width..n {
        sum += gain[k] - gain[k - width];
        if sum > best {
            (best, at) = (sum, k + 1 - width);
        }
    }
    (at, (at + width - 1).min(n - 1))
}

fn speed(specimen: &dyn Specimen, recording: usize) -> Option<Vec<f64>> {
    let mut states = specimen.states(recording).into_iter();
    states.find(|s| s.state == State::Speed).map(|s| s.values)
}

/// Samples from which a condition is read: of longer campaigns one of `every` is taken.
const SAMPLES: usize = 200_000;

fn every(specimen: &dyn Specimen) -> usize {
    specimen.samples().div_ceil(SAMPLES).max(1)
}

/// States of all recordings one after the other, one sample of `every` in each, and what follows from the speed: its size and its direction.
#[must_use]
pub fn states(specimen: &dyn Specimen, every: usize) -> Vec<StateSeries> {
    let mut all: Vec<StateSeries> = Vec::new();
    let mut before = 0;
    for r in 0..specimen.recordings().len() {
        let n = specimen.time_s(r).len().div_ceil(every);
        for StateSeries { state, values } in specimen.states(r) {
            let known = all.iter().position(|s| s.state == state).unwrap_or_else(|| {
                all.push(StateSeries::new(state, Vec::new()));
                all.len() - 1
            });
            // Undefined in the recordings that do not have it.
            all[known].values.resize(before, f64::NAN);
            all[known].values.extend(values.into_iter().step_by(every));
        }
        before += n;
    }
    all.iter_mut().for_each(|s| s.values.resize(before, f64::NAN));
    if let Some(speed) = all.iter().find(|s| s.state == State::Speed).map(|s| s.values.clone()) {
        let fastest = speed.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let direction = |v: &f64| {
            if v.abs() < 1e-4 * fastest { 0.0 } else { v.signum() }
        };
        all.push(StateSeries::new(
            State::Direction,
            speed.iter().map(direction).collect(),
        ));
        let magnitude = speed.iter().map(|v| v.abs()).collect();
        all.push(StateSeries::new(State::SpeedMagnitude, magnitude));
    }
    all
}
