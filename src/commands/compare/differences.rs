//! How the runs of a group differ from its first, and whether that is within the tolerances.

use super::difference::{Difference, difference};
use super::figures::Figure;
use super::run::Group;
use super::tolerance::{Allowed, Judged, Tolerance, judge_figure, judge_trace};
use super::traces::Trace;
use crate::failure::Failure;

/// A figure of all runs, in their order; `None` where a run does not have it.
pub struct ComparedFigure {
    pub name: String,
    pub values: Vec<Option<Figure>>,
}

/// A trace of all runs but the first, against that of the first.
pub struct ComparedTrace {
    pub name: String,
    /// `None` where one of the two runs does not have it.
    pub differences: Vec<Option<Difference>>,
    /// Whether all runs have the same values at the same places, to the last digit.
    pub is_same: bool,
}

/// A tolerance and what was found of it in one run.
pub struct Check {
    pub name: String,
    pub run: String,
    pub allowed: Allowed,
    pub judged: Judged,
}

/// What was found of a group.
pub struct Differences {
    pub figures: Vec<ComparedFigure>,
    pub traces: Vec<ComparedTrace>,
    pub checks: Vec<Check>,
}

impl ComparedFigure {
    /// Whether all runs have the same.
    pub fn is_same(&self) -> bool {
        self.values.windows(2).all(|pair| match (&pair[0], &pair[1]) {
            (Some(a), Some(b)) => a.is_same(b),
            (a, b) => a.is_none() && b.is_none(),
        })
    }
}

/// Each name once, in the order in which they come.
fn once<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    names.fold(Vec::new(), |mut names, name| {
        if !names.contains(&name) {
            names.push(name);
        }
        names
    })
}

impl Differences {
    /// Compares the runs of a group over a column.
    pub fn of(group: &Group, axis: &str, tolerances: &[Tolerance]) -> Result<Self, Failure> {
        let axes = (group.runs.iter())
            .map(|run| run.traces.axis(axis, &run.name))
            .collect::<Result<Vec<_>, Failure>>()?;
        let same_places = axes.windows(2).all(|pair| pair[0] == pair[1]);
        let figure = |name: &str| ComparedFigure {
            name: name.to_owned(),
            values: group.runs.iter().map(|run| run.figure(name).cloned()).collect(),
        };
        let trace = |name: &str| {
            let columns: Vec<_> = group.runs.iter().map(|run| run.traces.trace(name)).collect();
            let same = |pair: &[Option<&Trace>]| matches!(pair, [Some(a), Some(b)] if a.is_same(b));
            ComparedTrace {
                name: name.to_owned(),
                differences: (columns.iter().zip(&axes).skip(1))
                    .map(|(own, places)| difference((axes[0], columns[0]?), (places, (*own)?)))
                    .collect(),
                is_same: same_places && columns.windows(2).all(same),
            }
        };
        let figures = group
            .runs
            .iter()
            .flat_map(|run| &run.figures)
            .map(|(name, _)| name.as_str());
        let traces = group
            .runs
            .iter()
            .flat_map(|run| run.traces.names())
            .filter(|name| *name != axis);
        let mut differences = Self {
            figures: once(figures).into_iter().map(figure).collect(),
            traces: once(traces).into_iter().map(trace).collect(),
            checks: Vec::new(),
        };
        if !(differences.traces.iter()).any(|trace| trace.differences.iter().any(Option::is_some)) {
            let names: Vec<&str> = group.runs.iter().map(|run| run.name.as_str()).collect();
            return Err(Failure::new(format!(
                "{}: have no trace in common but {axis}, or not at the same {}; give runs of one kind",
                names.join(", "),
                if axis == "time_s" { "time" } else { "place" }
            )));
        }
        differences.checks = (tolerances.iter())
            .flat_map(|tolerance| differences.judge(group, tolerance))
            .collect();
        Ok(differences)
    }

    /// A tolerance against every run but the first. What a run of this group does not have is not within.
    fn judge(&self, group: &Group, Tolerance { name, allowed }: &Tolerance) -> Vec<Check> {
        let figure = self.figures.iter().find(|figure| figure.name == *name);
        let trace = self.traces.iter().find(|trace| trace.name == *name);
        let noise = group.noise.get(name).copied();
        let judged = |run: usize| -> Option<Judged> {
            match (figure, trace) {
                (Some(figure), _) => {
                    let (first, own) = (figure.values[0].as_ref()?, figure.values[run].as_ref()?);
                    Some(judge_figure(*allowed, first, own))
                }
                (None, Some(trace)) => Some(judge_trace(*allowed, &trace.differences[run - 1]?, noise)),
                (None, None) => None,
            }
        };
        (1..group.runs.len())
            .map(|run| Check {
                name: name.clone(),
                run: group.runs[run].name.clone(),
                allowed: *allowed,
                judged: judged(run).unwrap_or(Judged::MISSING),
            })
            .collect()
    }

    /// Names of all traces.
    pub fn trace_names(&self) -> impl Iterator<Item = &str> {
        self.traces.iter().map(|trace| trace.name.as_str())
    }

    /// Names of all figures and traces.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.figures
            .iter()
            .map(|figure| figure.name.as_str())
            .chain(self.trace_names())
    }

    /// Numbers of figures and traces that are not the same in all runs.
    pub fn unequal(&self) -> (usize, usize) {
        (
            self.figures.iter().filter(|figure| !figure.is_same()).count(),
            self.traces.iter().filter(|trace| !trace.is_same).count(),
        )
    }
}
