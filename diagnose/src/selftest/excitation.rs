//! The moves of a test rig: the kinds that the report's rig and the labelled recordings make, each campaign with its own
//! strokes, speeds, frequencies and switching times, at about a quarter of their length.

use std::sync::Arc;

use oleo_interface::StrutValves;
use oleo_plant_sim::strut::{Inputs, Motion, Segment};

use super::draw::Draw;

type Function<T> = Arc<dyn Fn(f64) -> T + Send + Sync>;

/// One move: true motion and switching signals over time.
#[derive(Clone)]
pub struct Move {
    /// Name of its recording.
    pub name: &'static str,
    /// Sampling interval of the recording, s.
    pub interval_s: f64,
    /// Duration of the recording, s.
    pub duration_s: f64,
    position_m: Function<f64>,
    signals: Function<[bool; 3]>,
}

/// Distance over which one-sided speeds are taken, s.
const NEAR_S: f64 = 1e-7;

impl Move {
    /// Samples of its recording.
    #[must_use]
    pub fn samples(&self) -> usize {
        (self.duration_s / self.interval_s).round() as usize + 1
    }

    /// Its inputs without measurement error, on a grid `refinement` times finer than the recording. Edges of the switching
    /// signals fall on the recording's samples.
    #[must_use]
    pub fn inputs(&self, refinement: usize) -> Inputs {
        let n = (self.samples() - 1) * refinement + 1;
        let step = self.interval_s / refinement as f64;
        let time_s: Vec<f64> = (0..n).map(|k| k as f64 * step).collect();
        let x = &self.position_m;
        let segments = time_s
            .windows(2)
            .map(|w| Segment {
                to_m: x(w[1]),
                from_m_s: (x(w[0] + NEAR_S) - x(w[0])) / NEAR_S,
                to_m_s: (x(w[1]) - x(w[1] - NEAR_S)) / NEAR_S,
            })
            .collect();
        let signals = (0..n)
            .map(|k| StrutValves::from_array((self.signals)((k / refinement) as f64 * self.interval_s)))
            .collect();
        Inputs {
            motion: Motion {
                start_m: x(0.0),
                segments,
            },
            signals,
            time_s,
        }
    }
}

/// Straight lines through (time, position), level outside, as an actuator of limited acceleration follows them: the mean
/// over a window of time, so that a jump of speed takes that long.
fn rounded(points: Vec<(f64, f64)>, window_s: f64) -> Function<f64> {
    // Antiderivative at the points, from the first on.
    let mut area = vec![0.0];
    for w in points.windows(2) {
        area.push(area[area.len() - 1] + 0.5 * (w[0].1 + w[1].1) * (w[1].0 - w[0].0));
    }
    let antiderivative = move |t: f64| {
        let k = points.partition_point(|p| p.0 <= t);
        if k == 0 {
            return (t - points[0].0) * points[0].1;
        }
        let (t0, x0) = points[k - 1];
        let slope = points.get(k).map_or(0.0, |p| (p.1 - x0) / (p.0 - t0));
        area[k - 1] + (t - t0) * (x0 + 0.5 * slope * (t - t0))
    };
    Arc::new(move |t| (antiderivative(t + 0.5 * window_s) - antiderivative(t - 0.5 * window_s)) / window_s)
}

/// Goes through positions at one speed, resting `rest_s` at each.
fn tour(positions: &[f64], speed_m_s: f64, rest_s: f64) -> Vec<(f64, f64)> {
    let (mut t, mut x) = (0.4, 0.0);
    let mut points = vec![(0.0, 0.0), (t, 0.0)];
    for &to in positions {
        t += (to - x).abs() / speed_m_s;
        points.push((t, to));
        if rest_s > 0.0 {
            t += rest_s;
            points.push((t, to));
        }
        x = to;
    }
    points
}

/// A tour with rounded corners and its duration.
fn driven(points: Vec<(f64, f64)>, window_s: f64) -> (Function<f64>, f64) {
    let end = points.last().map_or(0.0, |p| p.0) + window_s;
    (rounded(points, window_s), end)
}

/// A signal that changes at drawn times on average every `mean_s`.
fn toggling(draw: &mut Draw, first: bool, mean_s: f64, duration_s: f64) -> Function<bool> {
    let mut edges = vec![];
    let mut t = draw.between(0.3, 0.3 + mean_s);
    while t < duration_s {
        edges.push(t);
        t += draw.between(0.3, 1.7) * mean_s;
    }
    Arc::new(move |t| first ^ (edges.partition_point(|e| *e <= t) % 2 == 1))
}

fn held(open: [bool; 3]) -> Function<[bool; 3]> {
    Arc::new(move |_| open)
}

/// Sines of a stroke, faster from burst to burst, with whole cycles and a smooth beginning and end of each burst.
fn bursts(draw: &mut Draw, stroke_m: f64) -> (Function<f64>, f64) {
    let mut list = Vec::new();
    let mut t = 0.3;
    for (frequency, cycles) in [(1.0, 1.0), (2.8, 2.0), (4.4, 2.0), (6.0, 3.0)] {
        let f = frequency * draw.between(0.85, 1.15);
        list.push((t, f, cycles));
        t += cycles / f + 0.1;
    }
    let x = move |t: f64| {
        let k = list.partition_point(|b| b.0 <= t);
        let Some(&(begin, f, cycles)) = k.checked_sub(1).and_then(|k| list.get(k)) else {
            return 0.0;
        };
        let (s, length) = (t - begin, cycles / f);
        if s >= length {
            return 0.0;
        }
        let ends = (4.0 * s * f).min(4.0 * (length - s) * f).min(1.0);
        let smooth = ends * ends * (3.0 - 2.0 * ends);
        stroke_m * smooth * libm::sin(std::f64::consts::TAU * f * s)
    };
    (Arc::new(x), t + 0.2)
}

/// A road: sines whose amplitude falls with frequency, with drawn phases, from rest.
fn road(draw: &mut Draw, amplitude_m: f64) -> Function<f64> {
    let waves: Vec<(f64, f64, f64)> = (0..10)
        .map(|k| {
            let f = (0.6 + 0.55 * f64::from(k)) * draw.between(0.9, 1.1);
            (
                amplitude_m / (1.0 + 1.2 * f64::from(k)),
                f,
                draw.between(0.0, std::f64::consts::TAU),
            )
        })
        .collect();
    Arc::new(move |t| {
        let begin = (t / 0.4).min(1.0);
        let smooth = begin * begin * (3.0 - 2.0 * begin);
        let angle = |f: f64, phase: f64| libm::sin(std::f64::consts::TAU * f * t + phase);
        smooth * waves.iter().map(|&(a, f, phase)| a * angle(f, phase)).sum::<f64>()
    })
}

/// The ten moves of a campaign.
#[must_use]
pub fn moves(draw: &mut Draw) -> Vec<Move> {
    let mut all = Vec::new();
    let mut add = |name, interval_s: f64, (position_m, duration_s): (Function<f64>, f64), signals| {
        all.push(Move {
            name,
            interval_s,
            duration_s: (duration_s / interval_s).ceil() * interval_s,
            position_m,
            signals,
        });
    };
    let (a, v) = (draw.between(0.085, 0.1), draw.between(0.006, 0.009));
    add(
        "sawtooth_soft",
        0.05,
        driven(tour(&[a, -a, 0.0], v, 0.0), 0.1),
        held([true; 3]),
    );
    let (up, down, v) = (
        draw.between(0.03, 0.036),
        draw.between(0.07, 0.09),
        draw.between(0.005, 0.007),
    );
    add(
        "sawtooth_stiff",
        0.05,
        driven(tour(&[up, -down, 0.0], v, 0.0), 0.1),
        held([true, true, false]),
    );
    let (a, b, c) = (
        draw.between(0.04, 0.06),
        draw.between(0.04, 0.06),
        draw.between(0.06, 0.085),
    );
    let (v, rest) = (draw.between(0.4, 0.6), draw.between(6.0, 9.0));
    add(
        "slow_hold",
        0.02,
        driven(tour(&[a, -b, c, 0.0], v, rest), 0.1),
        held([true; 3]),
    );
    for (name, open) in [
        ("sine_low_soft", [true; 3]),
        ("sine_high_stiff", [false, true, false]),
        ("sine_high_soft", [false, false, true]),
    ] {
        add(name, 0.002, bursts(draw, 0.025), held(open));
    }
    let slow = draw.between(0.15, 0.25);
    let fast = draw.between(0.5, 0.75);
    let stroke = draw.between(0.045, 0.052);
    let mut points = tour(&[-stroke, stroke, -stroke, 0.0], slow, 0.0);
    let half = points[points.len() - 1].0;
    points.extend(
        (tour(&[-stroke, stroke, -stroke, stroke, 0.0], fast, 0.15)
            .iter()
            .skip(1))
        .map(|(t, x)| (half + t, *x)),
    );
    let motion = driven(points, 0.02);
    let duration = motion.1;
    let toggle = toggling(draw, true, 0.35, duration);
    let together: Function<[bool; 3]> = Arc::new(move |t| [toggle(t), toggle(t), true]);
    add("damper_steps", 0.002, motion, together);
    // Valve 3 shuts at rest, the strut moves and holds, valve 3 opens against what has built up, the strut returns.
    let (mut points, mut edges, mut t) = (vec![(0.0, 0.0)], Vec::new(), 0.5);
    for hold in [
        draw.between(0.006, 0.012),
        draw.between(0.022, 0.03),
        -draw.between(0.03, 0.05),
    ] {
        edges.push(t);
        points.extend([(t + 0.3, 0.0), (t + 0.6, hold), (t + 1.7, hold), (t + 1.9, 0.0)]);
        edges.push(t + 1.1);
        t += 2.3;
    }
    let shut: Function<[bool; 3]> = Arc::new(move |t| [true, true, edges.partition_point(|e| *e <= t) % 2 == 0]);
    add("valve3_steps", 0.004, (rounded(points, 0.02), t), shut);
    let duration = 3.6;
    let valves: Vec<Function<bool>> = (0..3).map(|_| toggling(draw, true, 0.6, duration)).collect();
    let all_three: Function<[bool; 3]> = Arc::new(move |t| [valves[0](t), valves[1](t), valves[2](t)]);
    add("road_switching", 0.002, (road(draw, 0.014), duration), all_three);
    let valves: Vec<Function<bool>> = (0..2).map(|_| toggling(draw, true, 0.6, duration)).collect();
    let dampers: Function<[bool; 3]> = Arc::new(move |t| [valves[0](t), valves[1](t), false]);
    add("road_stiff", 0.002, (road(draw, 0.010), duration), dampers);
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_interface::Valve;

    #[test]
    fn every_move_starts_at_rest_and_stays_within_the_travel() {
        for seed in 0..5 {
            for m in moves(&mut Draw::named(&format!("{seed}"))) {
                let inputs = m.inputs(1);
                let n = m.samples();
                assert_eq!(
                    (inputs.time_s.len(), inputs.motion.segments.len()),
                    (n, n - 1),
                    "{}",
                    m.name
                );
                let first = inputs.motion.segments[0];
                assert!(
                    inputs.motion.start_m == 0.0 && first.from_m_s.abs() < 1e-3,
                    "{} {first:?}",
                    m.name
                );
                for s in &inputs.motion.segments {
                    assert!(s.to_m.abs() < 0.105 && s.to_m_s.abs() < 1.3, "{} {s:?}", m.name);
                }
            }
        }
    }

    #[test]
    fn a_finer_grid_is_the_same_move() {
        for m in moves(&mut Draw::named("fine")) {
            let (coarse, fine) = (m.inputs(1), m.inputs(5));
            for (k, s) in coarse.motion.segments.iter().enumerate() {
                assert!((s.to_m - fine.motion.segments[5 * k + 4].to_m).abs() < 1e-12);
                assert_eq!(coarse.signals[k], fine.signals[5 * k + 4]);
            }
        }
    }

    #[test]
    fn every_valve_is_switched() {
        let all = moves(&mut Draw::named("valves"));
        for valve in Valve::ALL {
            let edges: usize = (all.iter())
                .map(|m| {
                    let signals = m.inputs(1).signals;
                    signals.windows(2).filter(|w| w[0][valve] != w[1][valve]).count()
                })
                .sum();
            assert!(edges >= 8, "{valve:?}: {edges}");
        }
    }
}
