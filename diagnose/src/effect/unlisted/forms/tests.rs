//! Every form against what its definition says.

use oleo_plant_sim::strut::{LawArgument, LawPlace, UnlistedLaw};
use proptest::prelude::*;

use super::*;

const KNOTS: &[f64] = &[-2.0, -1.0, 0.0, 1.0, 3.0];
const GRID: Grid = Grid {
    knots: KNOTS,
    at_rest: 0.0,
    visible: 0.1,
    longest_s: 50.0,
};

const FORCE: SwingingAdded = SwingingAdded {
    key: "amplitude_N",
    unit: "N",
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
fn the_flanks_of_a_bell_end() {
    let values = Bell.values(&GRID, &[5.0, -2.0, 0.1]);
    assert_eq!(values, [5.0, 0.0, 0.0, 0.0, 0.0]);
}

#[test]
fn a_choke_lets_half_pass_where_its_argument_is_the_inverse() {
    assert_eq!(PulledShut.values(&GRID, &[1.0, 2.5])[2..4], [1.0, 0.5]);
}

#[test]
fn a_groove_has_a_bottom_and_half_of_it_at_its_half_width() {
    // Ends of 2 s w = 1 about 1 and 3: from 0.5 to 1.5, and from 2.5 to 3.5.
    let knots = &[0.0, 0.5, 1.0, 1.5, 2.5, 3.0, 3.25, 3.5];
    let values = Groove.values(&Grid { knots, ..GRID }, &[4.0, 2.0, 1.0, 0.5]);
    assert_eq!(values, [0.0, 0.0, 2.0, 4.0, 4.0, 2.0, 1.0, 0.0]);
}

#[test]
fn a_limited_flow_approaches_its_largest_from_the_root_of_the_drop() {
    let knots = &[-1e12, 0.0, 1e-9, 4.0, 1e12];
    for sharpness in [0.5, 1.0, 6.0] {
        let values = Choke.values(&Grid { knots, ..GRID }, &[0.25, sharpness]);
        // The flow over the root of the drop at large drops is the largest flow, 1 / sqrt(0.25), over that root.
        for end in [values[0], values[4]] {
            assert!((end * 1e6 - 2.0).abs() < 1e-4, "{values:?}");
        }
        assert!(values[1] == 1.0 && (values[2] - 1.0).abs() < 1e-4);
        assert!((values[3] - libm::pow(2.0, -0.5 / sharpness)).abs() < 1e-12);
    }
}

#[test]
fn what_opens_grows_evenly_and_stays() {
    let knots = &[0.0, 5.0, 10.0, 60.0, 1000.0];
    let grid = Grid { knots, ..GRID };
    assert_eq!(Ramp("flow").values(&grid, &[3.0, 10.0]), [0.0, 1.5, 3.0, 3.0, 3.0]);
    assert_eq!(Ramp("flow").values(&grid, &[3.0, 600.0]), [0.0, 0.25, 0.5, 3.0, 30.0]);
}

#[test]
fn a_stiffening_spring_is_odd_and_its_parts_add_up() {
    assert_eq!(Stiffening.values(&GRID, &[2.0, -0.5]), [0.0, -1.5, 0.0, 1.5, -7.5]);
}

#[test]
fn bubbles_under_pressure_obey_boyle() {
    // Air of a volume of 2 at an absolute pressure of 0.5 takes up 2 (1 - 0.5 / (0.5 + x)) less.
    let values = Saturating("volume", "half_at").values(&GRID, &[2.0, 0.5]);
    for (value, x) in values.iter().zip(KNOTS).skip(2) {
        assert!((value - 2.0 * (1.0 - 0.5 / (0.5 + x))).abs() < 1e-12);
    }
}

#[test]
fn a_parabola_has_its_value_slope_and_curvature() {
    let values = Parabola(["a", "b", "c"]).values(&GRID, &[1.0, -2.0, 0.5]);
    assert_eq!(values, [7.0, 3.5, 1.0, -0.5, -0.5]);
    // A duration ends at none.
    let values = LevelParabola(["a", "b", "c"]).values(&GRID, &[1.0, -2.0, 0.5]);
    assert_eq!(values, [7.0, 3.5, 1.0, 0.0, 0.0]);
}

#[test]
fn a_power_of_two_is_turbulent_flow_in_either_direction() {
    let values = Power("drop_Pa").values(&GRID, &[9.0, 2.0]);
    for (value, expected) in values.iter().zip([-4.0, -1.0, 0.0, 1.0, 9.0]) {
        assert!((value - expected).abs() < 1e-12, "{values:?}");
    }
}

#[test]
fn stops_do_nothing_between_their_thresholds() {
    let knots = &[-0.08, -0.06, 0.0, 0.05, 0.06, 0.07];
    let values = Stops.values(&Grid { knots, ..GRID }, &[100.0, 30.0, 0.05, 0.07, 2.0]);
    for (value, expected) in values.iter().zip([-30.0, 0.0, 0.0, 0.0, 100.0, 400.0]) {
        assert!((value - expected).abs() < 1e-9, "{values:?}");
    }
}

#[test]
fn each_form_has_as_many_numbers_as_its_starts() {
    let forms: [&dyn Form; 35] = [
        &Added,
        &Bell,
        &PulledShut,
        &Factor,
        &Fading,
        &Groove,
        &Heated,
        &Level,
        &LevelParabola(["a", "b", "c"]),
        &Onset::Added("force_N"),
        &Onset::Factor,
        &Onset::Level("flow_m3_s"),
        &WithMemory(Added),
        &WithMemory(Factor),
        &WithPresliding,
        &Threshold {
            slope: "slope_N_Pa",
            threshold: "threshold_Pa",
            any_sign: true,
        },
        &Threshold {
            slope: "slope_N_Pa",
            threshold: "threshold_Pa",
            any_sign: false,
        },
        &Choke,
        &Lingering,
        &Ramp("flow_m3_s"),
        &Proportional("mass_kg"),
        &Parabola(["a", "b", "c"]),
        &Power("drop_Pa"),
        &RedlichKwong,
        &Relaxing,
        &Rising,
        &Shearing,
        &Saturating("volume_m3", "half_at_Pa"),
        &Stiffening,
        &Stops,
        &SettlingAdded("force_N"),
        &SettlingFactor,
        &SettlingLevel("flow_m3_s"),
        &FORCE,
        &SwingingFactor,
    ];
    for form in forms {
        let count = form.parameters(&GRID).len();
        assert!(form.starts(&GRID).iter().all(|start| start.len() == count));
        let absent: Vec<f64> = form.parameters(&GRID).iter().map(|p| p.start).collect();
        assert_eq!(form.values(&GRID, &absent).len(), form.argument(&GRID, &absent).len());
    }
}

#[test]
fn what_settles_has_two_thirds_of_its_end_after_its_time_constant() {
    const TIMES: &[f64] = &[0.0, 1.0, 5.0, 60.0, 1000.0];
    let grid = Grid {
        knots: TIMES,
        at_rest: 0.0,
        visible: 1.0,
        longest_s: 50.0,
    };
    let added = SettlingAdded("force_N").values(&grid, &[-30.0, 5.0]);
    assert_eq!(added[0], 0.0);
    assert!((added[2] / added[4] - (1.0 - libm::exp(-1.0))).abs() < 1e-12);
    assert!((added[3] + 30.0).abs() < 1e-12 && (added[4] + 30.0).abs() < 1e-3);
    let factor = SettlingFactor.values(&grid, &[libm::log(0.5), 5.0]);
    assert!(factor[0] == 1.0 && (factor[3] - 0.5).abs() < 1e-12);
    // A time constant far beyond the recording is a constant rate.
    let drift = SettlingLevel("flow_m3_s").values(&grid, &[3.0, 3000.0]);
    assert!((drift[2] / drift[1] - 5.0).abs() < 5e-3 && (drift[3] - 3.0).abs() < 1e-12);
}

#[test]
fn what_is_proportional_goes_through_the_origin() {
    assert_eq!(
        Proportional("mass_kg").values(&GRID, &[2.0]),
        [-4.0, -2.0, 0.0, 2.0, 6.0]
    );
}

#[test]
fn a_gas_without_molecules_is_ideal() {
    let knots = &[0.0, 1.0, 2.0];
    let grid = Grid { knots, ..GRID };
    assert_eq!(RedlichKwong.values(&grid, &[0.0, 0.0]), [1.0; 3]);
    // Both parts count as the density does; the factor is one where there is none.
    let values = RedlichKwong.values(&grid, &[0.1, 0.05]);
    assert_eq!(values, [1.0, 1.0 / 0.9 - 0.05, 1.25 - 0.1]);
    assert_eq!(RedlichKwong.attraction(&[0.1, 0.05]), Some(0.05));
}

#[test]
fn a_seal_that_shears_has_its_level_where_the_gas_is_as_at_rest() {
    let knots = &[0.5, 1.0, 2.0];
    let grid = Grid { knots, ..GRID };
    assert_eq!(Shearing.values(&grid, &[4e4, -1.0, 7e-7]), [8e4, 4e4, 2e4]);
    assert_eq!(Shearing.values(&grid, &[4e4, 0.0, 7e-7]), [4e4; 3]);
    assert_eq!(Shearing.presliding_volume_m3(&[4e4, 0.0, 7e-7]), Some(7e-7));
    // Each volume is tried with each level.
    let volumes: Vec<f64> = Shearing.starts(&grid).iter().map(|start| start[2]).collect();
    assert_eq!(volumes, [1e-7, 1e-7, 1e-6, 1e-6]);
}

#[test]
fn what_relaxes_is_one_where_nothing_has_changed() {
    // What is compressed to half or let out to double its volume at once, as a diatomic gas without a wall: p v^1.4 stays.
    let knots = &[-0.5, 0.0, 1.0];
    let values = Relaxing.values(&Grid { knots, ..GRID }, &[-0.4, 3.0]);
    let believed = [2.0, 1.0, 0.5];
    for ((factor, believed), x) in values.iter().zip(believed).zip(knots) {
        assert!((factor * believed * libm::pow(1.0 + x, 1.4) - 1.0).abs() < 1e-12);
    }
    assert_eq!(Relaxing.time_constant_s(&[-0.4, 3.0]), Some(3.0));
}

#[test]
fn what_swings_has_its_amplitude_between_its_points_too_and_is_highest_where_its_phase_says() {
    let turns: Vec<f64> = (0..=16).map(|k| f64::from(k) / 16.0).collect();
    let grid = Grid { knots: &turns, ..GRID };
    let fitted = [20.0, 0.0, 0.7];
    let added = FORCE.values(&grid, &fitted);
    // Twice the mean of the lines between the points times a sine is the amplitude of their fundamental.
    let product = |k: usize| {
        let (part, within) = (k / 100, (k % 100) as f64 / 100.0);
        let value = added[part] + (added[part + 1] - added[part]) * within;
        value * libm::sin(std::f64::consts::TAU * k as f64 / 1600.0)
    };
    let amplitude = 2.0 * (0..1600).map(product).sum::<f64>() / 1600.0;
    assert!((amplitude / 20.0 - 1.0).abs() < 1e-5, "{amplitude}");
    assert_eq!(FORCE.frequency_hz(&fitted), Some(0.7));
    // A phase of a quarter of a turn begins at the highest.
    let factor = SwingingFactor.values(&grid, &[0.2, 0.25 * std::f64::consts::TAU, 11.0]);
    assert!(factor[0] > 1.2 && (factor[0] + factor[8] - 2.0).abs() < 1e-12 && (factor[16] - factor[0]).abs() < 1e-12);
    assert_eq!(
        FORCE.equation("force", &[20.0, -0.5, 0.7]).as_deref(),
        Some("force = believed + 20.00 N sin(2 pi 0.7000 Hz t - 0.5000)")
    );
}

#[test]
fn what_holds_energy_or_remembers_is_in_proportion_to_it() {
    let knots = &[0.0, 100.0];
    let grid = Grid { knots, ..GRID };
    assert_eq!(Heated.values(&grid, &[0.004, 9.0]), [1.0, 1.4]);
    assert_eq!(Fading.values(&grid, &[0.01, 9.0]), [1.0, 0.5]);
    assert_eq!(Lingering.values(&grid, &[-1.0, 9.0]), [0.0, -100.0]);
    for form in [&Heated as &dyn Form, &Fading, &Lingering] {
        assert_eq!(form.time_constant_s(&[0.1, 9.0]), Some(9.0));
    }
}

/// The table of a form's numbers as a law.
fn table(form: &dyn Form, fitted: &[f64]) -> UnlistedLaw {
    UnlistedLaw {
        place: LawPlace::MainSeal,
        depends_on: LawArgument::Displacement,
        argument: form.argument(&GRID, fitted),
        value: form.values(&GRID, fitted),
        time_constant_s: form.time_constant_s(fitted),
        frequency_hz: None,
        presliding_volume_m3: form.presliding_volume_m3(fitted),
        attraction: None,
    }
}

#[test]
fn what_begins_at_a_moment_is_as_believed_before_and_stays_after() {
    let law = table(&Onset::Added("force_N"), &[-3.0, 7.0, 2.0]).characteristic();
    for (time, expected) in [(0.0, 0.0), (7.0, 0.0), (8.0, -1.5), (9.0, -3.0), (1000.0, -3.0)] {
        assert!((law.value(time) - expected).abs() < 1e-12, "{time}");
    }
    // Before the recording there was nothing, too.
    assert_eq!(
        table(&Onset::Level("flow_m3_s"), &[3.0, 0.0, 2.0])
            .characteristic()
            .value(1.0),
        1.5
    );
    let factor = table(&Onset::Factor, &[libm::log(0.5), 1.0, 1.0]).characteristic();
    assert!(factor.value(0.5) == 1.0 && (factor.value(5.0) - 0.5).abs() < 1e-12);
    let moments: Vec<f64> = Onset::Factor.starts(&GRID).iter().map(|start| start[1]).collect();
    assert_eq!(moments[..4], [0.0, 0.5, 0.75, 1.125]);
    assert!(
        moments
            .last()
            .is_some_and(|last| *last < GRID.longest_s && 1.5 * last >= GRID.longest_s)
    );
}

#[test]
fn beyond_a_threshold_a_value_rises_without_an_end() {
    let (slope, threshold) = ("slope_N_Pa", "threshold_Pa");
    let law = table(
        &Threshold {
            slope,
            threshold,
            any_sign: true,
        },
        &[-2.0, 0.5],
    )
    .characteristic();
    for (x, expected) in [(-9.0, 0.0), (0.0, 0.0), (0.5, 0.0), (1.0, -1.0), (10.5, -20.0)] {
        assert!((law.value(x) - expected).abs() < 1e-12, "{x}");
    }
}

#[test]
fn a_table_comes_near_a_law_of_another_form() {
    let law = table(&Stiffening, &[2.0, -0.5]);
    let (added, level) = (Added.near(&GRID, &law), Level.near(&GRID, &law));
    assert_eq!(table(&Added, &added.expect("rises")).value, law.value);
    let not_negative: Vec<f64> = law.value.iter().map(|v| v.max(0.0)).collect();
    assert_eq!(level, Some(not_negative));
    let factor = table(&PulledShut, &[0.7, 2.0]);
    let rises = Factor.near(&GRID, &factor).expect("rises");
    for (a, b) in table(&Factor, &rises).value.iter().zip(&factor.value) {
        assert!((a - b).abs() < 1e-12);
    }
    // What is remembered and what shears goes with the table.
    let lingering = table(&Lingering, &[-0.5, 3.0]);
    let with_memory = WithMemory(Added).near(&GRID, &lingering).expect("a table");
    assert_eq!(table(&WithMemory(Added), &with_memory), lingering);
    let knots = &[0.5, 1.0, 2.0];
    let grid = Grid { knots, ..GRID };
    let shearing = UnlistedLaw {
        argument: knots.to_vec(),
        value: Shearing.values(&grid, &[4e4, -1.0, 7e-7]),
        ..table(&Shearing, &[4e4, -1.0, 7e-7])
    };
    assert_eq!(WithPresliding.near(&grid, &shearing), Some(vec![8e4, 4e4, 2e4, 7e-7]));
    assert_eq!(WithMemory(Added).near(&GRID, &shearing), None);
}
