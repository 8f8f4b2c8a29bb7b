//! Relations between measured neighbours of a strut, tested without simulation, and when they can be tested.

use oleo_interface::Valve;
use oleo_plant_sim::strut::Inputs;

use super::channels::{FORCE, Layout, P1, P2, P3, P4};
use crate::recording::Recording;
use crate::specimen::channel::Channel;
use crate::specimen::relation::MeasuredRelation;

/// A valve or a pressure has settled after this time, s: three times the slowest valve of the report.
const SETTLED_S: f64 = 0.3;
/// Slower than this nothing moves, m/s.
const REST_M_S: f64 = 0.001;
/// Time over which pressures must not change to be called steady, s.
const STEADY_S: f64 = 0.3;
/// Change, in units of noise, up to which a pressure has not changed.
const STEADY_NOISE: f64 = 4.0;

/// The recordings of a strut with what is needed to say what holds at a sample.
pub struct Measured<'a> {
    recordings: &'a [Recording],
    inputs: &'a [Inputs],
    layout: Layout,
    channels: &'a [Channel],
    piston_area_m2: f64,
    /// Samples of each recording after which a valve or a pressure has settled.
    settled: Vec<usize>,
}

impl<'a> Measured<'a> {
    /// Recordings with their inputs and channels.
    pub fn new(
        recordings: &'a [Recording],
        inputs: &'a [Inputs],
        layout: Layout,
        channels: &'a [Channel],
        piston_area_m2: f64,
    ) -> Self {
        let settled = |r: &Recording| (SETTLED_S / r.interval_s().max(1e-6)).ceil() as usize;
        Self {
            settled: recordings.iter().map(settled).collect(),
            recordings,
            inputs,
            layout,
            channels,
            piston_area_m2,
        }
    }

    /// Every relation, tested on all samples that can test it.
    pub fn relations(&self) -> Vec<MeasuredRelation> {
        let noise = |c: usize| self.noise(c);
        let area = self.piston_area_m2;
        let difference = |a: usize, b: usize| (noise(a) * noise(a) + noise(b) * noise(b)).sqrt();
        let m = |r: usize, c: usize, k: usize| self.recordings[r].columns[self.layout.column(c)][k];
        // At rest: nothing moves, and no oil flows from one accumulator to the other after a valve has opened.
        let rest = |r: usize, k: usize| self.is_quiet(r, k) && self.is_steady(r, k);
        let open = |r: usize, k: usize, valve: Valve| self.is_held(r, k, valve, true);
        let force_balance = (self.layout.has(FORCE) && self.layout.has(P1)).then(|| {
            let force_noise = (noise(FORCE) * noise(FORCE) + area * area * noise(P1) * noise(P1)).sqrt();
            self.tested("force balance: force - A p1", force_noise, |r, k| {
                Some(m(r, FORCE, k) - area * m(r, P1, k))
            })
        });
        let both = |a: usize, b: usize| self.layout.has(a) && self.layout.has(b);
        let valve_3 = both(P1, P3).then(|| {
            self.tested("closed valve 3: p3 = p1", difference(P1, P3), |r, k| {
                (self.is_held(r, k, Valve::Spring, false)).then(|| m(r, P1, k) - m(r, P3, k))
            })
        });
        let path_1 = both(P1, P2).then(|| {
            self.tested(
                "path 1 at rest and settled, valve 1 open: p1 = p2",
                difference(P1, P2),
                |r, k| (rest(r, k) && open(r, k, Valve::Bypass1)).then(|| m(r, P1, k) - m(r, P2, k)),
            )
        });
        let path_2 = both(P1, P4).then(|| {
            self.tested(
                "path 2 at rest and settled, valves 2 and 3 open: p1 = p4",
                difference(P1, P4),
                |r, k| {
                    (rest(r, k) && open(r, k, Valve::Bypass2) && open(r, k, Valve::Spring))
                        .then(|| m(r, P1, k) - m(r, P4, k))
                },
            )
        });
        [force_balance, valve_3, path_1, path_2].into_iter().flatten().collect()
    }

    /// Noise of a recorded channel of [`CHANNELS`](super::CHANNELS), in the unit of its column.
    fn noise(&self, channel: usize) -> f64 {
        self.channels[self.layout.channel(channel)].noise
    }

    /// What the valves were at a sample: "valve 1 open", for each that has settled.
    pub fn settings(&self, recording: usize, sample: usize) -> Vec<String> {
        (Valve::ALL.into_iter())
            .filter_map(|valve| {
                let open = self.is_held(recording, sample, valve, true);
                let closed = self.is_held(recording, sample, valve, false);
                (open || closed)
                    .then(|| format!("valve {} {}", valve.index() + 1, if open { "open" } else { "closed" }))
            })
            .collect()
    }

    fn tested(&self, name: &'static str, noise: f64, misfit: impl Fn(usize, usize) -> Option<f64>) -> MeasuredRelation {
        let misfit = &misfit;
        let values: Vec<f64> = (self.recordings.iter().enumerate())
            .flat_map(|(r, recording)| (0..recording.len()).filter_map(move |k| misfit(r, k).filter(|v| v.is_finite())))
            .collect();
        MeasuredRelation::tested(name, noise, &values)
    }

    /// True if a valve has been signalled open, or closed, for long enough to have settled.
    fn is_held(&self, recording: usize, sample: usize, valve: Valve, open: bool) -> bool {
        let from = sample.saturating_sub(self.settled[recording]);
        (self.inputs[recording].signals[from..=sample].iter()).all(|s| s[valve] == open)
    }

    /// True if nothing has moved for long enough that pressures have settled.
    fn is_quiet(&self, recording: usize, sample: usize) -> bool {
        let back = self.settled[recording];
        let segments = &self.inputs[recording].motion.segments;
        sample >= back && (segments[sample - back..sample].iter()).all(|s| s.to_m_s.abs() < REST_M_S)
    }

    /// True if neither accumulator's pressure has changed over a while.
    fn is_steady(&self, recording: usize, sample: usize) -> bool {
        let r = &self.recordings[recording];
        let interval = (r.time_s[r.len() - 1] - r.time_s[0]) / r.len() as f64;
        let Some(before) = sample.checked_sub((STEADY_S / interval.max(1e-6)).ceil() as usize) else {
            return false;
        };
        [P2, P4].iter().filter(|&&c| self.layout.has(c)).all(|&c| {
            let p = &r.columns[self.layout.column(c)];
            (p[sample] - p[before]).abs() < STEADY_NOISE * self.noise(c)
        })
    }
}
