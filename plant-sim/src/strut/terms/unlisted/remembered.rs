//! A law with a memory as the solver reads it: of one strut, or of several side by side.

use super::law::UnlistedLaw;
use super::law_table::LawTable;
use crate::lanes::Number;

/// The table of a law with a memory and its time constant, or none.
#[derive(Debug, Clone)]
pub(super) struct Remembered<N: Number = f64> {
    pub table: LawTable<N>,
    pub time_constant_s: N,
}

impl Remembered {
    const NONE: Self = Self {
        table: LawTable::NONE,
        time_constant_s: 1.0,
    };

    /// A law, if there is one and if it has a time constant.
    pub fn of(law: Option<&UnlistedLaw>) -> Self {
        match law.and_then(|law| law.time_constant_s) {
            Some(time_constant_s) => Self {
                table: LawTable::of(law),
                time_constant_s,
            },
            None => Self::NONE,
        }
    }

    /// Those of several struts side by side, `like` any number of their kind.
    pub fn abreast<N: Number>(each: &N::Each<&Self>, like: N) -> Remembered<N> {
        let all = each.as_ref();
        Remembered {
            table: LawTable::abreast(&N::each(|lane| &all[lane].table)),
            time_constant_s: like.gather_from(all, |law| law.time_constant_s),
        }
    }
}

impl<N: Number> Remembered<N> {
    /// Whether there is none.
    #[inline(always)]
    pub const fn is_none(&self) -> bool {
        self.table.is_none()
    }

    /// What an implicit step of a duration (s) leaves of what is remembered, 0 to 1.
    #[inline(always)]
    pub fn left(&self, duration_s: N) -> N {
        (duration_s / self.time_constant_s + 1.0).recip()
    }
}
