//! Where the misfit is: in which recording, when, under which condition; and which measured relation breaks.

use crate::error::DiagnoseError;
use crate::fit::{Effort, fit};
use crate::problem::Problem;
use crate::select::Selection;
use crate::specimen::{Series, Specimen};

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
    /// Under which condition, in words with figures.
    pub condition: String,
    /// Channel in which it shows most.
    pub channel: String,
}

/// A relation between measured neighbours that holds whatever happens elsewhere.
#[derive(Debug, Clone)]
pub struct Relation {
    /// What is tested.
    pub name: &'static str,
    /// RMS of its misfit after removing a constant, in units of its noise; `None` where no sample can test it.
    pub noise_ratio: Option<f64>,
    /// Samples used.
    pub samples: usize,
}

/// Bins of a state over which misfit is compared.
const BINS: usize = 8;
/// A misfit below this many times the noise variance per sample is not worth a location.
const LEAST_EXCESS: f64 = 0.03;

/// Locations of every effect found, or, where none was, of what is left.
///
/// # Errors
/// As the fit without an effect.
pub fn locate(
    problem: &Problem<'_>,
    selection: &Selection,
    calibrated: &[Series],
    improved: &[Series],
) -> Result<Vec<Location>, DiagnoseError> {
    let count = problem.count() as f64;
    let total = |r: &[Series]| {
        r.iter()
            .flatten()
            .map(|c| c.iter().map(|v| v * v).sum::<f64>())
            .sum::<f64>()
    };
    let excess = (total(calibrated) - total(improved).min(total(calibrated))).max(1.0);
    let mut out = Vec::new();
    for chosen in &selection.chosen {
        let Some(position) = selection.best.point.effects.iter().position(|&e| e == chosen.candidate) else {
            continue;
        };
        let without = fit(problem, problem.without(&selection.best.point, position), Effort::QUICK)?;
        let without = problem.residuals(&problem.predict(&without.point)?);
        let share = ((total(&without) - total(improved)) / excess).clamp(0.0, 1.0);
        let place = problem.specimen.candidates()[chosen.candidate].place.clone();
        out.push(strongest(problem.specimen, place, share, &without, improved));
    }
    if out.is_empty() && total(improved) / count > 1.0 + LEAST_EXCESS {
        let none: Vec<Series> = improved
            .iter()
            .map(|r| r.iter().map(|c| vec![1.0; c.len()]).collect())
            .collect();
        out.push(strongest(problem.specimen, "unknown".into(), 1.0, improved, &none));
    }
    Ok(out)
}

/// Where `without` is worst against `with`.
fn strongest(specimen: &dyn Specimen, place: String, share: f64, without: &[Series], with: &[Series]) -> Location {
    let gain = |r: usize, c: usize| -> Vec<f64> {
        without[r][c]
            .iter()
            .zip(&with[r][c])
            .map(|(a, b)| a * a - b * b)
            .collect()
    };
    let (mut worst, mut recording, mut channel) = (f64::MIN, 0, 0);
    for (r, channels) in without.iter().enumerate() {
        for c in 0..channels.len() {
            let sum: f64 = gain(r, c).iter().sum();
            if sum > worst {
                (worst, recording, channel) = (sum, r, c);
            }
        }
    }
    let g = gain(recording, channel);
    let time = specimen.time_s(recording);
    let (from, to) = window(&g);
    let mut best = (1.0, "everywhere".to_owned());
    for (name, state) in specimen.states(recording) {
        if let Some((factor, text)) = concentrated(name, &state, &g)
            && factor > best.0
        {
            best = (factor, text);
        }
    }
    Location {
        place,
        share_of_excess: share,
        recording,
        t_s: [time[from], time[to]],
        condition: best.1,
        channel: specimen.channels()[channel].name.clone(),
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

/// The bin of a state (equal numbers of samples) in which the mean gain is largest, over the mean of all.
fn concentrated(name: &str, state: &[f64], gain: &[f64]) -> Option<(f64, String)> {
    let n = state.len();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| state[a].total_cmp(&state[b]));
    let mean = gain.iter().sum::<f64>() / n as f64;
    if mean <= 0.0 || n < 4 * BINS {
        return None;
    }
    (0..BINS)
        .map(|b| {
            let bin = &order[n * b / BINS..n * (b + 1) / BINS];
            let factor = bin.iter().map(|&k| gain[k]).sum::<f64>() / bin.len() as f64 / mean;
            let (low, high) = (state[bin[0]], state[bin[bin.len() - 1]]);
            (
                factor,
                format!("{name} from {low:.3e} to {high:.3e}: {factor:.1} times the mean misfit"),
            )
        })
        .max_by(|a, b| a.0.total_cmp(&b.0))
}

/// Relations between measured neighbours of a strut; none for the other kinds.
#[must_use]
pub fn relations(specimen: &dyn Specimen) -> Vec<Relation> {
    let Some(area) = specimen.piston_area_m2() else {
        return Vec::new();
    };
    let noise: Vec<f64> = specimen.channels().iter().map(|c| c.noise).collect();
    let force_noise = (noise[0] * noise[0] + area * area * noise[1] * noise[1]).sqrt();
    let pressure_noise = |a: usize, b: usize| (noise[a] * noise[a] + noise[b] * noise[b]).sqrt();
    let m = |r: usize, c: usize, k: usize| specimen.measured(r, c)[k];
    let slow = |r: usize, k: usize| specimen.quiet(r, k, 0.001);
    vec![
        relation(specimen, "force balance: force - A p1", force_noise, |r, k| {
            Some(m(r, 0, k) - area * m(r, 1, k))
        }),
        relation(specimen, "closed valve 3: p3 = p1", pressure_noise(1, 3), |r, k| {
            specimen.valve_shut(r, k, 2).then(|| m(r, 1, k) - m(r, 3, k))
        }),
        relation(
            specimen,
            "path 1 at rest, valve 1 open: p1 = p2",
            pressure_noise(1, 2),
            |r, k| (slow(r, k) && specimen.valve_open(r, k, 0)).then(|| m(r, 1, k) - m(r, 2, k)),
        ),
        relation(
            specimen,
            "path 2 at rest, valves 2 and 3 open: p1 = p4",
            pressure_noise(1, 4),
            |r, k| {
                (slow(r, k) && specimen.valve_open(r, k, 1) && specimen.valve_open(r, k, 2))
                    .then(|| m(r, 1, k) - m(r, 4, k))
            },
        ),
    ]
}

fn relation(
    specimen: &dyn Specimen,
    name: &'static str,
    noise: f64,
    value: impl Fn(usize, usize) -> Option<f64>,
) -> Relation {
    let values: Vec<f64> = (0..specimen.recordings())
        .flat_map(|r| {
            (0..specimen.time_s(r).len())
                .filter_map(|k| value(r, k))
                .collect::<Vec<_>>()
        })
        .collect();
    let samples = values.len();
    if samples < 20 {
        return Relation {
            name,
            noise_ratio: None,
            samples,
        };
    }
    let mean = values.iter().sum::<f64>() / samples as f64;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / samples as f64;
    Relation {
        name,
        noise_ratio: Some(variance.sqrt() / noise),
        samples,
    }
}
