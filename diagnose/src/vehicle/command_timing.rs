//! When a logged command acts on the valves: at the sample whose tick it echoes, or at the next one.
//!
//! That depends on what a node calls the end of its tick, so it is decided from the pressures. Physics that the believed model lacks
//! may leave a far greater misfit than a tick does, and the sum of squares would then decide by chance. Therefore only what happens within
//! [`FOLLOWED_S`] of an edge of the switching signals counts, and of it only the changes from sample to sample. At each edge these
//! give the share of the difference between both simulations that the recording contains, 0 if the command acts at once and 1 if it
//! acts later; the median over all edges decides.

use std::sync::atomic::AtomicBool;

use oleo_interface::{Corners, Valve};

use crate::error::DiagnoseError;
use crate::estimation::{LeastSquares, Point};
use crate::recording::Recording;
use crate::specimen::strut::TwoStageStrut;
use crate::specimen::{Series, Specimen};

/// Time after an edge in which its effect on the pressures is looked at, s: the slowest valves have moved by then.
const FOLLOWED_S: f64 = 0.15;
/// A share above this decides for the later sample.
const HALF: f64 = 0.5;

/// The recording with its switching signals one sample later.
pub fn a_sample_later(mut recording: Recording) -> Recording {
    let first_signal = recording.columns.len() - Valve::ALL.len();
    for signal in &mut recording.columns[first_signal..] {
        if let Some(&first) = signal.first() {
            signal.rotate_right(1);
            signal[0] = first;
        }
    }
    recording
}

/// Whether the struts whose signals act [a sample later](a_sample_later) follow the edges of the valves better, with the believed models.
/// Where no valve was switched, they do not.
///
/// # Errors
/// A model that cannot be simulated.
pub fn acts_later(
    at_once: &Corners<TwoStageStrut>,
    later: &Corners<TwoStageStrut>,
    period_s: f64,
) -> Result<bool, DiagnoseError> {
    let followed = super::bridge::samples_in(FOLLOWED_S, period_s);
    let mut shares = Vec::new();
    for (early, late) in at_once.values().zip(later.values()) {
        let (of_early, of_late) = (residuals(early)?, residuals(late)?);
        for ((recording, early), late) in early.recordings().iter().zip(&of_early).zip(&of_late) {
            for edge in edges(recording) {
                shares.extend((early.iter().zip(late)).filter_map(|(early, late)| {
                    let end = (edge + followed).min(early.len());
                    Share::of(&early[edge - 1..end], &late[edge - 1..end])
                }));
            }
        }
    }
    Ok(median(shares).is_some_and(|share| share > HALF))
}

/// Residuals of the believed model, Pa: the noise of a sample is not the same in both problems.
fn residuals(strut: &TwoStageStrut) -> Result<Vec<Series>, DiagnoseError> {
    let stop = AtomicBool::new(false);
    let problem = LeastSquares::new(strut, &stop);
    let in_noise = problem.evaluation.residuals_at(&Point::nominal(strut))?;
    Ok((in_noise.iter().enumerate())
        .map(|(r, channels)| {
            (channels
                .iter()
                .enumerate()
                .map(|(c, series)| strut.in_units(r, c, series)))
            .collect()
        })
        .collect())
}

/// The samples at which a switching signal differs from the one before.
fn edges(recording: &Recording) -> impl Iterator<Item = usize> + '_ {
    let signals = &recording.columns[recording.columns.len() - Valve::ALL.len()..];
    (1..recording.len()).filter(|&k| signals.iter().any(|signal| signal[k] != signal[k - 1]))
}

/// Share of the difference between two simulations that a recording contains, and how much it weighs.
struct Share {
    value: f64,
    weight: f64,
}

impl Share {
    /// From the residuals of both, after an edge; `None` where they do not differ.
    fn of(early: &[f64], late: &[f64]) -> Option<Self> {
        let (mut product, mut square) = (0.0, 0.0);
        for (early, late) in early.windows(2).zip(late.windows(2)) {
            // A residual is exactly zero where nothing was recorded.
            if early[0] == 0.0 || early[1] == 0.0 {
                continue;
            }
            let change = early[1] - early[0];
            let difference = change - (late[1] - late[0]);
            product += change * difference;
            square += difference * difference;
        }
        (square > 0.0).then(|| Self {
            value: product / square,
            weight: square.sqrt(),
        })
    }
}

/// The median, in which each share counts by its weight.
fn median(mut shares: Vec<Share>) -> Option<f64> {
    shares.sort_by(|a, b| a.value.total_cmp(&b.value));
    let half = 0.5 * shares.iter().map(|share| share.weight).sum::<f64>();
    let mut below = 0.0;
    (shares.iter())
        .find(|share| {
            below += share.weight;
            below >= half
        })
        .map(|share| share.value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_ignores_what_changes_slowly() {
        // A step that comes at sample 3 in the recording and in one simulation, at 4 in the other; both lack a ramp.
        let ramp = |k: usize| 40.0 + 0.3 * k as f64;
        let right: Vec<f64> = (0..12).map(ramp).collect();
        let mut wrong = right.clone();
        wrong[3] += 20.0;
        let later = Share::of(&wrong, &right).expect("they differ");
        assert!((later.value - 1.0).abs() < 0.02, "{}", later.value);
        let at_once = Share::of(&right, &wrong).expect("they differ");
        assert!(at_once.value.abs() < 0.02, "{}", at_once.value);
        assert!(Share::of(&right, &right).is_none());
    }

    #[test]
    fn few_gross_edges_do_not_decide() {
        let share = |value, weight| Share { value, weight };
        let mut shares: Vec<Share> = (0..20).map(|k| share(0.01 * f64::from(k), 1.0)).collect();
        shares.extend([share(30.0, 4.0), share(-9.0, 2.0)]);
        assert!(median(shares).is_some_and(|m| m > 0.0 && m < 0.2));
        assert_eq!(median(vec![]), None);
    }
}
