//! Measures the points of the curves, repeat by repeat, and takes medians.

use std::path::Path;

use oleo_report::Progress;

use super::curve::Curve;
use super::growth::{Growth, Kind};
use super::instructions;
use super::point::Point;
use super::process::{Spent, apart};
use crate::failure::Failure;

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    /// Few small points only.
    pub quick: bool,
    /// Repeats of a point.
    pub repeats: u32,
    /// Whether instructions are counted.
    pub instructions: bool,
}

/// A point whose repeats have taken this long together, s, is measured [`FEWEST_REPEATS`] times only.
const LONG_S: f64 = 20.0;
/// Repeats of a point that takes long, if so many are asked for.
const FEWEST_REPEATS: usize = 3;

/// Median of repeats with the least and the largest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Median {
    pub median: f64,
    pub low: f64,
    pub high: f64,
}

impl Median {
    /// Of values of which there is at least one.
    fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let n = values.len();
        let at = |k: usize| values.get(k).copied().unwrap_or(f64::NAN);
        Self {
            median: 0.5 * (at(n.saturating_sub(1) / 2) + at(n / 2)),
            low: at(0),
            high: at(n.saturating_sub(1)),
        }
    }
}

/// A point as measured.
#[derive(Clone, Debug)]
pub struct MeasuredPoint {
    pub size: u64,
    pub repeats: usize,
    pub processor_s: Median,
    pub wall_s: Median,
    pub peak_memory_bytes: Option<f64>,
    pub operations: u64,
    pub instructions: Option<u64>,
    pub outcome: String,
}

/// A curve as measured.
#[derive(Clone, Debug)]
pub struct MeasuredCurve {
    pub curve: Curve,
    pub points: Vec<MeasuredPoint>,
}

/// How the peak memory grows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MemoryGrowth {
    /// Largest over smallest peak of the curve.
    pub ratio: f64,
    /// Bytes for each further unit of work over the larger half of the points.
    pub bytes_per_unit: f64,
}

/// Peak memory that grows by less than this factor over a curve counts as constant.
const CONSTANT_MEMORY: f64 = 1.25;

/// Operations whose number for each unit of work varies by less than this factor are in proportion to it.
const PROPORTION: f64 = 1.1;

impl MemoryGrowth {
    /// Whether the memory does not depend on the work.
    pub fn is_constant(&self) -> bool {
        self.ratio < CONSTANT_MEMORY
    }
}

impl MeasuredCurve {
    /// Work at the points.
    pub fn work(&self) -> Vec<f64> {
        self.points.iter().map(|point| point.size as f64).collect()
    }

    /// Median processor time at the points, s.
    pub fn processor_s(&self) -> Vec<f64> {
        self.points.iter().map(|point| point.processor_s.median).collect()
    }

    /// Growth of the processor time over all points.
    pub fn growth(&self) -> Option<Growth> {
        Growth::of(&self.work(), &self.processor_s())
    }

    /// The same over the larger half, by which the curve is judged.
    pub fn growth_of_large(&self) -> Option<Growth> {
        Growth::of_large(&self.work(), &self.processor_s())
    }

    /// Growth of the time of one operation over the larger half, where their number is not in proportion to the work: a search takes more or
    /// fewer turns with other data.
    pub fn growth_of_operation(&self) -> Option<Growth> {
        let in_proportion: Vec<f64> = (self.points.iter())
            .map(|point| point.operations as f64 / point.size as f64)
            .collect();
        let most = in_proportion.iter().copied().fold(0.0, f64::max);
        let least = in_proportion.iter().copied().fold(f64::INFINITY, f64::min);
        let each: Vec<f64> = (self.points.iter())
            .map(|point| point.processor_s.median / point.operations as f64)
            .collect();
        (most > PROPORTION * least)
            .then(|| Growth::of_large(&self.work(), &each))
            .flatten()
    }

    /// Growth of the instructions over the points where they were counted.
    pub fn growth_of_instructions(&self) -> Option<Growth> {
        let counted: Vec<(f64, f64)> = (self.points.iter())
            .filter_map(|point| Some((point.size as f64, point.instructions? as f64)))
            .collect();
        let (work, cost): (Vec<f64>, Vec<f64>) = counted.into_iter().unzip();
        Growth::of(&work, &cost)
    }

    /// What the curve is judged to be.
    pub fn kind(&self) -> Kind {
        self.growth_of_large().map_or(Kind::Undecided, |growth| growth.kind())
    }

    /// Growth of the peak memory; `None` where the system does not tell it.
    pub fn memory(&self) -> Option<MemoryGrowth> {
        let peaks: Vec<(f64, f64)> = (self.points.iter())
            .filter_map(|point| Some((point.size as f64, point.peak_memory_bytes?)))
            .collect();
        let least = peaks.iter().map(|peak| peak.1).fold(f64::INFINITY, f64::min);
        let most = peaks.iter().map(|peak| peak.1).fold(0.0, f64::max);
        let (first, last) = (peaks.get(peaks.len() / 2)?, peaks.last()?);
        let before = if first.0 < last.0 { first } else { peaks.first()? };
        (before.0 < last.0).then(|| MemoryGrowth {
            ratio: most / least,
            bytes_per_unit: (last.1 - before.1) / (last.0 - before.0),
        })
    }

    /// How much more the unit of work costs at the smallest point than at the largest.
    pub fn small_over_large(&self) -> Option<f64> {
        let of_unit = |point: &MeasuredPoint| point.processor_s.median / point.size as f64;
        Some(of_unit(self.points.first()?) / of_unit(self.points.last()?))
    }

    /// The curve in a sentence.
    pub fn in_words(&self) -> String {
        let (least, most) = match (self.points.first(), self.points.last()) {
            (Some(first), Some(last)) => (first.size, last.size),
            _ => (0, 0),
        };
        let unit = self.curve.unit();
        let mut text = format!(
            "{}, {least} to {most} {unit}: the time {}",
            self.curve.in_words(),
            self.kind().in_words()
        );
        if let Some(large) = self.growth_of_large() {
            text += &format!(
                " (exponent {:.2}, 95 % interval {:.2} to {:.2}, over the larger half of the points)",
                large.exponent, large.low, large.high
            );
        }
        if let Some(each) = self.growth_of_operation() {
            text += &format!(
                "; that of one {} {} (exponent {:.2}, {:.2} to {:.2}), and how many there are depends on the data",
                self.curve.operation(),
                each.kind().in_words(),
                each.exponent,
                each.low,
                each.high
            );
        }
        if let Some(ratio) = self.small_over_large() {
            text +=
                &format!("; of the smallest point one of the {unit} costs {ratio:.2} times as much as of the largest");
        }
        text += &match self.memory() {
            None => "; this system does not tell the peak memory.".to_owned(),
            Some(memory) if memory.is_constant() => "; the peak memory is constant.".to_owned(),
            Some(memory) => format!(
                "; the peak memory grows by {:.0} bytes for each of the {unit}.",
                memory.bytes_per_unit
            ),
        };
        text
    }
}

/// Measures curves.
pub fn measure(curves: &[Curve], extent: &Extent, scratch: &Path) -> Result<Vec<MeasuredCurve>, Failure> {
    let points: Vec<Point> = (curves.iter())
        .flat_map(|&curve| curve.sizes(extent.quick).iter().map(move |&size| Point { curve, size }))
        .collect();
    let counting = u64::from(extent.instructions);
    let progress = Progress::new("bench", points.len() as u64 * (u64::from(extent.repeats) + counting));
    let mut spent: Vec<Vec<Spent>> = points.iter().map(|_| Vec::new()).collect();
    for repeat in 1..=extent.repeats {
        for (point, spent) in points.iter().zip(&mut spent) {
            progress.phase(&format!("{}, repeat {repeat} of {}", point.curve, extent.repeats));
            let is_long = spent.iter().map(|once| once.wall_s).sum::<f64>() > LONG_S;
            if !(is_long && spent.len() >= FEWEST_REPEATS) {
                spent.push(once(*point, scratch, spent.first())?);
            }
            progress.add(1);
        }
    }
    let mut measured: Vec<MeasuredCurve> = Vec::new();
    for (point, spent) in points.iter().zip(&spent) {
        let mut median = of_repeats(point.size, spent);
        if extent.instructions {
            progress.phase(&format!("{}, instructions", point.curve));
            if median.processor_s.median < instructions::LONGEST_S {
                median.instructions = Some(instructions::of(*point, scratch)?);
            }
            progress.add(1);
        }
        match measured.last_mut().filter(|last| last.curve == point.curve) {
            Some(last) => last.points.push(median),
            None => measured.push(MeasuredCurve {
                curve: point.curve,
                points: vec![median],
            }),
        }
    }
    Ok(measured)
}

/// Measures a point once, and holds what it computed against the first time.
fn once(point: Point, scratch: &Path, first: Option<&Spent>) -> Result<Spent, Failure> {
    let spent = apart(point, scratch)?;
    match first {
        Some(first) if (first.operations, &first.outcome) != (spent.operations, &spent.outcome) => {
            Err(point.failed("two repeats did not compute the same; this is a fault of oleo"))
        }
        _ => Ok(spent),
    }
}

fn of_repeats(size: u64, spent: &[Spent]) -> MeasuredPoint {
    let median = |of: fn(&Spent) -> f64| Median::of(spent.iter().map(of).collect());
    let peaks: Option<Vec<f64>> = (spent.iter())
        .map(|once| once.peak_memory_bytes.map(|bytes| bytes as f64))
        .collect();
    MeasuredPoint {
        size,
        repeats: spent.len(),
        processor_s: median(|once| once.processor_s),
        wall_s: median(|once| once.wall_s),
        peak_memory_bytes: peaks.map(|peaks| Median::of(peaks).median),
        operations: spent.first().map_or(0, |once| once.operations),
        instructions: None,
        outcome: spent.first().map_or_else(String::new, |once| once.outcome.clone()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(cost: impl Fn(f64) -> f64, peak: impl Fn(f64) -> f64) -> MeasuredCurve {
        let point = |&size: &u64| {
            let spent = |factor: f64| Spent {
                processor_s: factor * cost(size as f64),
                wall_s: cost(size as f64),
                peak_memory_bytes: Some(peak(size as f64) as u64),
                operations: size,
                outcome: "same".to_owned(),
            };
            of_repeats(size, &[spent(1.0), spent(3.0), spent(0.9)])
        };
        MeasuredCurve {
            curve: Curve::LogFrames,
            points: [1_000, 10_000, 100_000, 1_000_000].iter().map(point).collect(),
        }
    }

    #[test]
    fn a_disturbed_repeat_moves_no_median() {
        let median = Median::of(vec![1.0, 30.0, 0.9]);
        assert_eq!((median.median, median.low, median.high), (1.0, 0.9, 30.0));
        assert_eq!(Median::of(vec![1.0, 2.0]).median, 1.5);
    }

    #[test]
    fn a_linear_curve_with_constant_memory_is_called_so() {
        let linear = curve(|size| 1e-6 * size, |_| 12e6);
        assert_eq!(linear.kind(), Kind::Linear);
        assert!(linear.memory().expect("a memory").is_constant());
        assert!(
            linear.in_words().contains("is linear in the work") && linear.in_words().contains("memory is constant"),
            "{}",
            linear.in_words()
        );
    }

    #[test]
    fn a_search_with_other_turns_is_judged_by_its_operation() {
        let mut search = curve(|size| 1e-6 * size, |_| 12e6);
        assert_eq!(search.growth_of_operation(), None);
        for (point, turns) in search.points.iter_mut().zip([900_u32, 400, 1100, 600]) {
            point.processor_s.median *= f64::from(turns);
            point.operations = u64::from(turns);
        }
        let each = search.growth_of_operation().expect("a fit");
        assert!((each.exponent - 1.0).abs() < 1e-9, "{each:?}");
        assert!(
            search.in_words().contains("that of one frame is linear"),
            "{}",
            search.in_words()
        );
    }

    #[test]
    fn a_square_law_and_memory_a_unit_are_called_so() {
        let square = curve(|size| 1e-9 * size * size, |size| 8e6 + 500.0 * size);
        assert_eq!(square.kind(), Kind::FasterThanLinear);
        let memory = square.memory().expect("a memory");
        assert!(!memory.is_constant() && (memory.bytes_per_unit - 500.0).abs() < 1e-6);
        assert!(
            square.in_words().contains("500 bytes for each of the frames"),
            "{}",
            square.in_words()
        );
    }
}
