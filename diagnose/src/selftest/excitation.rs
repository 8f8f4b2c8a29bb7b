//! The recordings of a simulated campaign: the kinds of move that a test rig makes, each with its own seed.

use oleo_plant_sim::strut::{Inputs, Motion, Segment};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Uniform number in 0..1.
pub fn uniform(rng: &mut ChaCha8Rng) -> f64 {
    f64::from(rng.next_u32()) / 4_294_967_296.0
}

/// Standard normal number (Box & Muller, Ann. Math. Statist. 29(2), 1958).
pub fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let (u, v) = (uniform(rng).max(1e-12), uniform(rng));
    (-2.0 * libm::log(u)).sqrt() * libm::cos(2.0 * std::f64::consts::PI * v)
}

/// One move: its name, its true motion and switching signals.
pub struct Move {
    /// Name of the recording.
    pub name: &'static str,
    /// Inputs without measurement noise.
    pub inputs: Inputs,
}

/// The moves of a campaign.
#[must_use]
pub fn moves(seed: u64) -> Vec<Move> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut between = |a: f64, b: f64| a + (b - a) * uniform(&mut rng);
    let stroke = between(0.06, 0.09);
    let slow = between(0.004, 0.006);
    let (low, high) = (between(2.0, 3.0), between(4.0, 5.5));
    let held = between(0.05, 0.07);
    let phases: Vec<f64> = (0..12).map(|_| between(0.0, 6.28)).collect();
    let triangle = move |t: f64| {
        let quarter = stroke / slow;
        let s = (t / quarter) % 4.0;
        stroke * if s < 1.0 { s } else if s < 3.0 { 2.0 - s } else { s - 4.0 }
    };
    let stiff = move |t: f64| if triangle(t) > 0.0 { 0.4 * triangle(t) } else { triangle(t) };
    let ramp = |t: f64, at: f64, seconds: f64| ((t - at) / seconds).clamp(0.0, 1.0);
    let hold = move |t: f64| held * (ramp(t, 0.5, 0.1) - ramp(t, 15.0, 0.1) - 0.7 * ramp(t, 25.0, 0.1) + 0.7 * ramp(t, 38.0, 0.1));
    let sine = |f: f64| move |t: f64| 0.025 * ramp(t, 0.0, 0.5) * libm::sin(2.0 * std::f64::consts::PI * f * t);
    let road = move |t: f64| {
        (0..12).map(|k| 0.012 / f64::from(k + 1) * libm::sin(2.0 * (1.0 + f64::from(k) * 1.3) * t + phases[k as usize])
            - 0.012 / f64::from(k + 1) * libm::sin(phases[k as usize])).sum::<f64>() * ramp(t, 0.0, 0.3)
    };
    let steps = move |t: f64| 0.05 * ramp(t, 0.2, 0.08) - 0.1 * ramp(t, 4.2, 0.12) + 0.08 * ramp(t, 8.2, 0.1);
    let toggling = |period: f64, which: usize| move |t: f64| {
        let mut s = [true; 3];
        if which < 2 {
            s[0] = ((t + 0.13) / period) as u64 % 2 == 0;
            s[1] = ((t + 0.13) / period) as u64 % 3 != 1;
        } else {
            s[2] = ((t + 0.3) / period) as u64 % 2 == 0;
        }
        s
    };
    vec![
        one("sawtooth_soft", 0.02, 60.0, triangle, |_| [true; 3]),
        one("sawtooth_stiff", 0.02, 60.0, stiff, |_| [true, true, false]),
        one("slow_hold", 0.02, 50.0, hold, |_| [true; 3]),
        one("sine_low_soft", 0.002, 8.0, sine(low), |_| [true; 3]),
        one("sine_high_stiff", 0.002, 8.0, sine(high), |_| [false, true, false]),
        one("sine_high_soft", 0.002, 8.0, sine(high), |_| [false, false, true]),
        one("damper_steps", 0.002, 12.0, steps.clone(), toggling(0.5, 0)),
        one("valve3_steps", 0.002, 14.0, steps, toggling(1.3, 2)),
        one("road_switching", 0.002, 12.0, road.clone(), toggling(0.7, 0)),
        one("road_stiff", 0.002, 10.0, road, |_| [true, true, false]),
    ]
}

fn one(
    name: &'static str,
    interval_s: f64,
    duration_s: f64,
    x: impl Fn(f64) -> f64,
    signals: impl Fn(f64) -> [bool; 3],
) -> Move {
    const NEAR_S: f64 = 1e-6;
    let n = (duration_s / interval_s) as usize;
    let time_s: Vec<f64> = (0..n).map(|k| k as f64 * interval_s).collect();
    let segments = time_s
        .windows(2)
        .map(|w| Segment {
            to_m: x(w[1]),
            from_m_s: (x(w[0] + NEAR_S) - x(w[0])) / NEAR_S,
            to_m_s: (x(w[1]) - x(w[1] - NEAR_S)) / NEAR_S,
        })
        .collect();
    let signals = time_s.iter().map(|&t| signals(t)).collect();
    Move { name, inputs: Inputs { motion: Motion { start_m: x(0.0), segments }, signals, time_s } }
}
