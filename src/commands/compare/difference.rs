//! How far a trace is from that of the reference.

use super::traces::Trace;

/// A difference at the samples of the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// How large it is.
    pub size: Size,
    /// Share of the samples of the reference at which there is something to compare, 0 to 1: at the others one of the runs has ended, or
    /// is not defined.
    pub compared: f64,
}

/// How large a difference is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Size {
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

/// The values of a quantity at places of another axis, between the samples of its own; NaN outside.
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

/// The difference of a trace from that of the reference. `None` if they have nothing in common, or if the one is a quantity and the
/// other a state.
pub fn difference(reference: (&[f64], &Trace), other: (&[f64], &Trace)) -> Option<Difference> {
    let (places, axis) = (reference.0, other.0);
    match (reference.1, other.1) {
        (Trace::Quantity(a), Trace::Quantity(b)) => of_quantity(places, a, &at_places(places, axis, b)),
        (Trace::State(a), Trace::State(b)) => {
            let pairs: Vec<bool> = (a.iter().zip(segments(places, axis)))
                .filter_map(|(a, segment)| Some(*a != b[segment?]))
                .collect();
            let differ = pairs.iter().filter(|differs| **differs).count();
            (!pairs.is_empty()).then(|| Difference {
                size: Size::State(differ as f64 / pairs.len() as f64),
                compared: pairs.len() as f64 / places.len() as f64,
            })
        }
        _ => None,
    }
}

/// Where neither is defined the two agree; where one is not, they cannot be compared.
fn of_quantity(places: &[f64], a: &[f64], b: &[f64]) -> Option<Difference> {
    let pairs: Vec<[f64; 3]> = (places.iter().zip(a).zip(b))
        .filter(|((_, a), b)| !a.is_nan() && !b.is_nan())
        // Two equal infinities are not apart.
        .map(|((&place, &a), &b)| [place, a, if a == b { 0.0 } else { b - a }])
        .collect();
    let neither = a.iter().zip(b).filter(|(a, b)| a.is_nan() && b.is_nan()).count();
    let rms = |of: fn(&[f64; 3]) -> f64| {
        (pairs.iter().map(|pair| of(pair) * of(pair)).sum::<f64>() / pairs.len() as f64).sqrt()
    };
    let [at, _, largest] =
        *(pairs.iter()).reduce(|most, pair| if pair[2].abs() > most[2].abs() { pair } else { most })?;
    Some(Difference {
        size: Size::Quantity {
            rms: rms(|pair| pair[2]),
            reference_rms: rms(|pair| pair[1]),
            largest,
            at,
        },
        compared: (pairs.len() + neither) as f64 / places.len() as f64,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quantity(values: &[f64]) -> Trace {
        Trace::Quantity(values.to_vec())
    }

    #[test]
    fn a_straight_line_is_the_same_on_any_grid() {
        let coarse = [0.0, 1.0, 2.0];
        let fine: Vec<f64> = (0..=8).map(|i| 0.25 * f64::from(i)).collect();
        let line = |axis: &[f64]| Trace::Quantity(axis.iter().map(|x| 3.0 * x - 1.0).collect());
        for (a, b) in [(&coarse[..], &fine[..]), (&fine, &coarse)] {
            let found = difference((a, &line(a)), (b, &line(b))).expect("in common");
            assert!(
                matches!(found.size, Size::Quantity { largest: 0.0, .. }) && found.compared == 1.0,
                "{found:?}"
            );
        }
    }

    #[test]
    fn only_what_both_have_is_compared_and_its_share_is_told() {
        let (a, b) = ([0.0, 1.0, 2.0, 3.0], [1.0, 2.0, 2.5]);
        let found = difference(
            (&a, &quantity(&[9.0, 1.0, 1.0, 9.0])),
            (&b, &quantity(&[1.0, 3.0, 1.0])),
        );
        let size = Size::Quantity {
            rms: 2.0_f64.sqrt(),
            reference_rms: 1.0,
            largest: 2.0,
            at: 2.0,
        };
        assert_eq!(found, Some(Difference { size, compared: 0.5 }));
        assert_eq!(
            difference((&a, &quantity(&[0.0; 4])), (&[5.0, 6.0], &quantity(&[0.0; 2]))),
            None
        );
    }

    #[test]
    fn what_is_not_defined_in_both_agrees_and_an_infinity_is_a_difference() {
        let (axis, nan) = ([0.0, 1.0, 2.0, 3.0], f64::NAN);
        let of = |a: &[f64], b: &[f64]| difference((&axis, &quantity(a)), (&axis, &quantity(b))).expect("in common");
        assert_eq!(of(&[1.0, nan, 1.0, nan], &[1.0, nan, nan, nan]).compared, 0.75);
        let apart = of(
            &[1.0, f64::INFINITY, 1.0, 1.0],
            &[1.0, f64::INFINITY, f64::INFINITY, 1.0],
        );
        assert!(matches!(
            apart.size,
            Size::Quantity {
                largest: f64::INFINITY,
                at: 2.0,
                ..
            }
        ));
    }

    #[test]
    fn a_state_is_held_and_not_interpolated() {
        let state = |words: &[&str]| Trace::State(words.iter().map(|word| (*word).to_owned()).collect());
        let (a, b) = ([0.0, 1.0, 2.0, 3.0], [0.0, 2.5, 4.0]);
        let found = difference((&a, &state(&["x", "x", "y", "y"])), (&b, &state(&["x", "y", "y"])));
        let size = Size::State(0.25);
        assert_eq!(found, Some(Difference { size, compared: 1.0 }));
    }
}
