//! A value that is as believed until a moment, changes at a constant rate for a while, and then stays: what breaks, lodges, opens or runs dry while it
//! is recorded.

use oleo_plant_sim::strut::UnlistedLaw;

use super::form::{ClosedForm, Form, Grid};
use crate::parameter::Parameter;

/// First moment after the start that is tried, s, and each over the one before: what is seen in a short recording is not seen in steps of a long one.
const FIRST_S: f64 = 0.5;
const RATIO: f64 = 1.5;
/// Duration of the change with which a moment is tried, over the moment.
const PART: f64 = 0.4;
/// Shortest and longest change, s.
const CHANGES_FOR_S: (f64, f64) = (0.01, 3000.0);
/// Latest moment, s.
const LATEST_S: f64 = 3600.0;
/// Largest logarithm of a factor.
const MOST_LOG: f64 = 3.0;
/// Least factor of another form that is followed.
const LEAST: f64 = 1e-3;

/// What changes.
pub enum Onset {
    /// A value that is added; the key of its value in the end.
    Added(&'static str),
    /// The same of a value that is never negative.
    Level(&'static str),
    /// A value that multiplies what is believed.
    Factor,
}

impl Form for Onset {
    fn closed(&self) -> Option<ClosedForm> {
        Some(match self {
            Self::Added(_) | Self::Level(_) => ClosedForm {
                equation: "y = y_e min(max((x - t_0) / T, 0), 1)",
                symbols: &["y_e", "t_0", "T"],
            },
            Self::Factor => ClosedForm {
                equation: "y = exp(a min(max((x - t_0) / T, 0), 1))",
                symbols: &["a", "t_0", "T"],
            },
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        let most = grid.most();
        let size = match self {
            Self::Added(key) => Parameter::departure(*key, grid.visible, (-most, most)),
            Self::Level(key) => Parameter::amount(*key, grid.visible, most),
            Self::Factor => Parameter::departure("log_factor_in_the_end", grid.visible, (-MOST_LOG, MOST_LOG)),
        };
        vec![
            size,
            Parameter::linear("begins_at_s", 0.0, 1.0, (0.0, LATEST_S)),
            Parameter::log("changes_for_s", 1.0, CHANGES_FOR_S),
        ]
    }

    fn starts(&self, grid: &Grid) -> Vec<Vec<f64>> {
        let moments = std::iter::successors(Some(FIRST_S), |moment| Some(RATIO * moment));
        std::iter::once((0.0, FIRST_S))
            .chain(moments.map(|moment| (moment, PART * moment)))
            .take_while(|(moment, _)| *moment < grid.longest_s)
            .map(|(moment, lasts_s)| vec![3.0 * grid.visible, moment, lasts_s])
            .collect()
    }

    /// Before the change, at its beginning, at its end and after it: the table is flat beyond its points.
    fn argument(&self, _grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let &[_, begins_at_s, changes_for_s] = fitted else {
            return vec![0.0, 1.0, 2.0, 3.0];
        };
        let ends_at_s = begins_at_s + changes_for_s;
        vec![
            begins_at_s - changes_for_s,
            begins_at_s,
            ends_at_s,
            ends_at_s + changes_for_s,
        ]
    }

    /// Half of the longest recording leads from none to what a law has in the end.
    fn near(&self, grid: &Grid, law: &UnlistedLaw) -> Option<Vec<f64>> {
        let in_the_end = law.characteristic().value(grid.longest_s);
        let size = match self {
            Self::Added(_) => in_the_end,
            Self::Level(_) => in_the_end.max(0.0),
            Self::Factor => libm::log(in_the_end.max(LEAST)),
        };
        Some(vec![size, 0.0, 0.5 * grid.longest_s])
    }

    fn values(&self, _grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let size = fitted.first().copied().unwrap_or(0.0);
        let changed = [0.0, 0.0, size, size];
        match self {
            Self::Added(_) | Self::Level(_) => changed.to_vec(),
            Self::Factor => changed.map(libm::exp).to_vec(),
        }
    }
}
