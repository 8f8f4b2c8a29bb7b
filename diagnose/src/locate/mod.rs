//! Where the misfit is: in which recording, when, under which condition; and which measured relation breaks.

pub mod condition;
pub mod decay;
pub mod relations;

use std::sync::Arc;

use crate::error::DiagnoseError;
use crate::fit::{Effort, fit};
use crate::problem::Problem;
use crate::select::Selection;
use crate::specimen::{Candidate, Series, Specimen};
use condition::{Condition, State};
pub use relations::{Reach, Relation, reaches, relations};

/// A place with the misfit that belongs to it.
#[derive(Debug, Clone)]
pub struct Location {
    /// Place of the vocabulary.
    pub place: String,
    /// Part of the excess misfit of the calibrated model that disappears with the effect found there.
    pub share_of_excess: f64,
    /// Recording in which it shows most.
    pub recording: usize,
    /// When, s.
    pub t_s: [f64; 2],
    /// Under which condition.
    pub condition: Condition,
    /// Channel in which it shows most.
    pub channel: usize,
    /// Effect that belongs to it; `None` for a misfit that nothing explains.
    pub candidate: Option<usize>,
    /// Residuals, in units of noise, of the best model without that effect: all recordings.
    pub without: Arc<Vec<Series>>,
}

/// A misfit below this many times the noise variance per sample is not worth a location.
const LEAST_EXCESS: f64 = 0.03;
/// A decay of this part of the largest misfit is what the misfit is about.
const LEAST_DECAY: f64 = 0.25;
/// A region that holds this much more of the misfit than of the samples says more than a decay.
const SHARP: f64 = 0.8;

/// Locations of every effect found, and of what is left unexplained; the largest share first.
///
/// # Errors
/// As the fit without an effect.
pub fn locate(
    problem: &Problem<'_>,
    selection: &Selection,
    calibrated: &[Series],
    improved: &[Series],
) -> Result<Vec<Location>, DiagnoseError> {
    let specimen = problem.specimen;
    let count = problem.count() as f64;
    let total = |r: &[Series]| {
        r.iter()
            .flatten()
            .map(|c| c.iter().map(|v| v * v).sum::<f64>())
            .sum::<f64>()
    };
    let excess = (total(calibrated) - count).max(1.0);
    let states = states(specimen, every(specimen));
    let mut out = Vec::new();
    for chosen in &selection.chosen {
        let Some(position) = selection.best.point.effects.iter().position(|&e| e == chosen.candidate) else {
            continue;
        };
        let without = fit(problem, problem.without(&selection.best.point, position), Effort::QUICK)?;
        let without = Arc::new(problem.residuals(&problem.predict(&without.point)?));
        let share = ((total(&without) - total(improved)) / excess).clamp(0.0, 1.0);
        for (place, channels, part) in places(specimen, &specimen.candidates()[chosen.candidate], &without, improved) {
            let found = strongest(specimen, &states, &channels, &without, improved);
            out.push(Location {
                place,
                share_of_excess: share * part,
                candidate: Some(chosen.candidate),
                without: without.clone(),
                ..found
            });
        }
    }
    if selection.incomplete || (out.is_empty() && total(improved) / count > 1.0 + LEAST_EXCESS) {
        let none: Vec<Series> = improved
            .iter()
            .map(|r| r.iter().map(|c| vec![0.0; c.len()]).collect())
            .collect();
        let channels: Vec<usize> = (0..specimen.channels().len()).collect();
        out.push(Location {
            place: "unknown".into(),
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
) -> Vec<(String, Vec<usize>, f64)> {
    let channel = |name: &str| specimen.channels().iter().position(|c| c.name == name);
    let pair = match candidate.place.as_str() {
        "accumulators" => [("accumulator-1", channel("p2_Pa")), ("accumulator-2", channel("p4_Pa"))],
        "path-1+path-2" => [("path-1", channel("p2_Pa")), ("path-2", channel("p4_Pa"))],
        place => {
            let mut channels: Vec<usize> = nearest(place).iter().filter_map(|c| channel(c)).collect();
            if channels.is_empty() {
                channels = (0..specimen.channels().len()).collect();
            }
            return vec![(place.to_owned(), channels, 1.0)];
        }
    };
    let misfit = |c: Option<usize>| -> f64 {
        c.map_or(0.0, |c| {
            (0..without.len())
                .map(|r| gain(without, with, r, c).iter().sum::<f64>())
                .sum::<f64>()
                .max(0.0)
        })
    };
    let both = misfit(pair[0].1) + misfit(pair[1].1);
    pair.iter()
        .map(|(place, c)| {
            let part = if both > 0.0 { misfit(*c) / both } else { 0.5 };
            ((*place).to_owned(), c.iter().copied().collect(), part)
        })
        .collect()
}

/// The instruments of a strut next to a place; none where all are as near.
fn nearest(place: &str) -> Vec<&str> {
    match place {
        "main-seal" | "end-stop" => vec!["force_N"],
        "main-chamber" => vec!["p1_Pa"],
        "accumulator-1" => vec!["p2_Pa"],
        "accumulator-2" => vec!["p4_Pa"],
        "path-1" => vec!["p1_Pa", "p2_Pa"],
        "path-2" | "valve-3" => vec!["p3_Pa", "p4_Pa"],
        _ => place.strip_prefix("sensor:").into_iter().collect(),
    }
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
    states: &[State],
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
            condition.text += &format!("; decays with {constant} s while nothing moves");
        } else {
            let time = specimen.time_s(r);
            recording = r;
            t_s = [time[found.samples.0], time[found.samples.1]];
            let region = condition
                .region
                .as_ref()
                .map_or(String::new(), |r| format!("; {}", r.words()));
            condition.text = format!("after a step, decays with {constant} s{region}");
        }
    }
    Location {
        place: String::new(),
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

const SPEED: &str = "speed, m/s";

fn speed(specimen: &dyn Specimen, recording: usize) -> Option<Vec<f64>> {
    let mut states = specimen.states(recording).into_iter();
    states.find(|(name, _)| *name == SPEED).map(|(_, values)| values)
}

/// Samples from which a condition is read: of longer campaigns one of `every` is taken.
const SAMPLES: usize = 200_000;

fn every(specimen: &dyn Specimen) -> usize {
    let all: usize = (0..specimen.recordings()).map(|r| specimen.time_s(r).len()).sum();
    all.div_ceil(SAMPLES).max(1)
}

/// States of all recordings one after the other, one sample of `every` in each, and what follows from the speed: its size and its direction.
#[must_use]
pub fn states(specimen: &dyn Specimen, every: usize) -> Vec<State> {
    let mut all: Vec<State> = Vec::new();
    let mut before = 0;
    for r in 0..specimen.recordings() {
        let n = specimen.time_s(r).len().div_ceil(every);
        for (name, values) in specimen.states(r) {
            let state = match all.iter_mut().find(|s| s.name == name) {
                Some(known) => known,
                None => {
                    all.push(State {
                        name: name.into(),
                        values: Vec::new(),
                    });
                    all.last_mut().expect("just added")
                }
            };
            // Undefined in the recordings that do not have it.
            state.values.resize(before, f64::NAN);
            state.values.extend(values.into_iter().step_by(every));
        }
        before += n;
    }
    all.iter_mut().for_each(|s| s.values.resize(before, f64::NAN));
    if let Some(speed) = all.iter().find(|s| s.name == SPEED).map(|s| s.values.clone()) {
        let fastest = speed.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let direction = |v: &f64| {
            if v.abs() < 1e-4 * fastest { 0.0 } else { v.signum() }
        };
        all.push(State {
            name: "direction of travel".into(),
            values: speed.iter().map(direction).collect(),
        });
        all.push(State {
            name: "size of the speed, m/s".into(),
            values: speed.iter().map(|v| v.abs()).collect(),
        });
    }
    all
}
