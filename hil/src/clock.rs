//! Real time: absolute deadlines, and statistics of how well they were met.
//!
//! Deadline `n` is the start plus `n` periods, whatever happened before, so that lateness does not add up. The lateness of every
//! wake-up is kept. A tick that begins after the next one was due is an overrun. The summary gives the median, the 99th
//! percentile and the worst lateness.

use std::time::{Duration, Instant};

/// Wakes a node at even intervals of wall-clock time.
#[derive(Debug)]
pub struct RealTime {
    start: Instant,
    period: Duration,
    late_us: Vec<u32>,
    overruns: u64,
}

impl RealTime {
    /// A clock whose deadline 0 is `start`, with memory for `ticks` ticks.
    pub fn new(start: Instant, period: Duration, ticks: usize) -> Self {
        Self {
            start,
            period,
            late_us: Vec::with_capacity(ticks),
            overruns: 0,
        }
    }

    /// The time at which tick `n` is due.
    pub fn deadline(&self, tick: u32) -> Instant {
        self.start + self.period * tick
    }

    /// Sleeps until tick `n` is due, and notes how late the wake-up was.
    pub fn wait(&mut self, tick: u32) {
        let deadline = self.deadline(tick);
        let left = deadline.saturating_duration_since(Instant::now());
        if !left.is_zero() {
            std::thread::sleep(left);
        }
        self.note(Instant::now().saturating_duration_since(deadline));
    }

    fn note(&mut self, late: Duration) {
        self.overruns += u64::from(late >= self.period);
        self.late_us.push(u32::try_from(late.as_micros()).unwrap_or(u32::MAX));
    }

    /// Statistics of the lateness so far.
    pub fn lateness(&self) -> Lateness {
        Lateness::of(&self.late_us, self.overruns)
    }
}

/// Statistics of how late the node woke up.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Lateness {
    /// Number of ticks that were measured.
    pub ticks: u64,
    /// Number of ticks that began after the next one was due.
    pub overruns: u64,
    /// Median of the lateness, microseconds.
    pub p50_us: u32,
    /// 99th percentile of the lateness, microseconds.
    pub p99_us: u32,
    /// Largest lateness, microseconds.
    pub max_us: u32,
    /// Number of wake-ups by lateness: the upper limit of each class in microseconds (the last one has none), and its count.
    pub histogram: Vec<(u32, u64)>,
}

/// Upper limits of the histogram's classes, microseconds.
const CLASSES_US: [u32; 13] = [
    10,
    20,
    50,
    100,
    200,
    500,
    1_000,
    2_000,
    5_000,
    10_000,
    20_000,
    50_000,
    u32::MAX,
];

impl Lateness {
    fn of(late_us: &[u32], overruns: u64) -> Self {
        let mut sorted = late_us.to_vec();
        sorted.sort_unstable();
        // By nearest rank.
        let percentile = |percent: usize| {
            let rank = (sorted.len() * percent).div_ceil(100).max(1);
            sorted.get(rank - 1).copied().unwrap_or(0)
        };
        let mut from = 0;
        let histogram = CLASSES_US.map(|limit| {
            let until = sorted.partition_point(|late| *late < limit || limit == u32::MAX);
            (limit, (until - std::mem::replace(&mut from, until)) as u64)
        });
        Self {
            ticks: sorted.len() as u64,
            overruns,
            p50_us: percentile(50),
            p99_us: percentile(99),
            max_us: sorted.last().copied().unwrap_or(0),
            histogram: histogram.to_vec(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_by_nearest_rank() {
        let lateness = Lateness::of(&(1..=200).rev().collect::<Vec<u32>>(), 3);
        assert_eq!((lateness.p50_us, lateness.p99_us, lateness.max_us), (100, 198, 200));
        assert_eq!((lateness.ticks, lateness.overruns), (200, 3));
        assert_eq!(lateness.histogram[..4], [(10, 9), (20, 10), (50, 30), (100, 50)]);
        assert_eq!(lateness.histogram.iter().map(|class| class.1).sum::<u64>(), 200);
        assert_eq!(Lateness::of(&[], 0).max_us, 0);
    }

    #[test]
    fn a_wait_never_ends_early_and_a_missed_tick_is_an_overrun() {
        let mut clock = RealTime::new(Instant::now(), Duration::from_millis(2), 8);
        for tick in 0..5 {
            clock.wait(tick);
            assert!(Instant::now() >= clock.deadline(tick));
        }
        let before = clock.lateness().overruns;
        clock.note(Duration::from_millis(7));
        assert_eq!(clock.lateness().overruns, before + 1);
        assert!(clock.lateness().max_us >= 7000);
    }
}
