//! The noise ratio that a complete model reaches.
//!
//! It is not one: the displacement is measured too, and what smoothing leaves of its noise goes through the dampers into
//! p1. How much follows from the recordings themselves: their smoothed motion with noise of the stated size added once
//! more and smoothed once more, both simulated. Only what exceeds this floor is unexplained.

use oleo_plant_sim::strut::{Beginning, Inputs, Prediction, Replay, StrutModel, replay_all};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::channels::Layout;
use crate::specimen::channel::{Channel, Series};

/// Fixed, so that a report is the same every time.
const SEED: u64 = 1;

/// Samples on either side over which a deviation is taken.
const BESIDE: usize = 25;
/// By how much the steps of the converter are moved, in steps: neither a whole nor a half one.
const MOVED: f64 = 0.38;

/// The displacement with noise once more, `noise_m` its standard deviation at each sample. Where the converter has coarse steps, m, the
/// noise is what steps at other positions make: it stands still while the strut does.
#[must_use]
pub fn drawn_again(inputs: &Inputs, noise_m: &dyn Fn(usize) -> f64, step_m: Option<f64>) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let motion = &inputs.motion;
    // Smoothing adds up many samples, so plus or minus one standard deviation is as good as a normal number.
    std::iter::once(motion.start_m)
        .chain(motion.segments.iter().map(|s| s.to_m))
        .enumerate()
        .map(|(k, x)| {
            let up = rng.next_u32() & 1 == 0;
            match step_m {
                Some(step) => step * ((x / step + MOVED).round() - MOVED),
                None if up => x + noise_m(k),
                None => x - noise_m(k),
            }
        })
        .collect()
}

/// Square of the difference that displacement noise makes between the two motions of each pair, in units of the channels' noise, and the number
/// of values; `None` where the model cannot be simulated.
#[must_use]
pub fn excesses(
    model: &StrutModel,
    pairs: &[[&Inputs; 2]],
    layout: Layout,
    channels: &[Channel],
) -> Vec<Option<(f64, usize)>> {
    let square = |difference: &[f64], channel: &Channel| {
        difference.iter().map(|d| d * d).sum::<f64>() / (channel.noise * channel.noise)
    };
    let excess = |differences: Series| {
        let squares = differences.iter().zip(channels).map(|(d, channel)| square(d, channel));
        (squares.sum(), differences.iter().map(Vec::len).sum())
    };
    (differences_of_all(model, pairs, &Beginning::AtRest, layout).into_iter())
        .map(|differences| differences.map(excess))
        .collect()
}

/// Root mean square of a series around each sample.
#[must_use]
pub fn local_deviation(series: &[f64]) -> Vec<f64> {
    local_deviation_of_all(&[series])
}

/// Root mean square of several series, all of one length, around each sample.
#[must_use]
pub fn local_deviation_of_all(series: &[&[f64]]) -> Vec<f64> {
    let length = series.first().map_or(0, |series| series.len());
    let mut sums = Vec::with_capacity(length + 1);
    sums.push(0.0);
    for k in 0..length {
        sums.push(sums[k] + series.iter().map(|series| series[k] * series[k]).sum::<f64>());
    }
    (0..length)
        .map(|k| {
            let (from, to) = (k.saturating_sub(BESIDE), (k + BESIDE + 1).min(length));
            ((sums[to] - sums[from]).max(0.0) / ((to - from) * series.len()) as f64).sqrt()
        })
        .collect()
}

/// What two motions make different in a recording that begins in this way, every recorded channel, in the unit of its column; `None` if the model
/// cannot be simulated.
#[must_use]
pub fn differences(model: &StrutModel, pair: [&Inputs; 2], begins: &Beginning, layout: Layout) -> Option<Series> {
    differences_of_all(model, &[pair], begins, layout).pop().flatten()
}

/// The same of each pair of motions. All are simulated together, which takes less time.
pub fn differences_of_all(
    model: &StrutModel,
    pairs: &[[&Inputs; 2]],
    begins: &Beginning,
    layout: Layout,
) -> Vec<Option<Series>> {
    let wanted: Vec<Replay<'_>> = (pairs.iter().flatten())
        .map(|inputs| Replay {
            model,
            inputs,
            begins: *begins,
            with_course: false,
        })
        .collect();
    let mut simulated = replay_all(&wanted).into_iter().map(|replayed| {
        let Prediction {
            force_n,
            pressure_pa: [p1, p2, p3, p4],
        } = replayed.ok()?.prediction;
        Some(layout.recorded(vec![force_n, p1, p2, p3, p4]))
    });
    let difference = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| a - b).collect();
    (pairs.iter())
        .map(|_| {
            let (a, b) = (simulated.next().flatten(), simulated.next().flatten());
            Some(a?.iter().zip(&b?).map(difference).collect())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vocabulary::Column;
    use oleo_interface::StrutValves;

    #[test]
    fn noise_of_nothing_adds_next_to_nothing_and_more_noise_adds_more() {
        let model = StrutModel::defender110(8000.0);
        let time_s: Vec<f64> = (0..2000).map(|k| 0.004 * f64::from(k)).collect();
        let x: Vec<f64> = time_s.iter().map(|t| 0.02 * libm::sin(8.0 * t) * t.min(1.0)).collect();
        let inputs = Inputs::from_recording(&time_s, &x, &vec![StrutValves::default(); 2000], 5e-6);
        let channels: Vec<Channel> = super::super::channels::CHANNELS
            .iter()
            .map(|c| Channel {
                column: Column::known(c),
                noise: if *c == "force_N" { 12.0 } else { 4e3 },
            })
            .collect();
        let mean = |noise: f64| {
            let drawn = drawn_again(&inputs, &|_| noise, None);
            let jittered = Inputs::from_recording(&inputs.time_s, &drawn, &inputs.signals, noise);
            let (sum, count) = excesses(&model, &[[&inputs, &jittered]], Layout::RIG, &channels)[0].expect("simulated");
            sum / count as f64
        };
        let (none, some, more) = (mean(0.0), mean(5e-6), mean(2e-5));
        // A motion that was smooth is changed a little by being smoothed once more, also without noise.
        assert!(none < 0.01 && some > none && more > 2.0 * some, "{none} {some} {more}");
    }
}
