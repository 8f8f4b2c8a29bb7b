//! What a bus did not carry: displacements and switching signals that are NaN in a recording.
//!
//! A displacement follows from the smoothed motion. Where signals are missing and a valve was switched meanwhile, nobody knows in which sample; oil that
//! the valve encloses stays enclosed until it opens again, so that an error of one sample may last for seconds.

use oleo_interface::{StrutValves, Valve};
use oleo_plant_sim::strut::Inputs;

use super::channels::Layout;
use crate::recording::Recording;

/// Where an edge may be within the samples that are missing, as a part of them: as far from the middle, to either side, as an edge is that may be anywhere
/// (its standard deviation).
const EARLY_AND_LATE: [f64; 2] = [0.211, 0.789];

/// Puts the smoothed motion where a displacement was not read.
pub fn fill_displacement(displacement_m: &mut [f64], inputs: &Inputs) {
    let motion = &inputs.motion;
    let smoothed = std::iter::once(motion.start_m).chain(motion.segments.iter().map(|s| s.to_m));
    for (x, smoothed) in displacement_m.iter_mut().zip(smoothed).filter(|(x, _)| x.is_nan()) {
        *x = smoothed;
    }
}

/// Puts each edge that is not known in the middle of the samples that are missing. Returns the switching signals with these edges early and late, if
/// there are any.
pub fn fill_signals(recording: &mut Recording, layout: Layout) -> Option<[Vec<StrutValves<bool>>; 2]> {
    let signals = layout.valves()..layout.valves() + Valve::ALL.len();
    let any_unread = recording.columns[signals.clone()].iter().flatten().any(|v| v.is_nan());
    let with_edges_at = |part: f64| {
        let mut other = recording.clone();
        other.columns[signals.clone()]
            .iter_mut()
            .for_each(|signal| fill_signal(signal, part));
        other
    };
    let other = any_unread.then(|| EARLY_AND_LATE.map(|part| layout.signals(&with_edges_at(part))));
    *recording = with_edges_at(0.5);
    other
}

/// Puts an edge at a part of each stretch without readings.
fn fill_signal(signal: &mut [f64], part: f64) {
    let mut k = 0;
    while k < signal.len() {
        let start = k;
        while k < signal.len() && signal[k].is_nan() {
            k += 1;
        }
        if k > start {
            // A valve is closed until the first command, and stays as it is after the last one.
            let before = start.checked_sub(1).map_or(0.0, |last| signal[last]);
            let after = signal.get(k).copied().unwrap_or(before);
            let edge = start + (part * (k - start) as f64).round() as usize;
            signal[start..edge].fill(before);
            signal[edge..k].fill(after);
        }
        k += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_may_be_anywhere_in_the_samples_that_are_missing() {
        let filled = |signal: &[f64], part: f64| {
            let mut signal = signal.to_vec();
            fill_signal(&mut signal, part);
            signal
                .iter()
                .map(|v| if *v > 0.5 { '1' } else { '0' })
                .collect::<String>()
        };
        let nan = f64::NAN;
        let opens = [0.0, nan, nan, nan, nan, 1.0, 1.0];
        assert_eq!(
            [0.0, 0.5, 1.0].map(|part| filled(&opens, part)),
            ["0111111", "0001111", "0000011"]
        );
        assert_eq!(EARLY_AND_LATE.map(|part| filled(&opens, part)), ["0011111", "0000111"]);
        // Without a command a valve is closed, and where none follows it stays as it is.
        assert_eq!(filled(&[nan, nan, 1.0, nan, nan], 0.5), "01111");
    }
}
