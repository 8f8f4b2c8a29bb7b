//! Campaigns that conceal several effects at once.

use serde::Serialize;

use crate::selftest::plan::{SIZES, nearest_size};
use crate::selftest::statistics::Rate;
use crate::selftest::trial::Trial;

/// What became of campaigns with several concealed effects, by size.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Several {
    /// Number of effects that each of the campaigns conceals.
    pub concealed: usize,
    /// Size on the grid, in units of noise.
    pub size: f64,
    /// Concealed effects of about this size: those that were found.
    pub found: Rate,
    /// Campaigns whose smallest concealed effect has about this size: those in which exactly the concealed effects were reported.
    pub exact: Rate,
}

/// The rows of all numbers of concealed effects and all sizes that there are.
pub(super) fn several(trials: &[&Trial]) -> Vec<Several> {
    let most = trials.iter().map(|t| t.hidden.len()).max().unwrap_or(0);
    let mut rows = Vec::new();
    for concealed in 2..=most {
        for size in SIZES {
            let mut row = Several {
                concealed,
                size,
                found: Rate::default(),
                exact: Rate::default(),
            };
            for t in trials.iter().filter(|t| t.hidden.len() == concealed) {
                let each = t.each_found();
                for (_, found) in each.iter().filter(|(reached, _)| nearest_size(*reached) == size) {
                    row.found.count(*found);
                }
                let smallest = each.iter().map(|(reached, _)| *reached).fold(f64::INFINITY, f64::min);
                if nearest_size(smallest) == size {
                    let [hidden, reported] = t.concealed_and_reported();
                    row.exact.count(hidden == reported);
                }
            }
            if row.found.of > 0 {
                rows.push(row);
            }
        }
    }
    rows
}

/// The rows of one number of concealed effects, added.
pub(super) fn of_all_sizes(rows: &[Several], concealed: usize) -> Several {
    let sum = |rate: &dyn Fn(&Several) -> Rate| {
        (rows.iter().filter(|row| row.concealed == concealed)).fold(Rate::default(), |sum, row| Rate {
            hits: sum.hits + rate(row).hits,
            of: sum.of + rate(row).of,
        })
    };
    Several {
        concealed,
        size: f64::NAN,
        found: sum(&|row| row.found),
        exact: sum(&|row| row.exact),
    }
}
