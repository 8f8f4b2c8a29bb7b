//! Tables as the solver reads them: a quantity over another, with its derivative.

use crate::lanes::Number;

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

/// `value + slope * argument` for arguments above `from` and up to `to`; of one table, or of several side by side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line<N = f64> {
    from: N,
    to: N,
    value: N,
    slope: N,
}

impl<N: Number> Line<N> {
    /// Where an argument belongs to the line.
    #[inline(always)]
    pub fn holds(&self, argument: N) -> N::Mask {
        argument.above(self.from) & argument.up_to(self.to)
    }

    /// Value and derivative at an argument that belongs to the line.
    #[inline(always)]
    pub fn at(&self, argument: N) -> (N, N) {
        (self.value + self.slope * argument, self.slope)
    }

    /// The lines that several tables read at segments that they remember, one table in each lane; `like` is any number of their kind.
    #[inline(always)]
    pub fn remembered(tables: &N::Each<Characteristic>, segments: &N::Each<usize>, like: N) -> Self {
        let line = |lane: usize| tables.as_ref()[lane].remembered(segments.as_ref()[lane]);
        Self {
            from: like.gather(|lane| line(lane).from),
            to: like.gather(|lane| line(lane).to),
            value: like.gather(|lane| line(lane).value),
            slope: like.gather(|lane| line(lane).slope),
        }
    }

    /// The lines to which arguments belong, and their segments.
    #[cold]
    #[inline(never)]
    pub fn found(tables: &N::Each<Characteristic>, segments: &mut N::Each<usize>, argument: N) -> Self {
        for (lane, (table, segment)) in tables.as_ref().iter().zip(segments.as_mut()).enumerate() {
            *segment = table.search(argument.lane(lane));
        }
        Self::remembered(tables, segments, argument)
    }
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
        match self.lines.get(*segment) {
            Some(line) if line.holds(argument) => line.at(argument),
            _ => {
                *segment = self.search(argument);
                self.lines[*segment].at(argument)
            }
        }
    }

    /// Value at an argument, where neither derivative nor neighbourhood matter.
    #[inline]
    #[must_use]
    pub fn value(&self, argument: f64) -> f64 {
        self.at(argument, &mut 0).0
    }

    /// The line of a segment that was remembered, and the first one where another table remembered it.
    #[inline(always)]
    fn remembered(&self, segment: usize) -> &Line {
        self.lines.get(segment).unwrap_or(&self.lines[0])
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
