//! Thinning while reading: of a recording with more samples than are needed every third, fifth, ... is kept.

use super::columns::{ColumnKind, ColumnSpec};
use super::series::{Recording, median_interval};

/// Most samples kept of one recording. A campaign of ten such is still simulated in about a second.
pub const MAX_SAMPLES: usize = 200_000;
/// Longest sampling interval that thinning may make, s: of a recording with switching signals, whose edges must stay
/// where they were, and of any other. What is longer still is used from its start.
const MAX_THINNED_INTERVAL_S: (f64, f64) = (0.005, 0.05);
/// Rows at the start of a file by which its sampling interval is judged.
const FIRST_ROWS: usize = 64;

/// Keeps at most [`MAX_SAMPLES`]: the middle one of every `stride` rows, an odd number, so that the mean of an input over
/// them is the input at the kept instant. Nothing is lost that the comparison needs: the model is compared at the kept
/// instants.
pub struct Thinner {
    kinds: Vec<ColumnKind>,
    rows: usize,
    stride: usize,
    /// Rows of the group begun, then the first rows of the file until the interval is known.
    within: usize,
    first: Vec<(f64, Vec<f64>)>,
    settled: bool,
    time_s: Vec<f64>,
    columns: Vec<Vec<f64>>,
    sums: Vec<f64>,
    middle: (f64, Vec<f64>),
    full: bool,
}

/// Whether more rows are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Room {
    /// There is room for more rows.
    Left,
    /// No more rows are wanted.
    Full,
}

impl Thinner {
    /// A thinner for about `rows` rows.
    pub fn new(specs: &[ColumnSpec], rows: usize) -> Self {
        Self {
            kinds: specs.iter().map(|s| s.kind).collect(),
            rows,
            stride: 1,
            within: 0,
            first: Vec::new(),
            settled: rows <= MAX_SAMPLES,
            time_s: Vec::new(),
            columns: vec![Vec::new(); specs.len()],
            sums: vec![0.0; specs.len()],
            middle: (0.0, Vec::new()),
            full: false,
        }
    }

    /// Takes one row; says whether more are wanted.
    pub fn push(&mut self, time: f64, values: &[f64]) -> Room {
        if self.settled {
            self.keep(time, values);
        } else {
            self.first.push((time, values.to_vec()));
            if self.first.len() == FIRST_ROWS {
                self.settle();
            }
        }
        if self.time_s.len() >= MAX_SAMPLES {
            self.full = true;
            return Room::Full;
        }
        Room::Left
    }

    /// Chooses the stride by the interval of the first rows.
    fn settle(&mut self) {
        self.settled = true;
        let times: Vec<f64> = self.first.iter().map(|(t, _)| *t).collect();
        let longest = if self.kinds.contains(&ColumnKind::Switch) {
            MAX_THINNED_INTERVAL_S.0
        } else {
            MAX_THINNED_INTERVAL_S.1
        };
        let allowed = (longest / median_interval(&times).max(1e-9)) as usize;
        let wanted = self.rows.div_ceil(MAX_SAMPLES);
        self.stride = wanted.min(allowed).max(1) | 1;
        if self.stride > allowed.max(1) {
            self.stride -= 2;
        }
        for (time, values) in std::mem::take(&mut self.first) {
            self.keep(time, &values);
        }
    }

    fn keep(&mut self, time: f64, values: &[f64]) {
        self.sums.iter_mut().zip(values).for_each(|(s, &v)| *s += v);
        if self.within == self.stride / 2 {
            self.middle = (time, values.to_vec());
        }
        self.within += 1;
        if self.within < self.stride {
            return;
        }
        self.time_s.push(self.middle.0);
        for (((column, kind), sum), middle) in
            (self.columns.iter_mut().zip(&self.kinds).zip(&self.sums)).zip(&self.middle.1)
        {
            column.push(match kind {
                ColumnKind::Input => sum / self.stride as f64,
                ColumnKind::Output | ColumnKind::Switch => *middle,
            });
        }
        self.within = 0;
        self.sums.fill(0.0);
    }

    /// The recording, with a note of what was left out.
    pub fn finish(mut self, name: String) -> Recording {
        if !self.settled {
            self.settle();
        }
        let mut notes = Vec::new();
        if self.stride > 1 {
            notes.push(format!("one of every {} samples was used", self.stride));
        }
        if let (true, Some(last)) = (self.full, self.time_s.last()) {
            notes.push(format!(
                "only the first {MAX_SAMPLES} of these, up to {last} s, were used; to use all, record for a shorter time or at a lower rate"
            ));
        }
        Recording {
            name,
            time_s: self.time_s,
            columns: self.columns,
            notes,
        }
    }
}
