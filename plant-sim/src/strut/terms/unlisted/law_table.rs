//! The table of a law as the network reads it: of one strut, or of several side by side.

use super::argument::LawArgument;
use super::law::{UnlistedLaw, law_at};
use super::place::LawPlace;
use crate::lanes::Number;
use crate::strut::characteristic::Characteristic;

/// The table of a law, or none. Of several struts side by side all have one or none has.
#[derive(Debug, Clone)]
pub(in crate::strut) struct LawTable<N: Number = f64>(Option<N::Each<Characteristic>>);

impl LawTable {
    /// No law.
    pub const NONE: Self = Self(None);

    /// The table of the law at a place over a quantity, if there is one.
    pub fn at_place(laws: &[UnlistedLaw], place: LawPlace, over: LawArgument) -> Self {
        Self(law_at(laws, place, over).map(|table| [table]))
    }

    /// The table of a law.
    pub fn of(law: Option<&UnlistedLaw>) -> Self {
        Self(law.map(|law| [law.characteristic()]))
    }

    /// This one, or another one where there is none.
    pub fn or(self, other: Self) -> Self {
        Self(self.0.or(other.0))
    }

    /// Those of several struts side by side; none where only some of them have one.
    pub fn abreast<N: Number>(each: &N::Each<&Self>) -> Option<LawTable<N>> {
        let all = each.as_ref();
        if all.iter().all(|table| table.is_none()) {
            return Some(LawTable(None));
        }
        N::each_of(|lane| all[lane].0.clone().map(|[table]| table)).map(|tables| LawTable(Some(tables)))
    }
}

impl<N: Number> LawTable<N> {
    /// Whether there is none.
    #[inline(always)]
    pub const fn is_none(&self) -> bool {
        self.0.is_none()
    }

    /// Value and derivative at an argument, if there is a law.
    #[inline(always)]
    pub fn at(&self, argument: N) -> Option<(N, N)> {
        let tables = self.0.as_ref()?.as_ref();
        let answers = N::each(|lane| tables[lane].at(argument.lane(lane), &mut 0));
        let answers = answers.as_ref();
        Some((
            argument.gather(|lane| answers[lane].0),
            argument.gather(|lane| answers[lane].1),
        ))
    }

    /// Value at an argument, if there is a law.
    #[inline(always)]
    pub fn value(&self, argument: N) -> Option<N> {
        let tables = self.0.as_ref()?.as_ref();
        Some(argument.gather(|lane| tables[lane].value(argument.lane(lane))))
    }

    /// The same, where less than a bound counts as the bound.
    #[inline(always)]
    pub fn value_at_least(&self, least: f64, argument: N) -> Option<N> {
        Some(self.value(argument)?.at_least(argument.of(least)))
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
