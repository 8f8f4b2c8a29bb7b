//! Damper packs: the measured pressure drop of a shim stack over flow, read from drop to flow.
//!
//! The packs are those of standard Land Rover rear dampers (seed report, 3.5.2); their law is a table, not a formula,
//! because shim stacks have none that is better than the measurement.

use serde::{Deserialize, Serialize};

/// Points of a damper's characteristic as they stand in `model.toml`, both columns strictly increasing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DamperTable {
    /// Flow, m3/s, positive out of the main cylinder (jounce).
    pub flow_m3_s: Vec<f64>,
    /// Pressure drop in the direction of that flow, Pa.
    #[serde(rename = "pressure_drop_Pa")]
    pub pressure_drop_pa: Vec<f64>,
}

impl DamperTable {
    /// The same shim stack with every pressure drop multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let pressure_drop_pa = self.pressure_drop_pa.iter().map(|p| p * factor).collect();
        Self {
            flow_m3_s: self.flow_m3_s.clone(),
            pressure_drop_pa,
        }
    }
}

/// A piecewise linear, strictly increasing characteristic, linear beyond its ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Pack {
    lines: Box<[Line]>,
}

/// `value + slope * argument` for arguments above `from` and up to `to`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Line {
    from: f64,
    to: f64,
    value: f64,
    slope: f64,
}

impl Pack {
    /// From pressure drop to flow, as the recordings' model reads the table.
    #[must_use]
    pub fn from_table(table: &DamperTable) -> Self {
        Self::through(&table.pressure_drop_pa, &table.flow_m3_s)
    }

    /// The line through points `(x, y)`, at least two, `x` strictly increasing (the model checks both).
    #[must_use]
    pub fn through(x: &[f64], y: &[f64]) -> Self {
        let mut lines: Box<[Line]> = x
            .windows(2)
            .zip(y.windows(2))
            .map(|(x, y)| {
                let slope = (y[1] - y[0]) / (x[1] - x[0]);
                Line {
                    from: x[0],
                    to: x[1],
                    value: y[0] - slope * x[0],
                    slope,
                }
            })
            .collect();
        if let [first, ..] = &mut lines[..] {
            first.from = f64::NEG_INFINITY;
        }
        if let [.., last] = &mut lines[..] {
            last.to = f64::INFINITY;
        }
        Self { lines }
    }

    /// Flow and its derivative at a pressure drop. `segment` remembers the last segment: successive calls are near each
    /// other, so the search is usually over before it begins. The result does not depend on it.
    #[inline(always)]
    pub fn flow(&self, drop_pa: f64, segment: &mut usize) -> (f64, f64) {
        let line = match self.lines.get(*segment) {
            Some(line) if drop_pa > line.from && drop_pa <= line.to => line,
            _ => {
                *segment = self.search(drop_pa);
                &self.lines[*segment]
            }
        };
        (line.value + line.slope * drop_pa, line.slope)
    }

    /// Whether a drop lies on the segment that [`Pack::flow`] remembered.
    #[inline(always)]
    pub(super) fn on_segment(&self, drop_pa: f64, segment: usize) -> bool {
        self.lines
            .get(segment)
            .is_some_and(|line| drop_pa > line.from && drop_pa <= line.to)
    }

    #[cold]
    fn search(&self, drop_pa: f64) -> usize {
        let inner = self.lines.len() - 1;
        self.lines[..inner].partition_point(|line| line.to < drop_pa)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> DamperTable {
        DamperTable {
            flow_m3_s: vec![-2e-3, -1e-4, 0.0, 1e-4, 2e-3],
            pressure_drop_pa: vec![-3e6, -4e5, 0.0, 2e5, 1.8e6],
        }
    }

    #[test]
    fn passes_through_its_points_and_goes_on_straight() {
        let (table, mut segment) = (table(), 0);
        let pack = Pack::from_table(&table);
        for (q, p) in table.flow_m3_s.iter().zip(&table.pressure_drop_pa) {
            assert!((pack.flow(*p, &mut segment).0 - q).abs() < 1e-15);
        }
        let (q, slope) = pack.flow(3.4e6, &mut segment);
        assert!((slope - 1.9e-3 / 1.6e6).abs() < 1e-18 && (q - (2e-3 + 1.6e6 * slope)).abs() < 1e-12);
    }

    proptest::proptest! {
        #[test]
        fn does_not_depend_on_the_remembered_segment(p in -5e6..5e6f64, hint in 0usize..9) {
            let pack = Pack::from_table(&table());
            let (mut a, mut b) = (0, hint);
            proptest::prop_assert_eq!(pack.flow(p, &mut a), pack.flow(p, &mut b));
        }
    }
}
