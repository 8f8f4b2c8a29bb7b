//! Unmodelled laws over time as the solver reads them: one over the time since the start, and one that repeats.

use super::argument::LawArgument;
use super::law::{UnlistedLaw, law_at};
use super::place::LawPlace;
use crate::strut::characteristic::Characteristic;

/// Time steps in one turn of a law that repeats.
const STEPS_PER_TURN: f64 = 20.0;

/// Phase of an oscillation at a time, turns, from 0 up to 1.
#[inline]
pub(in crate::strut) fn phase(frequency_hz: f64, time_s: f64) -> f64 {
    let turns = frequency_hz * time_s;
    turns - turns.floor()
}

/// Longest time step, s, with which every law that repeats is followed; infinite where none does.
pub(in crate::strut) fn longest_step_s(laws: &[UnlistedLaw]) -> f64 {
    (laws.iter().filter_map(|law| law.frequency_hz)).fold(f64::INFINITY, |step, f| step.min(1.0 / (STEPS_PER_TURN * f)))
}

/// A law that repeats.
#[derive(Debug, Clone)]
pub(in crate::strut) struct Repeating {
    frequency_hz: f64,
    turn: Characteristic,
}

impl Repeating {
    /// The law over the phase at a place, if there is one.
    pub fn at(laws: &[UnlistedLaw], place: LawPlace) -> Option<Self> {
        let law = laws
            .iter()
            .find(|law| law.place == place && law.depends_on == LawArgument::Phase)?;
        Some(Self {
            frequency_hz: law.frequency_hz?,
            turn: law.characteristic(),
        })
    }

    /// Value at a time.
    #[inline]
    pub fn value(&self, time_s: f64) -> f64 {
        self.turn.value(phase(self.frequency_hz, time_s))
    }

    /// Rate at which the value changes at a time, 1/s.
    pub fn rate(&self, time_s: f64) -> f64 {
        self.frequency_hz * self.turn.at(phase(self.frequency_hz, time_s), &mut 0).1
    }
}

/// What a place has of laws over time.
#[derive(Debug, Clone, Default)]
pub(in crate::strut) struct Course {
    since_start: Option<Characteristic>,
    repeating: Option<Repeating>,
}

impl Course {
    /// The laws over time at a place.
    pub fn at(laws: &[UnlistedLaw], place: LawPlace) -> Self {
        Self::at_first_of(laws, &[place])
    }

    /// The laws over time at the first of these places that has one, for each kind of argument.
    pub fn at_first_of(laws: &[UnlistedLaw], places: &[LawPlace]) -> Self {
        Self {
            since_start: (places.iter()).find_map(|&place| law_at(laws, place, LawArgument::Time)),
            repeating: places.iter().find_map(|&place| Repeating::at(laws, place)),
        }
    }

    /// Whether there is none.
    #[inline]
    pub const fn is_none(&self) -> bool {
        self.since_start.is_none() && self.repeating.is_none()
    }

    /// What laws that are added give together at a time.
    #[inline]
    pub fn sum(&self, time_s: f64) -> f64 {
        let since_start = self.since_start.as_ref().map_or(0.0, |law| law.value(time_s));
        match &self.repeating {
            None => since_start,
            Some(law) => since_start + law.value(time_s),
        }
    }

    /// What laws that multiply give together at a time, neither of them less than `least`.
    #[inline]
    pub fn product(&self, time_s: f64, least: f64) -> f64 {
        let since_start = self
            .since_start
            .as_ref()
            .map_or(1.0, |law| law.value(time_s).max(least));
        match &self.repeating {
            None => since_start,
            Some(law) => since_start * law.value(time_s).max(least),
        }
    }

    /// Rate at which the sum changes at a time, 1/s.
    pub fn rate(&self, time_s: f64) -> f64 {
        let since_start = self.since_start.as_ref().map_or(0.0, |law| law.at(time_s, &mut 0).1);
        since_start + self.repeating.as_ref().map_or(0.0, |law| law.rate(time_s))
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
        assert!((Course::at(&both, LawPlace::Pack1).product(1.0, 0.0) - 1.0).abs() < 1e-12);
        assert!((longest_step_s(&both) - 0.2).abs() < 1e-12);
        let elsewhere = Course::at(&both, LawPlace::Pack2);
        assert!(elsewhere.is_none() && (elsewhere.sum(1.0), elsewhere.product(1.0, 0.0)) == (0.0, 1.0));
    }
}
