//! How many ticks later the rear wheels meet what the front wheels met: the wheelbase over the vehicle's speed.
//!
//! The controller is told no speed, but both axles drive over the same road. The signs of the strut speeds above 3 Hz, in which
//! the road is and the body's motion is not, agree best at that delay. For every delay at once, agreement of the rear sign with
//! the front signs of the last 128 ticks is one exclusive-or, and the 128 sums are counted bit by bit in ten words ("vertical
//! counters"), so that a tick costs the same few instructions whatever the number of delays.
//!
//! A window of 1.28 s gives 512 comparisons of two sides. On classes B to E and Belgian block at 40 to 80 km/h the greatest
//! agreement is 0.62 to 0.96, and it lies within a tick of the truth whenever it is above 0.72 (`docs/controller.md`). For
//! Gaussian signals an agreement of 0.72 is a correlation of 0.64.
//!
//! Source: polarity-coincidence correlation, J. H. Van Vleck and D. Middleton, The spectrum of clipped noise, Proc. IEEE 54
//! (1966): `r = sin(pi (agreement - 1/2))`.

use oleo_interface::{Axles, Corners};

use crate::filter::LowPass;

/// Frequency above which strut speeds are compared, Hz.
const CORNER_HZ: f32 = 3.0;
/// Ticks compared before a delay is chosen.
const WINDOW_TICKS: u16 = 256;
/// Delays that are looked for, a bit each: 12 to 120 ticks, which are 168 down to 17 km/h at a wheelbase of 2.8 m.
const DELAYS: u128 = (1 << 121) - (1 << 12);
/// Least number of agreements, of two in each tick, that is more than chance: a fraction of 0.72.
const LEAST_AGREEMENTS: u16 = 369;
/// Windows without a clear answer after which the last one is forgotten.
const FORGET_WINDOWS: u8 = 4;
/// Longest delay, ticks, plus one.
pub(crate) const HISTORY: usize = 128;

/// The filter that takes the body's motion out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parameters {
    body: LowPass,
}

impl Parameters {
    /// Of every vehicle: a delay in ticks needs no dimension.
    pub fn new() -> Self {
        Self {
            body: LowPass::from_corner_hz(CORNER_HZ),
        }
    }
}

/// Signs, counters and the delay found last.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct State {
    body: Corners<f32>,
    /// Signs at the front, left and right: bit `k` is that of `k` ticks ago.
    front: [u128; 2],
    /// Bit `k` of plane `n` is bit `n` of the number of agreements at a delay of `k` ticks.
    planes: [u128; 10],
    ticks: u16,
    delay: Option<u8>,
    unclear: u8,
}

impl State {
    /// One tick, from the strut speeds, m/s; returns the delay, ticks, below [`HISTORY`], or nothing while it is not known.
    pub fn step(&mut self, c: &Parameters, strut_speed_m_s: Corners<f32>) -> Option<u8> {
        let bodies = self.body.each_mut().zip(strut_speed_m_s);
        let upward = bodies.map(|(body, speed)| speed > c.body.step(body, speed));
        let Axles { front, rear } = upward.by_axle();
        self.ticks += 1;
        for ((history, front), rear) in self.front.iter_mut().zip([front.0, front.1]).zip([rear.0, rear.1]) {
            *history = *history << 1 | u128::from(front);
            // A window begins when the history is full, or what was before the start would be counted.
            if self.ticks > HISTORY as u16 {
                count(&mut self.planes, if rear { *history } else { !*history });
            }
        }
        if self.ticks == HISTORY as u16 + WINDOW_TICKS {
            self.ticks = HISTORY as u16;
            self.judge();
            self.planes = [0; 10];
        }
        self.delay
    }

    /// Chooses the delay of greatest agreement.
    fn judge(&mut self) {
        let mut best = DELAYS;
        let mut agreements = 0;
        for plane in self.planes.iter().rev() {
            let with = best & plane;
            agreements = agreements << 1 | u16::from(with != 0);
            if with != 0 {
                best = with;
            }
        }
        if agreements >= LEAST_AGREEMENTS {
            self.delay = Some(best.trailing_zeros() as u8);
            self.unclear = 0;
        } else {
            self.unclear = self.unclear.saturating_add(1);
            if self.unclear >= FORGET_WINDOWS {
                self.delay = None;
            }
        }
    }
}

/// Adds one to the counter of every delay whose bit is set.
fn count(planes: &mut [u128; 10], agreeing: u128) {
    let mut carry = agreeing;
    for plane in planes {
        let next = *plane & carry;
        *plane ^= carry;
        carry = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A road without memory, from -1 to 1: the fractional part of a chirp.
    fn road(place: usize, side: usize) -> f32 {
        let n = (place * 2 + side) % 4_096;
        libm::sinf(0.37 * (n * n) as f32)
    }

    /// The delay found on a vehicle whose rear axle repeats the front one's speeds `delay` ticks later, with a part of noise.
    fn drive(delay: usize, noise: f32, ticks: usize) -> Option<u8> {
        let (c, mut state) = (Parameters::new(), State::default());
        let mut found = None;
        for tick in 0..ticks {
            let speeds = [(0, delay), (1, delay), (0, 0), (1, 0)];
            let mut strut = 0;
            let speeds = speeds.map(|(side, ahead)| {
                strut += 1;
                road(tick + ahead, side) + noise * road(977 * tick + 101 * strut, 1 - side)
            });
            found = state.step(&c, Corners::from_array(speeds));
        }
        found
    }

    #[test]
    fn the_delay_is_found_to_the_tick() {
        for delay in [12, 25, 33, 60, 120] {
            assert_eq!(drive(delay, 0.3, 400), Some(delay as u8));
        }
    }

    #[test]
    fn nothing_is_said_of_axles_that_do_not_follow_each_other() {
        assert_eq!(drive(40, 30.0, 4_000), None);
        assert_eq!(drive(5, 0.0, 4_000), None, "faster than anything on wheels");
    }

    #[test]
    fn the_delay_follows_the_speed_and_is_forgotten() {
        let (c, mut state) = (Parameters::new(), State::default());
        let mut found = [None; 3];
        for tick in 0..4_000 {
            let (phase, delay) = if tick < 1_000 { (0, 30) } else { (1, 50) };
            let (ahead, noise) = if tick < 2_000 {
                (delay, 0.0)
            } else {
                (2_000 + 3 * tick, 30.0)
            };
            let speeds = [
                road(tick + ahead, 0),
                road(tick + ahead, 1),
                road(tick, 0),
                road(tick + ahead / 977, 1),
            ];
            let phase = if noise > 0.0 { 2 } else { phase };
            found[phase] = state.step(&c, Corners::from_array(speeds));
        }
        assert_eq!(found, [Some(30), Some(50), None]);
    }

    #[test]
    fn counters_count() {
        let mut planes = [0; 10];
        for n in 0..512u128 {
            count(&mut planes, 1 | (n % 2) << 127);
        }
        assert_eq!(planes[9], 1);
        assert_eq!(planes[8], 1 << 127);
        assert_eq!(planes[0..8], [0; 8]);
    }
}
