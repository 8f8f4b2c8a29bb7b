//! Times between frames, counted, so that their median needs no list of them.

use std::collections::BTreeMap;

/// Interval above which only the leading bits count, us. No period that is accepted is as long.
const EXACT_BELOW_US: u64 = 1 << 16;
/// Number of leading bits.
const BITS: u32 = 10;

/// The intervals between the frames of one reading.
#[derive(Default)]
pub struct Intervals {
    last_us: Option<u64>,
    /// Number of intervals of each length.
    counts: BTreeMap<u64, u64>,
    number: u64,
}

impl Intervals {
    /// A frame, not before the last.
    pub fn take(&mut self, time_us: u64) {
        if let Some(last_us) = self.last_us.replace(time_us) {
            *self
                .counts
                .entry(counted_as(time_us.saturating_sub(last_us)))
                .or_default() += 1;
            self.number += 1;
        }
    }

    /// Number of frames.
    pub fn frames(&self) -> u64 {
        self.number + u64::from(self.last_us.is_some())
    }

    /// Median of the intervals, us; `None` of fewer than two.
    pub fn median_us(&self) -> Option<f64> {
        let mut before = 0;
        let middle = self.counts.iter().find(|(_, count)| {
            before += **count;
            before > self.number / 2
        });
        middle
            .filter(|_| self.number >= 2)
            .map(|(interval, _)| *interval as f64)
    }
}

fn counted_as(interval_us: u64) -> u64 {
    if interval_us < EXACT_BELOW_US {
        return interval_us;
    }
    let left_out = interval_us.ilog2() - BITS;
    interval_us >> left_out << left_out
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_median_is_that_of_the_list(mut intervals in prop::collection::vec(prop_oneof![0..50_u64, 0..2_000_000_u64], 2..60)) {
            let (mut counted, mut now) = (Intervals::default(), 7);
            counted.take(now);
            for interval in &intervals {
                now += interval;
                counted.take(now);
            }
            intervals.sort_unstable();
            let median = intervals[intervals.len() / 2] as f64;
            let found = counted.median_us().expect("two intervals");
            let away = (found - median).abs();
            prop_assert!(away == 0.0 || median >= 65_536.0 && away < 1e-3 * median, "{} for {}", found, median);
        }
    }
}
