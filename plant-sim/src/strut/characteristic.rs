//! Tables as the solver reads them: a quantity over another, with its derivative.

/// A quantity over another, linear between points and beyond the ends.
///
/// ```
/// use oleo_plant_sim::strut::Characteristic;
/// let table = Characteristic::through(&[0.0, 1.0, 3.0], &[0.0, 10.0, 20.0]);
/// assert_eq!((table.value(2.0), table.value(5.0)), (15.0, 30.0));
/// // Value and derivative; the segment is remembered for the next call nearby.
/// assert_eq!(table.at(0.5, &mut 0), (5.0, 10.0));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Characteristic {
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

impl Characteristic {
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

    /// Value and derivative at an argument. `segment` remembers the last segment: successive calls are near each
    /// other, so the search is usually over before it begins. The result does not depend on it.
    #[inline(always)]
    pub fn at(&self, argument: f64, segment: &mut usize) -> (f64, f64) {
        let line = match self.lines.get(*segment) {
            Some(line) if argument > line.from && argument <= line.to => line,
            _ => {
                *segment = self.search(argument);
                &self.lines[*segment]
            }
        };
        (line.value + line.slope * argument, line.slope)
    }

    /// Value at an argument, where neither derivative nor neighbourhood matter.
    #[inline]
    #[must_use]
    pub fn value(&self, argument: f64) -> f64 {
        self.at(argument, &mut 0).0
    }

    /// Whether an argument lies on the segment that [`Characteristic::at`] remembered.
    #[inline(always)]
    pub(super) fn on_segment(&self, argument: f64, segment: usize) -> bool {
        self.lines
            .get(segment)
            .is_some_and(|line| argument > line.from && argument <= line.to)
    }

    #[cold]
    fn search(&self, argument: f64) -> usize {
        let inner = self.lines.len() - 1;
        self.lines[..inner].partition_point(|line| line.to < argument)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    proptest::proptest! {
        #[test]
        fn does_not_depend_on_the_remembered_segment(x in -5.0..5.0f64, hint in 0usize..9) {
            let table = Characteristic::through(&[-3.0, -0.4, 0.0, 0.2, 1.8], &[2.0, -1.0, 0.0, 1.0, 0.5]);
            let (mut a, mut b) = (0, hint);
            proptest::prop_assert_eq!(table.at(x, &mut a), table.at(x, &mut b));
        }
    }
}
