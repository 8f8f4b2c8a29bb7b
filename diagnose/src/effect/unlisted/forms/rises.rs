//! Tables that are fitted as rises from knot to knot.

use oleo_plant_sim::strut::UnlistedLaw;

use super::form::Grid;
use crate::parameter::Parameter;

/// Whether a key is that of a number of a free table: a value at a point, or a rise from point to point.
#[must_use]
pub fn is_of_free_table(key: &str) -> bool {
    ["rise_", "log_rise_", "at_"]
        .iter()
        .any(|prefix| key.starts_with(prefix))
}

/// A parameter for each rise, made from its key.
pub fn parameters(grid: &Grid, parameter: impl Fn(String) -> Parameter) -> Vec<Parameter> {
    (grid.knots.windows(2))
        .map(|w| parameter(format!("rise_{:.3e}_to_{:.3e}", w[0], w[1])))
        .collect()
}

/// Values at the knots, zero at rest; where rest is no knot, zero at the first.
pub fn values(grid: &Grid, rises: &[f64]) -> Vec<f64> {
    let mut value = vec![0.0];
    for rise in rises {
        value.push(value[value.len() - 1] + rise);
    }
    let at_rest = grid.knots.iter().position(|k| *k == grid.at_rest);
    let rest = at_rest.map_or(0.0, |k| value[k]);
    value.iter().map(|v| v - rest).collect()
}

/// Rises of a law from knot to knot.
pub fn of(grid: &Grid, law: &UnlistedLaw) -> Vec<f64> {
    let values = at(grid, law);
    values.windows(2).map(|w| w[1] - w[0]).collect()
}

/// Values of a law at the knots.
pub fn at(grid: &Grid, law: &UnlistedLaw) -> Vec<f64> {
    let table = law.characteristic();
    grid.knots.iter().map(|x| table.value(*x)).collect()
}
