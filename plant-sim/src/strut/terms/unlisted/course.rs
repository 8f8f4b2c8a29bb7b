//! Unmodelled laws over time as the solver reads them: one over the time since the start, and one that repeats.

use super::argument::LawArgument;
use super::law::{UnlistedLaw, find};
use super::law_table::{LawTable, together};
use super::place::LawPlace;
use crate::lanes::Number;

/// Time steps in one turn of a law that repeats.
const STEPS_PER_TURN: f64 = 20.0;

/// Phase of an oscillation at a time, turns, from 0 up to 1.
#[inline]
pub(in crate::strut) fn phase(frequency_hz: f64, time_s: f64) -> f64 {
    part_of_turn(frequency_hz * time_s)
}

#[inline]
fn part_of_turn(turns: f64) -> f64 {
    turns - turns.floor()
}

/// Longest time step, s, with which every law that repeats is followed; infinite where none does.
pub(in crate::strut) fn longest_step_s(laws: &[UnlistedLaw]) -> f64 {
    (laws.iter().filter_map(|law| law.frequency_hz)).fold(f64::INFINITY, |step, f| step.min(1.0 / (STEPS_PER_TURN * f)))
}

/// A law that repeats, or none.
#[derive(Debug, Clone)]
struct Repeating<N: Number = f64> {
    frequency_hz: N,
    turn: LawTable<N>,
}

impl Repeating {
    const NONE: Self = Self {
        frequency_hz: 1.0,
        turn: LawTable::NONE,
    };

    /// The law over the phase at the first of these places that has one.
    fn at_first_of(laws: &[UnlistedLaw], places: &[LawPlace]) -> Self {
        let repeats = |&place: &LawPlace| {
            let law = find(laws, place, LawArgument::Phase)?;
            Some((law, law.frequency_hz?))
        };
        places
            .iter()
            .find_map(repeats)
            .map_or(Self::NONE, |(law, frequency_hz)| Self {
                frequency_hz,
                turn: LawTable::of(Some(law)),
            })
    }

    /// Rate at which the value changes at a time, 1/s.
    fn rate(&self, time_s: f64) -> f64 {
        let turn = self.turn.added(phase(self.frequency_hz, time_s));
        turn.map_or(0.0, |(_, slope)| self.frequency_hz * slope)
    }
}

impl<N: Number> Repeating<N> {
    /// Phase at a time, turns, if there is a law.
    #[inline(always)]
    fn phase(&self, time_s: N) -> Option<N> {
        if self.turn.is_none() {
            return None;
        }
        Some((self.frequency_hz * time_s).map(part_of_turn))
    }

    /// Amount at a time, if there is a law.
    #[inline(always)]
    fn amount(&self, time_s: N) -> Option<N> {
        self.turn.amount(self.phase(time_s)?)
    }

    /// Factor at a time that is never less than a bound, if there is a law.
    #[inline(always)]
    fn factor(&self, time_s: N, least: f64) -> Option<N> {
        self.turn.factor(self.phase(time_s)?, least)
    }
}

/// What a place has of laws over time; of one strut, or of several side by side.
#[derive(Debug, Clone)]
pub(in crate::strut) struct Course<N: Number = f64> {
    since_start: LawTable<N>,
    repeating: Repeating<N>,
}

impl Course {
    /// The laws over time at a place.
    pub fn at(laws: &[UnlistedLaw], place: LawPlace) -> Self {
        Self::at_first_of(laws, &[place])
    }

    /// The laws over time at the first of these places that has one, for each kind of argument.
    pub fn at_first_of(laws: &[UnlistedLaw], places: &[LawPlace]) -> Self {
        let since_start = places.iter().find_map(|&place| find(laws, place, LawArgument::Time));
        Self {
            since_start: LawTable::of(since_start),
            repeating: Repeating::at_first_of(laws, places),
        }
    }

    /// Those of several struts side by side, `like` any number of their kind.
    pub fn abreast<N: Number>(each: &N::Each<&Self>, like: N) -> Course<N> {
        let all = each.as_ref();
        Course {
            since_start: LawTable::abreast(&N::each(|lane| &all[lane].since_start)),
            repeating: Repeating {
                frequency_hz: like.gather_from(all, |course| course.repeating.frequency_hz),
                turn: LawTable::abreast(&N::each(|lane| &all[lane].repeating.turn)),
            },
        }
    }

    /// Rate at which the sum changes at a time, 1/s.
    pub fn rate(&self, time_s: f64) -> f64 {
        self.since_start.added(time_s).map_or(0.0, |(_, slope)| slope) + self.repeating.rate(time_s)
    }
}

impl<N: Number> Course<N> {
    /// Whether there is none.
    #[inline(always)]
    pub const fn is_none(&self) -> bool {
        self.since_start.is_none() && self.repeating.turn.is_none()
    }

    /// What laws that are added give together at a time.
    #[inline(always)]
    pub fn sum(&self, time_s: N) -> N {
        let sum = together(self.since_start.amount(time_s), self.repeating.amount(time_s), N::add);
        sum.unwrap_or(time_s.of(0.0))
    }

    /// What laws that multiply give together at a time, neither of them less than `least`; none where there is no law.
    #[inline(always)]
    pub fn product(&self, time_s: N, least: f64) -> Option<N> {
        let since_start = self.since_start.factor(time_s, least);
        together(since_start, self.repeating.factor(time_s, least), N::mul)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(depends_on: LawArgument, value: [f64; 3]) -> UnlistedLaw {
        UnlistedLaw {
            place: LawPlace::Pack1,
            depends_on,
            argument: vec![0.0, 0.5, 1.0],
            value: value.to_vec(),
            time_constant_s: None,
            frequency_hz: (depends_on == LawArgument::Phase).then_some(0.25),
            presliding_volume_m3: None,
            attraction: None,
        }
    }

    #[test]
    fn a_law_over_the_phase_repeats_and_joins_one_over_time() {
        let repeating = law(LawArgument::Phase, [1.0, 3.0, 1.0]);
        let course = Course::at(std::slice::from_ref(&repeating), LawPlace::Pack1);
        for turn in [0.0, 4.0, 400.0] {
            assert!((course.sum(turn + 1.0) - 2.0).abs() < 1e-9 && (course.sum(turn + 2.0) - 3.0).abs() < 1e-9);
            // Half a turn takes 2 s, over which it rises by 2.
            assert!((course.rate(turn + 0.5) - 1.0).abs() < 1e-9 && (course.rate(turn + 3.5) + 1.0).abs() < 1e-9);
        }
        let both = [law(LawArgument::Time, [0.5, 0.5, 0.5]), repeating];
        assert!((Course::at(&both, LawPlace::Pack1).product(1.0, 0.0).unwrap() - 1.0).abs() < 1e-12);
        assert!((longest_step_s(&both) - 0.2).abs() < 1e-12);
        let elsewhere = Course::at(&both, LawPlace::Pack2);
        assert!(elsewhere.is_none() && (elsewhere.sum(1.0), elsewhere.product(1.0, 0.0)) == (0.0, None));
    }
}
