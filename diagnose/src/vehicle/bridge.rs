//! Missing readings of one strut in one drive.
//!
//! A missing displacement stays missing: the smoother of the motion bridges it, and says what it does not know. The pressures about it do not count. A missing pressure
//! does not count. Where a command is missing, the valves are taken to stay as they were; if they were switched meanwhile, nobody
//! knows in which tick, so the signals stay missing and the pressures do not count until the valve has settled. The drive is cut where more than
//! [`LONGEST_BRIDGE_S`] in a row are missing, because the state of the strut is not known after it.

use std::ops::Range;

use oleo_interface::StrutValves;

use super::drive::StrutSamples;

/// Longest time without readings that is bridged, s.
pub const LONGEST_BRIDGE_S: f64 = 0.1;
/// Gaps up to this length are bridged so well that only the pressures next to them are touched, s.
const SHORT_GAP_S: f64 = 0.015;
/// Pressures that do not count before a gap, and after a short one, in samples: the dampers' pressures settle within milliseconds.
const BESIDE_SHORT: (usize, usize) = (2, 6);
/// Pressures that do not count after a long gap, or after an edge whose time is not known, s: three times the slowest valve.
const AFTER_LONG_S: f64 = 0.3;

/// The number of whole samples in a time.
pub fn samples_in(time_s: f64, period_s: f64) -> usize {
    // A time that is a multiple of the period is not to lose a sample by rounding.
    (time_s / period_s + 1e-6) as usize
}

/// A strut's samples without gaps in what drives the model.
#[derive(Debug, Clone)]
pub struct Bridged {
    /// Displacement, m, from the first reading to the cut; NaN where there is none.
    pub displacement_m: Vec<f64>,
    /// Pressures, Pa; NaN where they do not count.
    pub pressure_pa: [Vec<f64>; 4],
    /// Switching signals; where one is missing, as they were before.
    pub valves: Vec<StrutValves<bool>>,
    /// Samples without a command during which valves were switched.
    pub switched_unseen: Vec<Range<usize>>,
    /// Index of the first sample in the drive.
    pub from: usize,
    /// Number of displacements that are missing.
    pub missing: usize,
    /// Number of commands that are missing.
    pub without_command: usize,
    /// The sample at which the drive was cut, where it was.
    pub cut_at: Option<usize>,
}

/// Bridges what is missing between samples a time `period_s` apart; `None` of a drive without a displacement.
#[must_use]
pub fn bridge(samples: &StrutSamples, period_s: f64) -> Option<Bridged> {
    let in_samples = |time_s| samples_in(time_s, period_s);
    let (longest_bridge, short_gap, after_long) = (
        in_samples(LONGEST_BRIDGE_S),
        in_samples(SHORT_GAP_S),
        in_samples(AFTER_LONG_S),
    );
    let x = &samples.displacement_m;
    let from = x.iter().position(|v| v.is_finite())?;
    let last = x.iter().rposition(|v| v.is_finite())? + 1;
    let gaps = gaps(from, last, |k| x[k].is_finite());
    // Before the first command all valves are closed, however long that takes.
    let first_command = samples.valves.iter().position(Option::is_some).unwrap_or(last);
    let silences = self::gaps(first_command.max(from), last, |k| samples.valves[k].is_some());
    let long = |gap: &&(usize, usize)| gap.1 - gap.0 > longest_bridge;
    let cut_at = (gaps.iter().find(long).into_iter().chain(silences.iter().find(long)))
        .map(|gap| gap.0)
        .min();
    let to = cut_at.unwrap_or(last);
    let mut pressure_pa = samples.pressure_pa.each_ref().map(|p| p[from..to].to_vec());
    let mut uncounted = |start: usize, end: usize| {
        for p in &mut pressure_pa {
            p[start.max(from) - from..end.min(to) - from].fill(f64::NAN);
        }
    };
    let mut missing = 0;
    for &(start, end) in gaps.iter().filter(|gap| gap.1 <= to) {
        missing += end - start;
        let after = if end - start <= short_gap {
            BESIDE_SHORT.1
        } else {
            after_long
        };
        uncounted(start.saturating_sub(BESIDE_SHORT.0), end + after);
    }
    let mut valves: Vec<StrutValves<bool>> = Vec::with_capacity(to - from);
    let mut held = StrutValves::default();
    for signal in &samples.valves[from..to] {
        held = signal.unwrap_or(held);
        valves.push(held);
    }
    let mut switched_unseen = Vec::new();
    let mut without_command = first_command.clamp(from, to) - from;
    for &(start, end) in silences.iter().filter(|gap| gap.1 <= to) {
        without_command += end - start;
        let known = |k: usize| samples.valves.get(k).copied().flatten();
        if start.checked_sub(1).and_then(known) != known(end) {
            uncounted(start, end + after_long);
            switched_unseen.push(start - from..end - from);
        }
    }
    Some(Bridged {
        displacement_m: x[from..to].to_vec(),
        pressure_pa,
        valves,
        switched_unseen,
        from,
        missing,
        without_command,
        cut_at,
    })
}

/// Stretches `start..end` within `from..to` in which nothing is known.
fn gaps(from: usize, to: usize, known: impl Fn(usize) -> bool) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut k = from;
    while k < to {
        let start = k;
        while k < to && !known(k) {
            k += 1;
        }
        if k > start {
            found.push((start, k));
        }
        k += 1;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_interface::tick::TICK_S;

    /// Most missing readings in a row that are bridged.
    const MOST: usize = 20;

    fn samples(n: usize) -> StrutSamples {
        StrutSamples {
            displacement_m: (0..n).map(|k| 0.03 * libm::sin(0.03 * k as f64)).collect(),
            pressure_pa: std::array::from_fn(|_| vec![4e6; n]),
            valves: vec![Some(StrutValves::default()); n],
        }
    }

    #[test]
    fn the_pressures_about_a_lost_displacement_do_not_count() {
        let mut s = samples(400);
        for k in [100, 200, 201, 390] {
            s.displacement_m[k] = f64::NAN;
        }
        let b = bridge(&s, TICK_S).expect("a drive");
        assert_eq!((b.missing, b.cut_at, b.displacement_m.len()), (4, None, 400));
        assert!(b.pressure_pa[0][98..107].iter().all(|p| p.is_nan()));
        assert!(b.pressure_pa[0][107].is_finite() && b.pressure_pa[0][97].is_finite());
    }

    #[test]
    fn a_long_gap_cuts_the_drive() {
        let mut s = samples(400);
        s.displacement_m[150..150 + MOST].fill(f64::NAN);
        s.displacement_m[250..251 + MOST].fill(f64::NAN);
        let b = bridge(&s, TICK_S).expect("a drive");
        assert_eq!((b.cut_at, b.displacement_m.len(), b.missing), (Some(250), 250, MOST));
    }

    #[test]
    fn an_edge_whose_time_is_not_known_does_not_count() {
        let open = StrutValves::new(true, true, false);
        let mut s = samples(400);
        s.valves[200..].fill(Some(open));
        // One command is lost in the middle of nothing, another where the valves are switched.
        s.valves[50] = None;
        s.valves[200] = None;
        let b = bridge(&s, TICK_S).expect("a drive");
        assert_eq!(b.without_command, 2);
        assert!(b.pressure_pa[0][50].is_finite() && b.pressure_pa[0][200].is_nan() && b.pressure_pa[0][260].is_nan());
        assert!(b.pressure_pa[0][262].is_finite());
        assert!(b.switched_unseen.len() == 1 && b.switched_unseen[0] == (200..201));
        // Before the first command the valves are closed.
        s.valves[..60].fill(None);
        let b = bridge(&s, TICK_S).expect("a drive");
        assert_eq!(
            (b.valves[0], b.cut_at, b.without_command),
            (StrutValves::default(), None, 61)
        );
    }

    #[test]
    fn nothing_is_made_of_nothing() {
        let mut s = samples(30);
        s.displacement_m.fill(f64::NAN);
        assert!(bridge(&s, TICK_S).is_none() && bridge(&StrutSamples::default(), TICK_S).is_none());
        s.displacement_m[7] = 0.01;
        assert_eq!(bridge(&s, TICK_S).expect("one").displacement_m, [0.01]);
    }
}
