//! How the runs of a group differ from its first, and whether that is within the tolerances.

use super::figures::Figure;
use super::run::Group;
use super::tolerance::{Allowed, Judged, Tolerance, judge_figure, judge_trace};
use super::traces::{Difference, difference};
use crate::failure::Failure;

/// A figure of all runs, in their order; `None` where a run does not have it.
pub struct ComparedFigure {
    pub name: String,
    pub values: Vec<Option<Figure>>,
}

/// A trace of all runs but the first, against that of the first.
pub struct ComparedTrace {
    pub name: String,
    pub differences: Vec<Option<Difference>>,
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
        self.values.windows(2).all(|pair| pair[0] == pair[1])
    }
}

impl ComparedTrace {
    /// Whether all runs have the same.
    pub fn is_same(&self) -> bool {
        (self.differences.iter()).all(|found| found.is_some_and(|difference| difference.is_none()))
    }
}

impl Differences {
    /// Compares the runs of a group over a column.
    pub fn of(group: &Group, axis: &str, tolerances: &[Tolerance]) -> Result<Self, Failure> {
        let (first, others) = group
            .runs
            .split_first()
            .ok_or_else(|| Failure::new("there is no run"))?;
        let axes = (group.runs.iter())
            .map(|run| run.traces.axis(axis, &run.name))
            .collect::<Result<Vec<_>, Failure>>()?;
        let mut names: Vec<&str> = Vec::new();
        for (name, _) in group.runs.iter().flat_map(|run| &run.figures) {
            if !names.contains(&name.as_str()) {
                names.push(name);
            }
        }
        let figures: Vec<ComparedFigure> = (names.into_iter())
            .map(|name| ComparedFigure {
                name: name.to_owned(),
                values: group.runs.iter().map(|run| run.figure(name).cloned()).collect(),
            })
            .collect();
        // A column that only the reference has is no trace to compare; one that some of the others lack is.
        let has = |name: &str| others.iter().any(|run| run.traces.trace(name).is_some());
        let traces: Vec<ComparedTrace> = (first.traces.names())
            .filter(|name| *name != axis && has(name))
            .map(|name| ComparedTrace {
                name: name.to_owned(),
                differences: (others.iter().zip(&axes[1..]))
                    .map(|(run, own)| difference((axes[0], first.traces.trace(name)?), (own, run.traces.trace(name)?)))
                    .collect(),
            })
            .collect();
        let mut differences = Self {
            figures,
            traces,
            checks: Vec::new(),
        };
        differences.checks = differences.judge(group, tolerances);
        Ok(differences)
    }

    /// Every tolerance against every run but the first.
    fn judge(&self, group: &Group, tolerances: &[Tolerance]) -> Vec<Check> {
        let mut checks = Vec::new();
        for Tolerance { name, allowed } in tolerances {
            let mut check = |run: usize, judged: Option<Judged>| {
                checks.push(Check {
                    name: name.clone(),
                    run: group.runs[run].name.clone(),
                    allowed: *allowed,
                    judged: judged.unwrap_or(Judged::MISSING),
                });
            };
            for figure in self.figures.iter().filter(|figure| figure.name == *name) {
                for run in 1..group.runs.len() {
                    let (first, own) = (figure.values[0].as_ref(), figure.values[run].as_ref());
                    check(
                        run,
                        first.zip(own).map(|(first, own)| judge_figure(*allowed, first, own)),
                    );
                }
            }
            for trace in self.traces.iter().filter(|trace| trace.name == *name) {
                for (i, found) in trace.differences.iter().enumerate() {
                    let noise = group.noise.get(name).copied();
                    check(i + 1, found.map(|found| judge_trace(*allowed, &found, noise)));
                }
            }
        }
        checks
    }

    /// Names of all figures and traces.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let figures = self.figures.iter().map(|figure| figure.name.as_str());
        figures.chain(self.traces.iter().map(|trace| trace.name.as_str()))
    }

    /// Numbers of figures and traces that are not the same in all runs.
    pub fn unequal(&self) -> (usize, usize) {
        (
            self.figures.iter().filter(|figure| !figure.is_same()).count(),
            self.traces.iter().filter(|trace| !trace.is_same()).count(),
        )
    }
}
