//! Which relation breaks: once from measured neighbours alone, once by which relation must change to explain the misfit.

use oleo_interface::Valve;

use crate::select::Selection;
use crate::specimen::{Candidate, Specimen};
use crate::vocabulary::{EffectId, Site};

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

/// What changing one relation of the model, and nothing else, can explain.
#[derive(Debug, Clone)]
pub struct Reach {
    /// The relation.
    pub relation: String,
    /// Part of the held-out misfit beyond noise that disappears, at most 1.
    pub share_of_excess: f64,
    /// Candidate that does it.
    pub candidate: usize,
}

/// The relation of the model that a candidate changes.
#[must_use]
pub fn changed_by(candidate: &Candidate) -> String {
    let words = || candidate.place.site.to_string().replace('-', " ");
    match (&candidate.place.site, candidate.id) {
        (Site::Sensor(column), _) => format!("instrument {column}"),
        (Site::MainSeal | Site::EndStop, _) => "force balance".into(),
        (Site::Mount, _) => "motion of the strut (mount)".into(),
        (Site::MainChamber, _) => "continuity of the oil".into(),
        (Site::Chamber | Site::Accumulators, _) => "gas law".into(),
        (_, EffectId::AccumulatorPistonFriction) => format!("piston of {}", words()),
        (Site::Accumulator(_), _) => format!("gas law of {}", words()),
        (Site::Valves, _) => "valve timing".into(),
        (Site::Valve(Valve::Spring), _) => "flow through valve 3".into(),
        (Site::Paths, _) => "flow in both paths".into(),
        (Site::Path(_) | Site::Valve(_) | Site::Unknown, _) => format!("flow in {}", words()),
    }
}

/// Every relation with the share of the excess misfit that its best candidate explains alone, largest first.
#[must_use]
pub fn reaches(specimen: &dyn Specimen, selection: &Selection) -> Vec<Reach> {
    let before = selection.noise_ratio.0 * selection.noise_ratio.0;
    let excess = before - 1.0;
    let mut out: Vec<Reach> = Vec::new();
    if excess < super::LEAST_EXCESS {
        return out;
    }
    for trial in &selection.trials {
        let relation = changed_by(&specimen.candidates()[trial.candidate]);
        let share = ((before - trial.alone * trial.alone) / excess).clamp(0.0, 1.0);
        match out.iter_mut().find(|r| r.relation == relation) {
            Some(known) if known.share_of_excess >= share => {}
            Some(known) => (known.share_of_excess, known.candidate) = (share, trial.candidate),
            None => out.push(Reach {
                relation,
                share_of_excess: share,
                candidate: trial.candidate,
            }),
        }
    }
    out.sort_by(|a, b| b.share_of_excess.total_cmp(&a.share_of_excess));
    out
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
    // At rest: nothing moves, and no oil flows from one accumulator to the other after a valve has opened.
    let slow = |r: usize, k: usize| specimen.quiet(r, k, 0.001) && steady(specimen, r, k);
    vec![
        relation(specimen, "force balance: force - A p1", force_noise, |r, k| {
            Some(m(r, 0, k) - area * m(r, 1, k))
        }),
        relation(specimen, "closed valve 3: p3 = p1", pressure_noise(1, 3), |r, k| {
            specimen.valve_shut(r, k, 2).then(|| m(r, 1, k) - m(r, 3, k))
        }),
        relation(
            specimen,
            "path 1 at rest and settled, valve 1 open: p1 = p2",
            pressure_noise(1, 2),
            |r, k| (slow(r, k) && specimen.valve_open(r, k, 0)).then(|| m(r, 1, k) - m(r, 2, k)),
        ),
        relation(
            specimen,
            "path 2 at rest and settled, valves 2 and 3 open: p1 = p4",
            pressure_noise(1, 4),
            |r, k| {
                (slow(r, k) && specimen.valve_open(r, k, 1) && specimen.valve_open(r, k, 2))
                    .then(|| m(r, 1, k) - m(r, 4, k))
            },
        ),
    ]
}

/// Time over which pressures must not change to be called steady, s.
const STEADY_S: f64 = 0.3;
/// Change, in units of noise, that is none.
const STEADY_NOISE: f64 = 4.0;

/// True if neither accumulator's pressure has changed over a while.
fn steady(specimen: &dyn Specimen, recording: usize, sample: usize) -> bool {
    let time = specimen.time_s(recording);
    let interval = (time[time.len() - 1] - time[0]) / time.len() as f64;
    let Some(before) = sample.checked_sub((STEADY_S / interval.max(1e-6)).ceil() as usize) else {
        return false;
    };
    [2, 4].iter().all(|&c| {
        let p = specimen.measured(recording, c);
        (p[sample] - p[before]).abs() < STEADY_NOISE * specimen.channels()[c].noise
    })
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
