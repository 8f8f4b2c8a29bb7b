//! The fixed-step strut against a library's stiff solver (diffsol's BDF, relative tolerance 1e-8) on equations that are written
//! independently (`plain_strut`). The strut runs at the recordings' own 2 ms. Asked: 0.1 % of the pressure.

mod plain_strut;

use plain_strut::{CASES, Case, Middle, PlainStrut, deviations, model, of_strut};

fn compare(case: Case) {
    let model = model();
    let exact = PlainStrut::of(&model, case, Middle::Bisection).by_bdf(1e-8);
    let worst = deviations(&of_strut(&model, case, 1), &exact);
    let Case {
        dampers_open,
        valve3_from_s,
        ..
    } = case;
    println!(
        "dampers open {dampers_open}, valve 3 from {valve3_from_s} s: largest relative deviations of p1..p4 {worst:?}"
    );
    assert!(worst.iter().all(|w| *w < 1e-3), "{worst:?}");
}

#[test]
fn soft_and_low_damping() {
    compare(CASES[0]);
}

#[test]
fn soft_and_high_damping() {
    compare(CASES[1]);
}

#[test]
fn stiff_then_valve_3_opens_away_from_the_static_position() {
    compare(CASES[2]);
}

/// What is timed side by side solves the same equations.
#[test]
fn the_plain_strut_finds_the_same_p3_either_way() {
    let model = model();
    let by = |middle| PlainStrut::of(&model, CASES[1], middle).by_bdf(1e-8);
    let worst = deviations(&by(Middle::Newton), &by(Middle::Bisection));
    assert!(worst.iter().all(|w| *w < 1e-6), "{worst:?}");
}
