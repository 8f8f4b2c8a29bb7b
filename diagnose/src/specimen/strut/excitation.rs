//! What the recordings excite, so that effects they cannot show are listed as not tested instead of absent.

use crate::recording::Recording;
use crate::specimen::channel::Channel;

/// Extremes and events over all recordings of a strut.
#[derive(Debug, Clone, Default)]
pub struct Excitation {
    /// Displacement range, m.
    pub displacement_m: (f64, f64),
    /// Largest departure from the first value per channel (`specimen::strut::CHANNELS`).
    pub departure: [f64; 5],
    /// Switching edges of each valve.
    pub edges: [usize; 3],
    /// Time with valve 3 closed and p3 apart from p4 by more than ten times the noise, s.
    pub valve3_holding_s: f64,
    /// Largest pressure drops p1-p2, p1-p3, Pa.
    pub drop_pa: [f64; 2],
    /// Longest recording, s.
    pub duration_s: f64,
    /// Shortest sampling interval, s.
    pub interval_s: f64,
    /// Does anything move at all?
    pub moves: bool,
}

impl Excitation {
    /// Goes through all recordings once.
    #[must_use]
    pub fn of(recordings: &[Recording], channels: &[Channel], displacement_noise: f64) -> Self {
        let mut e = Self {
            interval_s: f64::INFINITY,
            displacement_m: (f64::MAX, f64::MIN),
            ..Self::default()
        };
        for r in recordings {
            let first = r.columns[0][0];
            for &x in &r.columns[0] {
                e.displacement_m = (e.displacement_m.0.min(x), e.displacement_m.1.max(x));
                e.moves |= (x - first).abs() > 10.0 * displacement_noise.max(1e-6);
            }
            for c in 0..5 {
                let rest = r.columns[1 + c][0];
                e.departure[c] = r.columns[1 + c]
                    .iter()
                    .fold(e.departure[c], |m, v| m.max((v - rest).abs()));
            }
            for v in 0..3 {
                e.edges[v] += r.columns[6 + v].windows(2).filter(|w| w[0] != w[1]).count();
            }
            let interval = r.interval_s();
            let apart = 10.0 * channels[3].noise.max(channels[4].noise);
            for k in 0..r.len() {
                let p = |c: usize| r.columns[1 + c][k];
                e.drop_pa[0] = e.drop_pa[0].max((p(1) - p(2)).abs());
                e.drop_pa[1] = e.drop_pa[1].max((p(1) - p(3)).abs());
                if r.columns[8][k] < 0.5 && (p(3) - p(4)).abs() > apart {
                    e.valve3_holding_s += interval;
                }
            }
            e.duration_s = e.duration_s.max(r.time_s[r.len() - 1] - r.time_s[0]);
            e.interval_s = e.interval_s.min(interval);
        }
        e
    }
}
