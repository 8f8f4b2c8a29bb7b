//! Every form against what its definition says.

use proptest::prelude::*;

use super::*;

const KNOTS: &[f64] = &[-2.0, -1.0, 0.0, 1.0, 3.0];
const GRID: Grid = Grid {
    knots: KNOTS,
    at_rest: 0.0,
    visible: 0.1,
};

proptest! {
    #[test]
    fn tables_of_rises_change_nothing_at_rest(rises in prop::collection::vec(-1.0..1.0f64, 4)) {
        prop_assert_eq!(Added.values(&GRID, &rises)[2], 0.0);
        prop_assert_eq!(Factor.values(&GRID, &rises)[2], 1.0);
        let (added, factor) = (Added.values(&GRID, &rises), Factor.values(&GRID, &rises));
        for (a, f) in added.iter().zip(&factor) {
            prop_assert!((libm::log(*f) - a).abs() < 1e-12);
        }
        for (pair, rise) in added.windows(2).zip(&rises) {
            prop_assert!((pair[1] - pair[0] - rise).abs() < 1e-12);
        }
    }

    #[test]
    fn a_rising_table_never_falls_within_its_bounds(fractions in prop::collection::vec(0.0..1.0f64, 4)) {
        let parameters = Rising.parameters(&GRID);
        let fitted: Vec<f64> = (parameters.iter().zip(&fractions)).map(|(p, f)| p.lower + f * (p.upper - p.lower)).collect();
        prop_assert!(Rising.values(&GRID, &fitted).windows(2).all(|w| w[0] <= w[1]));
    }
}

#[test]
fn a_bell_has_its_height_at_its_position_and_falls_to_a_part_in_e_at_its_half_width() {
    let values = Bell.values(&GRID, &[5.0, 1.0, 2.0]);
    assert_eq!(values[3], 5.0);
    assert!((values[1] - 5.0 * libm::exp(-1.0)).abs() < 1e-12 && (values[4] - values[1]).abs() < 1e-12);
}

#[test]
fn a_choke_lets_half_pass_where_its_argument_is_the_inverse() {
    assert_eq!(Choke.values(&GRID, &[1.0, 2.5])[2..4], [1.0, 0.5]);
}

#[test]
fn each_form_has_as_many_numbers_as_its_starts() {
    let forms: [&dyn Form; 6] = [&Added, &Bell, &Choke, &Factor, &Level, &Rising];
    for form in forms {
        let count = form.parameters(&GRID).len();
        assert!(form.starts().iter().all(|start| start.len() == count));
        let absent: Vec<f64> = form.parameters(&GRID).iter().map(|p| p.start).collect();
        assert_eq!(form.values(&GRID, &absent).len(), KNOTS.len());
    }
}
