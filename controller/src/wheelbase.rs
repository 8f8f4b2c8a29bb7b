//! How many ticks later the rear wheels meet what the front wheels met: the wheelbase over the vehicle's speed.
//!
//! The controller is told no speed, but both axles drive over the same road. The signs of the strut speeds above 3 Hz, in which
//! the road is and the body's motion is not, agree best at that delay. For every delay at once, agreement of the rear sign with
//! the front signs of the last 128 ticks is one exclusive-or. The 128 sums are counted bit by bit, bit `n` of all of them in one
//! word. A full adder adds the agreements of both sides to bit 0; its carries wait until there are two of them, which are then
//! added to bit 1 by the next full adder, and so on. So bit `n` is touched in every `2^n`th tick, and a tick needs two additions,
//! whatever the number of delays ("carry-save", as in the population count of Harley and Seal: Warren, Hacker's Delight,
//! 2nd edition, section 5-1). The turns of the bits are staggered, so that a tick never has more than these two.
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
const WINDOW_TICKS: u16 = 1 << (PLACES - 2);
/// Binary places of the counters: two agreements in each tick of the window, 512 at most.
const PLACES: usize = 10;
/// Ticks after the window in which two places each take in the carries that wait still: all places but the lowest two.
const DRAINING_TICKS: u16 = (PLACES as u16 - 2) / 2;
/// Ticks after that in which two places each are judged.
const JUDGING_TICKS: u16 = PLACES as u16 / 2;
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

/// One binary place of the number of agreements at every delay: bit `k` of each word is about a delay of `k` ticks.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Place {
    /// The place itself.
    sum: u128,
    /// Carries out of the place below that wait to be added.
    waiting: [u128; 2],
}

impl Place {
    const INITIAL: Self = Self {
        sum: 0,
        waiting: [0; 2],
    };

    /// Adds two carries, or agreements; returns the carry into the place above.
    fn add(&mut self, [a, b]: [u128; 2]) -> u128 {
        let carry = (self.sum & a) | (b & (self.sum | a));
        self.sum ^= a ^ b;
        carry
    }
}

/// What is known of the greatest number of agreements, while the counters are looked at from their highest place.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Judgement {
    /// Delays of which the places so far are the greatest.
    best: u128,
    /// Those places.
    agreements: u16,
}

/// Signs, counters and the delay found last.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct State {
    body: Corners<f32>,
    /// Signs at the front, left and right: bit `k` is that of `k` ticks ago.
    front: [u128; 2],
    /// Place `n` holds bit `n` of the number of agreements.
    places: [Place; PLACES],
    /// Ticks since the start, until the history is full; then its length and the ticks since the window began.
    ticks: u16,
    judgement: Judgement,
    delay: Option<u8>,
    unclear: u8,
}

impl State {
    pub const INITIAL: Self = Self {
        body: Corners::splat(0.0),
        front: [0; 2],
        places: [Place::INITIAL; PLACES],
        ticks: 0,
        judgement: Judgement::INITIAL,
        delay: None,
        unclear: 0,
    };

    /// One tick, from the strut speeds, m/s; returns the delay, ticks, below [`HISTORY`], or nothing while it is not known.
    pub fn step(&mut self, c: &Parameters, strut_speed_m_s: Corners<f32>) -> Option<u8> {
        let bodies = self.body.each_mut().zip(strut_speed_m_s);
        let upward = bodies.map(|(body, speed)| speed > c.body.step(body, speed));
        let Axles { front, rear } = upward.by_axle();
        let [left, right] = &mut self.front;
        *left = *left << 1 | u128::from(front.0);
        *right = *right << 1 | u128::from(front.1);
        // A window begins when the history is full, or what was before the start would be counted.
        let tick = self.ticks.checked_sub(HISTORY as u16);
        self.ticks += 1;
        match tick {
            None => {}
            Some(tick) if tick < WINDOW_TICKS => {
                // Front signs where the rear one is upward, and their inverse where it is not.
                let agreeing = |rear: bool, front: u128| front ^ u128::from(rear).wrapping_sub(1);
                let both = [agreeing(rear.0, *left), agreeing(rear.1, *right)];
                count(&mut self.places, tick, both);
            }
            Some(tick) => self.end_window(tick - WINDOW_TICKS),
        }
        self.delay
    }

    /// What is done after a window, a little in each tick, while nothing is counted: the waiting carries are added, the places are
    /// judged from the highest, a delay of greatest agreement is chosen, and a window begins.
    #[inline(never)]
    fn end_window(&mut self, tick: u16) {
        if tick < DRAINING_TICKS {
            for place in [2 + 2 * tick, 3 + 2 * tick] {
                add_waiting(&mut self.places, place.into(), WINDOW_TICKS);
            }
        } else if let Some(tick) = tick.checked_sub(DRAINING_TICKS)
            && tick < JUDGING_TICKS
        {
            if tick == 0 {
                self.judgement = Judgement::BEGUN;
            }
            for place in self.places.iter().rev().skip(2 * usize::from(tick)).take(2) {
                self.judgement.look_at(place.sum);
            }
        } else if tick == DRAINING_TICKS + JUDGING_TICKS {
            self.places = [Place::INITIAL; PLACES];
        } else {
            self.choose();
            self.ticks = HISTORY as u16;
        }
    }

    fn choose(&mut self) {
        let Judgement { best, agreements } = self.judgement;
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

impl Judgement {
    /// Before a window was judged.
    const INITIAL: Self = Self { best: 0, agreements: 0 };
    /// Before the highest place of a window was looked at.
    const BEGUN: Self = Self {
        best: DELAYS,
        agreements: 0,
    };

    /// Looks at the next lower place of the counters.
    fn look_at(&mut self, place: u128) {
        let with = self.best & place;
        self.agreements = self.agreements << 1 | u16::from(with != 0);
        if with != 0 {
            self.best = with;
        }
    }
}

/// Adds the agreements of both sides in a tick of the window, 0 to 255, to the counters.
///
/// Place 0 adds in every tick, place 1 in every odd one. Of the even ticks place 2 has every second one, place 3 every second one of
/// those that are left, and so on: ticks 0, 4, 8 for place 2, ticks 2, 10, 18 for place 3, ticks 6, 22 for place 4. At its turn
/// a place finds the carries of two turns of the place below.
#[inline(never)]
fn count(places: &mut [Place; PLACES], tick: u16, both: [u128; 2]) {
    let [units, twos, ..] = places;
    let carry = units.add(both);
    if tick & 1 == 0 {
        let [first, _] = &mut twos.waiting;
        *first = carry;
        add_waiting(places, 2 + (tick >> 1).trailing_ones() as usize, tick);
    } else {
        let [first, _] = twos.waiting;
        let carry = twos.add([first, carry]);
        wait(places, 2, tick >> 1, carry);
    }
}

/// The turn of a place, from 2 on, in a tick: adds the carries that wait there. None of the highest place is carried further.
#[inline(never)]
fn add_waiting(places: &mut [Place; PLACES], place: usize, tick: u16) {
    let Some(here) = places.get_mut(place) else { return };
    let carry = here.add(here.waiting);
    wait(places, place + 1, tick >> place, carry);
}

/// Lets a carry wait at a place: that of each second turn of the place below beside that of the one before.
fn wait(places: &mut [Place; PLACES], place: usize, turn: u16, carry: u128) {
    if let Some(place) = places.get_mut(place) {
        let [even, odd] = &mut place.waiting;
        *(if turn & 1 == 0 { even } else { odd }) = carry;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_interface::Corner;

    /// A road without memory, from -1 to 1: the fractional part of a chirp.
    fn road(place: usize, side: usize) -> f32 {
        let n = (place * 2 + side) % 4_096;
        libm::sinf(0.37 * (n * n) as f32)
    }

    /// The delay found on a vehicle whose rear axle repeats the front one's speeds `delay` ticks later, with a part of noise.
    fn drive(delay: usize, noise: f32, ticks: usize) -> Option<u8> {
        let (c, mut state) = (Parameters::new(), State::INITIAL);
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
        let (c, mut state) = (Parameters::new(), State::INITIAL);
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
    fn a_delay_is_forgotten_after_four_windows_that_agree_on_none() {
        let mut state = State {
            delay: Some(30),
            ..State::INITIAL
        };
        for window in 1..=FORGET_WINDOWS {
            state.choose();
            assert_eq!(state.delay.is_some(), window < 4, "window {window}");
        }
    }

    /// Every fourth delay agrees on the left in each tick and on the right in every third one, or less.
    #[test]
    fn counters_count() {
        let mut places = [Place::INITIAL; PLACES];
        let mut expected = [0_u16; HISTORY];
        for tick in 0..WINDOW_TICKS {
            let mut both = [0_u128; 2];
            for (delay, expected) in expected.iter_mut().enumerate() {
                let agrees = [delay % 4 == 0, (usize::from(tick) * (delay + 1)) % 3 == 0];
                for (word, agrees) in both.iter_mut().zip(agrees) {
                    *word |= u128::from(agrees) << delay;
                    *expected += u16::from(agrees);
                }
            }
            both[1] |= 1 << 2; // delay 2 agrees always on the right
            count(&mut places, tick, both);
        }
        expected[2] = WINDOW_TICKS;
        let drain = |places: &mut _| (2..PLACES).for_each(|place| add_waiting(places, place, WINDOW_TICKS));
        drain(&mut places);
        for (delay, expected) in expected.into_iter().enumerate() {
            let bit = |word: u128| (word >> delay & 1) as u16;
            let counted: u16 = (places.iter().enumerate()).map(|(n, place)| bit(place.sum) << n).sum();
            assert_eq!(counted, expected, "delay {delay}");
        }
        let mut all = [Place::INITIAL; PLACES];
        (0..WINDOW_TICKS).for_each(|tick| count(&mut all, tick, [u128::MAX; 2]));
        drain(&mut all);
        assert!(all.iter().rev().skip(1).all(|place| place.sum == 0));
        assert_eq!(all[PLACES - 1].sum, u128::MAX, "512 agreements are bit 9 alone");
    }

    /// Struts that stand still agree at every delay in each of the 256 ticks of the window and in no other. Where the rear one is upward
    /// all the time, they never do.
    #[test]
    fn a_window_counts_its_own_ticks_and_all_of_them() {
        for (rear_right_is_upward, expected) in [(false, 512), (true, 256)] {
            let (c, mut state) = (Parameters::new(), State::INITIAL);
            for tick in 0..HISTORY as u16 + WINDOW_TICKS + DRAINING_TICKS + JUDGING_TICKS {
                let mut speeds = Corners::splat(0.0);
                if rear_right_is_upward {
                    speeds[Corner::RearRight] = f32::from(tick + 1);
                }
                state.step(&c, speeds);
            }
            let Judgement { best, agreements } = state.judgement;
            assert_eq!((best, agreements), (DELAYS, expected));
        }
    }
}
