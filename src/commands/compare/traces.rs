//! Columns of a CSV file, and how those of two runs differ along a common axis.

use std::cmp::Ordering;
use std::path::Path;

use crate::failure::Failure;

/// The columns of a run, of one length.
#[derive(Clone, Debug, Default)]
pub struct Traces {
    columns: Vec<(String, Trace)>,
}

/// The values of one column.
#[derive(Clone, Debug, PartialEq)]
pub enum Trace {
    /// A quantity. It is interpolated between samples; NaN is "not defined here".
    Quantity(Vec<f64>),
    /// A signal or a state, as text. It is held until the next sample.
    State(Vec<String>),
}

/// How far a trace is from that of the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Difference {
    /// Of a quantity, in its unit.
    Quantity {
        /// RMS of the difference.
        rms: f64,
        /// RMS of the reference at the same places.
        reference_rms: f64,
        /// Largest difference, with its sign.
        largest: f64,
        /// Where on the axis it is.
        at: f64,
    },
    /// Share of the samples in which a state differs, 0 to 1.
    State(f64),
}

impl Traces {
    /// Columns of numbers by name.
    pub fn of(columns: impl IntoIterator<Item = (String, Vec<f64>)>) -> Self {
        let columns = columns.into_iter().map(|(name, values)| {
            let trace = match is_state(&name) {
                true => Trace::State(values.iter().map(f64::to_string).collect()),
                false => Trace::Quantity(values),
            };
            (name, trace)
        });
        Self {
            columns: columns.collect(),
        }
    }

    /// All columns of a CSV file. An empty cell of a quantity is not defined.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let file = path.display();
        let bad = |error: csv::Error| {
            Failure::new(format!(
                "{file}: cannot be read: {error}; give a folder of results or a CSV file with a header"
            ))
        };
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_path(path)
            .map_err(bad)?;
        let names: Vec<String> = reader.headers().map_err(bad)?.iter().map(str::to_owned).collect();
        let mut cells: Vec<Vec<String>> = vec![Vec::new(); names.len()];
        for row in reader.records() {
            for (column, cell) in cells.iter_mut().zip(&row.map_err(bad)?) {
                column.push(cell.to_owned());
            }
        }
        let columns = names.into_iter().zip(cells).map(|(name, cells)| {
            let is_word = |cell: &&String| !cell.is_empty() && cell.parse::<f64>().is_err();
            let trace = match (is_state(&name), cells.iter().position(|cell| is_word(&cell))) {
                (true, _) => Trace::State(cells),
                (false, None) => Trace::Quantity(cells.iter().map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()),
                (false, Some(row)) => {
                    return Err(Failure::new(format!(
                        "{file}:{}: {name} is {:?}; a number is needed",
                        row + 2,
                        cells[row]
                    )));
                }
            };
            Ok((name, trace))
        });
        Ok(Self {
            columns: columns.collect::<Result<_, Failure>>()?,
        })
    }

    /// Names in the order of the file.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|(name, _)| name.as_str())
    }

    /// A column.
    pub fn trace(&self, name: &str) -> Option<&Trace> {
        (self.columns.iter().find(|(known, _)| known == name)).map(|(_, trace)| trace)
    }

    /// The column over which the others are compared. It must increase from the first sample to the last.
    pub fn axis(&self, name: &str, run: &str) -> Result<&[f64], Failure> {
        let Some(Trace::Quantity(axis)) = self.trace(name) else {
            return Err(Failure::new(format!(
                "{run}: there is no column {name}, over which runs are compared"
            )));
        };
        match axis
            .windows(2)
            .position(|pair| pair[1].partial_cmp(&pair[0]) != Some(Ordering::Greater))
        {
            None if axis.len() > 1 => Ok(axis),
            None => Err(Failure::new(format!(
                "{run}: {name} has {} samples; two or more are needed",
                axis.len()
            ))),
            Some(row) => Err(Failure::new(format!(
                "{run}: {name} does not increase at {}; compare over another axis with --over",
                axis[row + 1]
            ))),
        }
    }
}

/// Whether a column is a signal or a state, whose values between samples mean nothing: a word, or a number without a unit.
fn is_state(name: &str) -> bool {
    const STATES: [&str; 4] = ["mode", "fault", "handling", "rollover_guard"];
    STATES.contains(&name)
        || name.ends_with("_word")
        || name.ends_with("_open")
        || numbered(name, "valve")
        || numbered(name, "acting")
}

fn numbered(name: &str, stem: &str) -> bool {
    name.strip_prefix(stem)
        .is_some_and(|number| number.parse::<u8>().is_ok())
}

/// The values of a trace at each place of another axis, between the samples of its own; NaN outside.
pub fn at_places(places: &[f64], axis: &[f64], values: &[f64]) -> Vec<f64> {
    (places.iter().zip(segments(places, axis)))
        .map(|(&place, segment)| match segment {
            None => f64::NAN,
            Some(i) if axis[i] == place => values[i],
            Some(i) => {
                let share = (place - axis[i]) / (axis[i + 1] - axis[i]);
                values[i] + share * (values[i + 1] - values[i])
            }
        })
        .collect()
}

/// The last sample of an axis that is not beyond each of the places, which increase; `None` outside of the axis.
fn segments(places: &[f64], axis: &[f64]) -> Vec<Option<usize>> {
    let mut i = 0;
    (places.iter())
        .map(|&place| {
            while i + 1 < axis.len() && axis[i + 1] <= place {
                i += 1;
            }
            let inside = axis[0] <= place && (place <= axis[i] || i + 1 < axis.len());
            inside.then_some(i)
        })
        .collect()
}

/// How a trace differs from that of the reference, at the reference's samples that both runs have. `None` if they have none in
/// common, or if the one is a quantity and the other a state.
pub fn difference(reference: (&[f64], &Trace), other: (&[f64], &Trace)) -> Option<Difference> {
    let (places, axis) = (reference.0, other.0);
    match (reference.1, other.1) {
        (Trace::Quantity(a), Trace::Quantity(b)) => {
            let b = at_places(places, axis, b);
            let pairs: Vec<[f64; 3]> = (places.iter().zip(a).zip(b))
                .map(|((&place, &a), b)| [place, a, b - a])
                .filter(|[_, _, apart]| apart.is_finite())
                .collect();
            let rms = |of: fn(&[f64; 3]) -> f64| {
                (pairs.iter().map(|pair| of(pair) * of(pair)).sum::<f64>() / pairs.len() as f64).sqrt()
            };
            let [at, _, largest] =
                *(pairs.iter()).reduce(|most, pair| if pair[2].abs() > most[2].abs() { pair } else { most })?;
            Some(Difference::Quantity {
                rms: rms(|pair| pair[2]),
                reference_rms: rms(|pair| pair[1]),
                largest,
                at,
            })
        }
        (Trace::State(a), Trace::State(b)) => {
            let pairs: Vec<bool> = (a.iter().zip(segments(places, axis)))
                .filter_map(|(a, segment)| Some(*a != b[segment?]))
                .collect();
            let differ = pairs.iter().filter(|differs| **differs).count();
            (!pairs.is_empty()).then(|| Difference::State(differ as f64 / pairs.len() as f64))
        }
        _ => None,
    }
}

impl Difference {
    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        match self {
            Self::Quantity { largest, .. } => *largest == 0.0,
            Self::State(share) => *share == 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_is_the_same_on_any_grid() {
        let coarse = [0.0, 1.0, 2.0];
        let fine: Vec<f64> = (0..=8).map(|i| 0.25 * f64::from(i)).collect();
        let line = |axis: &[f64]| Trace::Quantity(axis.iter().map(|x| 3.0 * x - 1.0).collect());
        for (a, b) in [(&coarse[..], &fine[..]), (&fine, &coarse)] {
            let found = difference((a, &line(a)), (b, &line(b))).expect("in common");
            assert!(found.is_none(), "{found:?}");
        }
    }

    #[test]
    fn only_what_both_have_is_compared() {
        let (a, b) = ([0.0, 1.0, 2.0, 3.0], [1.0, 2.0, 2.5]);
        let (high, low) = (
            Trace::Quantity(vec![9.0, 1.0, 1.0, 9.0]),
            Trace::Quantity(vec![1.0, 3.0, 1.0]),
        );
        assert_eq!(
            difference((&a, &high), (&b, &low)),
            Some(Difference::Quantity {
                rms: 2.0_f64.sqrt(),
                reference_rms: 1.0,
                largest: 2.0,
                at: 2.0
            })
        );
        assert_eq!(
            difference((&a, &high), (&[5.0, 6.0], &Trace::Quantity(vec![0.0; 2]))),
            None
        );
    }

    #[test]
    fn a_state_is_held_and_not_interpolated() {
        let state = |words: &[&str]| Trace::State(words.iter().map(|word| (*word).to_owned()).collect());
        let (a, b) = ([0.0, 1.0, 2.0, 3.0], [0.0, 2.5, 4.0]);
        let found = difference((&a, &state(&["x", "x", "y", "y"])), (&b, &state(&["x", "y", "y"])));
        assert_eq!(found, Some(Difference::State(0.25)));
    }
}
