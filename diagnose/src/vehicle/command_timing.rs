//! When a logged command acts on the valves: at the sample whose tick it echoes, or at the next one.
//!
//! That depends on what a node calls the end of its tick, so it is decided from the pressures. Physics that the believed model lacks
//! may leave a far greater misfit than a tick does. Therefore only what happens within [`FOLLOWED_S`] of an edge of the switching signals
//! counts, and of it only the changes from sample to sample: each edge gives its [share](super::share) of what the recording contains.

use std::sync::atomic::AtomicBool;

use oleo_interface::{Corners, Valve};

use super::share::{HALF, Share, changes, median};
use crate::error::DiagnoseError;
use crate::estimation::{LeastSquares, Point};
use crate::recording::Recording;
use crate::specimen::strut::TwoStageStrut;
use crate::specimen::{Series, Specimen};

/// Time after an edge in which its effect on the pressures is looked at, s: the slowest valves have moved by then.
const FOLLOWED_S: f64 = 0.15;

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
                    Share::of(changes(&early[edge - 1..end], &late[edge - 1..end]))
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
