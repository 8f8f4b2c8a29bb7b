//! What the recordings of a strut excite.

use crate::recording::Recording;
use crate::vocabulary::Branch;

/// Effects on a flow need a pressure drop of this size to be seen, Pa.
const LEAST_DROP_PA: f64 = 1e5;

/// A displacement or a pressure difference of this many times the noise is more than noise.
const BEYOND_NOISE: f64 = 10.0;
/// The displacement's noise is taken to be at least this, m: a recording of a perfect sensor may still be rounded.
const LEAST_NOISE_M: f64 = 1e-6;

/// Where the columns of a recording of a strut are; the displacement is the first.
#[derive(Debug, Clone, Copy)]
pub struct StrutColumns {
    /// Force and p1 to p4, where they are recorded.
    pub channels: [Option<usize>; 5],
    /// The first of the three switching signals.
    pub valves: usize,
}

/// Extremes and events over all recordings of a strut.
#[derive(Debug, Clone, Default)]
pub struct Strut {
    /// Smallest and largest displacement in all recordings, m.
    pub displacement_m: (f64, f64),
    /// Largest departure from the first value of each channel: force, N, and p1 to p4, Pa.
    pub departure: [f64; 5],
    /// Switching edges of each valve.
    pub edges: [usize; 3],
    /// Time with valve 3 closed and p3 apart from p4 by more than ten times the noise, s.
    pub valve3_holding_s: f64,
    /// Largest pressure drops p1-p2, p1-p3, Pa.
    pub drop_pa: [f64; 2],
    /// Duration of the longest recording, s.
    pub duration_s: f64,
    /// Shortest sampling interval, s.
    pub interval_s: f64,
    /// Does anything move at all?
    pub moves: bool,
}

impl Strut {
    /// What either shows: the recordings, or what the believed model makes of the same motion. An effect can remove the very
    /// drop or difference by which one would tell that it was excited: through a gross leak p3 and p4 are never apart.
    #[must_use]
    pub fn of_measured_or_believed(mut measured: Self, believed: &Self) -> Self {
        measured.valve3_holding_s = measured.valve3_holding_s.max(believed.valve3_holding_s);
        for (drop, other) in measured.drop_pa.iter_mut().zip(believed.drop_pa) {
            *drop = drop.max(other);
        }
        measured
    }

    /// Goes through all recordings once. What is not recorded departs from nothing and has no drop. `pressure_noise` is the larger
    /// of the standard deviations of p3 and p4, Pa; `displacement_noise` is that of the displacement, m.
    #[must_use]
    pub fn of(recordings: &[Recording], columns: &StrutColumns, pressure_noise: f64, displacement_noise: f64) -> Self {
        let mut e = Self {
            interval_s: f64::INFINITY,
            displacement_m: (f64::MAX, f64::MIN),
            ..Self::default()
        };
        for r in recordings {
            let first = r.columns[0][0];
            for &x in &r.columns[0] {
                e.displacement_m = (e.displacement_m.0.min(x), e.displacement_m.1.max(x));
                e.moves |= (x - first).abs() > BEYOND_NOISE * displacement_noise.max(LEAST_NOISE_M);
            }
            for (column, departure) in columns.channels.iter().zip(e.departure.iter_mut()) {
                let Some(series) = column.map(|column| &r.columns[column]) else {
                    continue;
                };
                let rest = series.iter().copied().find(|v| v.is_finite()).unwrap_or(0.0);
                *departure = series.iter().fold(*departure, |m, v| m.max((v - rest).abs()));
            }
            for (edges, signal) in e.edges.iter_mut().zip(&r.columns[columns.valves..]) {
                *edges += signal.windows(2).filter(|w| w[0] != w[1]).count();
            }
            let interval = r.interval_s();
            let apart = BEYOND_NOISE * pressure_noise;
            for k in 0..r.len() {
                let p = |number: usize| columns.channels[number].map_or(f64::NAN, |column| r.columns[column][k]);
                e.drop_pa[0] = e.drop_pa[0].max((p(1) - p(2)).abs());
                e.drop_pa[1] = e.drop_pa[1].max((p(1) - p(3)).abs());
                if r.columns[columns.valves + 2][k] < 0.5 && (p(3) - p(4)).abs() > apart {
                    e.valve3_holding_s += interval;
                }
            }
            e.duration_s = e.duration_s.max(r.time_s[r.len() - 1] - r.time_s[0]);
            e.interval_s = e.interval_s.min(interval);
        }
        e
    }

    /// Why nothing can be tested, where the strut does not move.
    #[must_use]
    pub fn still(&self) -> Option<String> {
        (!self.moves).then(|| "the strut does not move; record strokes of at least 10 mm".to_owned())
    }

    /// Why the timing of the valves cannot be tested, where none is switched.
    #[must_use]
    pub fn no_edges(&self) -> Option<String> {
        let switched = self.edges.iter().any(|&n| n > 0);
        (!switched).then(|| "no valve is switched; record steps at several pressure differences".to_owned())
    }

    /// Why what acts on the flow in a path cannot be tested, where its damper has no drop.
    #[must_use]
    pub fn no_drop(&self, branch: Branch) -> Option<String> {
        let path = branch.number();
        (self.drop_pa[path - 1] < LEAST_DROP_PA).then(|| {
            format!(
                "the drop across damper {path} never reaches {} MPa; record sines above 0.2 m/s with valve {path} closed",
                LEAST_DROP_PA / 1e6
            )
        })
    }

    /// Recordings in which everything is excited.
    #[cfg(test)]
    pub fn of_everything() -> Self {
        Self {
            displacement_m: (-0.06, 0.07),
            departure: [5e3, 3e6, 3e6, 3e6, 3e6],
            edges: [4; 3],
            valve3_holding_s: 10.0,
            drop_pa: [1e6; 2],
            duration_s: 20.0,
            interval_s: 0.002,
            moves: true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_an_effect_removes_is_still_excited_where_the_believed_model_has_it() {
        let through_a_leak = Strut {
            valve3_holding_s: 0.0,
            drop_pa: [2e4, 3e5],
            ..Strut::of_everything()
        };
        let either = Strut::of_measured_or_believed(through_a_leak, &Strut::of_everything());
        assert_eq!((either.valve3_holding_s, either.drop_pa), (10.0, [1e6; 2]));
        assert!(either.no_drop(Branch::First).is_none());
    }
}
