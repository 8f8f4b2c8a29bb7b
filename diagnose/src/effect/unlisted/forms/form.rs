//! The trait of a form: how a law is described by a few fitted parameters.

use oleo_plant_sim::strut::UnlistedLaw;

use crate::parameter::Parameter;

/// Largest fitted number over one that would be visible.
const MOST: f64 = 1e4;
/// Levels that are tried beside none, over one that would be visible: beside none an answer may not be in proportion to the level.
const LARGER: [f64; 2] = [5.0, 20.0];

/// Points of a table and what is known of the law there.
pub struct Grid<'k> {
    /// Values of the argument at which the table has points.
    pub knots: &'k [f64],
    /// Value of the argument at rest, where a law changes nothing.
    pub at_rest: f64,
    /// Size of one fitted number that would be visible.
    pub visible: f64,
    /// Duration of the longest recording, s.
    pub longest_s: f64,
}

impl Grid<'_> {
    /// Largest value that a fitted number may have.
    #[must_use]
    pub fn most(&self) -> f64 {
        MOST * self.visible
    }

    /// Levels that are tried beside none where a value is never negative.
    #[must_use]
    pub fn larger(&self) -> [f64; 2] {
        LARGER.map(|size| size * self.visible)
    }
}

/// A law of a few numbers as an equation of its value `y` and its argument `x`, or the time `t` since the start of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClosedForm {
    /// The equation, as `oleo_report` sets it.
    pub equation: &'static str,
    /// Symbols of the fitted numbers, in their order.
    pub symbols: &'static [&'static str],
}

/// How a table comes from fitted numbers.
pub trait Form: Sync {
    /// The law as an equation; `None` for a table of free points.
    fn closed(&self) -> Option<ClosedForm> {
        None
    }

    /// The parameters that are fitted.
    fn parameters(&self, grid: &Grid) -> Vec<Parameter>;

    /// Starting points beside "not there": laws that bend far from straight are also tried where they show.
    fn starts(&self, _grid: &Grid) -> Vec<Vec<f64>> {
        vec![]
    }

    /// Time constant of a law with a memory, s, from the fitted numbers.
    fn time_constant_s(&self, _fitted: &[f64]) -> Option<f64> {
        None
    }

    /// Frequency of a law that repeats, Hz, from the fitted numbers.
    fn frequency_hz(&self, _fitted: &[f64]) -> Option<f64> {
        None
    }

    /// Oil volume that shears the seal of a law at a floating piston, m3, from the fitted numbers.
    fn presliding_volume_m3(&self, _fitted: &[f64]) -> Option<f64> {
        None
    }

    /// What attraction takes away of the compressibility factor of a law over the density of a gas, from the fitted numbers.
    fn attraction(&self, _fitted: &[f64]) -> Option<f64> {
        None
    }

    /// The law of a quantity as an equation with the fitted numbers; `None` for a form that is drawn.
    fn equation(&self, _quantity: &str, _fitted: &[f64]) -> Option<String> {
        None
    }

    /// Values of the argument at which the table has points.
    fn argument(&self, grid: &Grid, _fitted: &[f64]) -> Vec<f64> {
        grid.knots.to_vec()
    }

    /// The numbers with which this form comes near a law of another form over the same quantity; `None` where that says nothing.
    fn near(&self, _grid: &Grid, _law: &UnlistedLaw) -> Option<Vec<f64>> {
        None
    }

    /// The table's values from the fitted numbers.
    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64>;
}
