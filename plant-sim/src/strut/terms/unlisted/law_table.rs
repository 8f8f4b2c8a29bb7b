//! The table of a law as the network reads it: of one strut, or of several side by side.

use super::argument::LawArgument;
use super::law::{UnlistedLaw, law_at};
use super::place::LawPlace;
use crate::lanes::Number;
use crate::strut::characteristic::Characteristic;

/// The table of a law, or none. Of several struts side by side some may have one and others none: in a lane without a table the answer is what leaves
/// the model as it is.
#[derive(Debug, Clone)]
pub(in crate::strut) struct LawTable<N: Number = f64>(Option<N::Each<Option<Characteristic>>>);

impl LawTable {
    /// No law.
    pub const NONE: Self = Self(None);

    /// The table of the law at a place over a quantity, if there is one.
    pub fn at_place(laws: &[UnlistedLaw], place: LawPlace, over: LawArgument) -> Self {
        Self(law_at(laws, place, over).map(|table| [Some(table)]))
    }

    /// The table of a law.
    pub fn of(law: Option<&UnlistedLaw>) -> Self {
        Self(law.map(|law| [Some(law.characteristic())]))
    }

    /// This one, or another one where there is none.
    pub fn or(self, other: Self) -> Self {
        Self(self.0.or(other.0))
    }

    /// Those of several struts side by side.
    pub fn abreast<N: Number>(each: &N::Each<&Self>) -> LawTable<N> {
        let all = each.as_ref();
        let has_one = all.iter().any(|table| !table.is_none());
        LawTable(has_one.then(|| N::each(|lane| all[lane].0.as_ref().and_then(|[table]| table.clone()))))
    }
}

impl<N: Number> LawTable<N> {
    /// Whether there is none.
    #[inline(always)]
    pub const fn is_none(&self) -> bool {
        self.0.is_none()
    }

    /// What a law adds at an argument and its derivative, if there is one.
    #[inline(always)]
    pub fn added(&self, argument: N) -> Option<(N, N)> {
        // Zero of this sign added to any number is that number, to the bit.
        self.at(argument, (-0.0, -0.0))
    }

    /// What a law multiplies by at an argument and its derivative, if there is one.
    #[inline(always)]
    pub fn multiplied(&self, argument: N) -> Option<(N, N)> {
        self.at(argument, (1.0, 0.0))
    }

    #[inline(always)]
    fn at(&self, argument: N, without: (f64, f64)) -> Option<(N, N)> {
        let tables = self.0.as_ref()?.as_ref();
        // In a loop, because a closure with a choice in it is not always compiled in line, and outside of it vectors go through memory.
        let mut answers = N::each(|_| without);
        for (lane, (table, answer)) in tables.iter().zip(answers.as_mut()).enumerate() {
            if let Some(table) = table {
                *answer = table.at(argument.lane(lane), &mut 0);
            }
        }
        let answers = answers.as_ref();
        Some((
            argument.gather(|lane| answers[lane].0),
            argument.gather(|lane| answers[lane].1),
        ))
    }

    /// An amount at an argument, if there is a law.
    #[inline(always)]
    pub fn amount(&self, argument: N) -> Option<N> {
        self.value(argument, 0.0)
    }

    /// The same of what is never negative, such as an opening.
    #[inline(always)]
    pub fn opening(&self, argument: N) -> Option<N> {
        Some(self.amount(argument)?.at_least(argument.of(0.0)))
    }

    /// A factor at an argument that is never less than a bound, if there is a law.
    #[inline(always)]
    pub fn factor(&self, argument: N, least: f64) -> Option<N> {
        Some(self.value(argument, 1.0)?.at_least(argument.of(least)))
    }

    #[inline(always)]
    fn value(&self, argument: N, without: f64) -> Option<N> {
        let tables = self.0.as_ref()?.as_ref();
        let mut values = N::each(|_| without);
        for (lane, (table, value)) in tables.iter().zip(values.as_mut()).enumerate() {
            if let Some(table) = table {
                *value = table.value(argument.lane(lane));
            }
        }
        let values = values.as_ref();
        Some(argument.gather(|lane| values[lane]))
    }
}

/// Two values together, or the one that is there.
#[inline(always)]
pub(super) fn together<N: Number>(one: Option<N>, other: Option<N>, join: impl FnOnce(N, N) -> N) -> Option<N> {
    match (one, other) {
        (Some(one), Some(other)) => Some(join(one, other)),
        (Some(one), None) => Some(one),
        (None, other) => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Four;

    #[test]
    fn in_a_lane_without_a_table_a_law_leaves_the_model_as_it_is() {
        let law = UnlistedLaw {
            place: LawPlace::Path1,
            depends_on: LawArgument::Flow,
            argument: vec![0.0, 1.0],
            value: vec![-2.0, 2.0],
            time_constant_s: None,
            frequency_hz: None,
            presliding_volume_m3: None,
            attraction: None,
        };
        let (with, none) = (LawTable::of(Some(&law)), LawTable::NONE);
        let argument = Four::zero(pulp::Scalar256b).of(0.75);
        let table = LawTable::abreast::<Four<pulp::Scalar256b>>(&[&none, &with, &none, &with]);
        let bits = |number: Four<_>| number.into_array().map(f64::to_bits);
        let expected = |without: f64, value: f64| [without, value, without, value].map(f64::to_bits);
        let (added, slope) = table.added(argument).unwrap();
        assert_eq!((bits(added), bits(slope)), (expected(-0.0, 1.0), expected(-0.0, 4.0)));
        let (factor, slope) = table.multiplied(argument).unwrap();
        assert_eq!((bits(factor), bits(slope)), (expected(1.0, 1.0), expected(0.0, 4.0)));
        assert_eq!(bits(table.factor(argument.of(0.0), 0.5).unwrap()), expected(1.0, 0.5));
        assert_eq!(bits(table.opening(argument.of(0.0)).unwrap()), expected(0.0, 0.0));
        assert!(LawTable::abreast::<Four<pulp::Scalar256b>>(&[&none; 4]).is_none());
    }
}
