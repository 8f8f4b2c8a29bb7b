//! What is a bend and what is not, against the bounds of the controller's page in f64.

extern crate std;
use super::*;
use crate::lateral::Lateral;

/// An estimate whose two bands are alike, m/s2.
fn estimate(acceleration: f32, witness: f32, corrected: bool) -> Estimate {
    let both = |value| Bands {
        quick: value,
        slow: value,
    };
    Estimate {
        lateral: Lateral {
            acceleration_m_s2: both(acceleration),
            witness_m_s2: both(witness),
            corrected,
        },
        ..Estimate::default()
    }
}

fn corners(cornering: Cornering) -> bool {
    matches!(cornering, Cornering::Yes(_))
}

/// A sine of an RMS value, m/s2.
fn sway(tick: usize, rms: f32) -> f32 {
    core::f32::consts::SQRT_2 * rms * libm::sinf(0.05 * tick as f32)
}

/// Drives on a road for 20 s and then asks whether a lateral acceleration in the quick and the slow band, m/s2, is a bend.
fn after_a_road(witness: f32, error: f32, corrected: bool, quick: f32, slow: f32) -> bool {
    let (c, mut state) = (Parameters::new(&Tuning::default()), State::INITIAL);
    for tick in 0..4_000 {
        let now = state.step(
            &c,
            &estimate(sway(tick, error), sway(tick + 30, witness), corrected),
            false,
        );
        assert!(!corners(now), "tick {tick}");
    }
    let mut asked = estimate(quick, 0.0, corrected);
    asked.lateral.acceleration_m_s2.slow = slow;
    corners(state.step(&c, &asked, false))
}

#[test]
fn a_smooth_road_leaves_the_floor() {
    // The quick band alone: 1.2 x 0.274^2 = 0.3^2.
    assert!(!after_a_road(0.0, 0.0, true, 0.27, 0.01));
    assert!(after_a_road(0.0, 0.0, true, -0.28, -0.01));
    // The slow band alone: 0.6 x 0.387^2 = 0.3^2.
    assert!(!after_a_road(0.0, 0.0, true, 0.01, 0.38));
    assert!(after_a_road(0.0, 0.0, true, -0.01, -0.395));
    // Both bands together: 1.8 x 0.224^2 = 0.3^2.
    assert!(!after_a_road(0.0, 0.0, true, 0.22, 0.22));
    assert!(after_a_road(0.0, 0.0, true, 0.23, 0.23));
    // To opposite sides, half of the greater share.
    assert!(!after_a_road(0.0, 0.0, true, 0.38, -0.3));
    assert!(after_a_road(0.0, 0.0, true, 0.395, -0.3));
}

#[test]
fn the_witness_raises_the_bound_and_more_so_without_correction() {
    // 0.5 m/s2 of witness make 0.5 x sqrt(1 + (0.5 / 0.5)^2) = 0.71, times 0.6 corrected and times 3.9 otherwise, over the root of 1.2.
    assert!(!after_a_road(0.5, 0.0, true, 0.34, 0.01));
    assert!(after_a_road(0.5, 0.0, true, 0.44, 0.01));
    assert!(!after_a_road(0.5, 0.0, false, 2.2, 0.01));
    assert!(after_a_road(0.5, 0.0, false, 3.1, 0.01));
}

#[test]
fn a_swaying_vehicle_raises_the_bound() {
    // 3.6 x 0.3 = 1.1, a little less because the largest values of the sine count for 2.2 times the mean.
    assert!(!after_a_road(0.0, 0.3, true, 0.85, 0.01));
    assert!(after_a_road(0.0, 0.3, true, 1.13, 0.01));
}

#[test]
fn a_weak_decision_is_over_sooner() {
    // Beyond doubt from 1.6 x 0.274 = 0.438 m/s2.
    for (asked, hold) in [(0.43, WEAK_HOLD_TICKS), (0.45, HOLD_TICKS)] {
        let (c, mut state) = (Parameters::new(&Tuning::default()), State::INITIAL);
        for _ in 0..1_000 {
            state.step(&c, &estimate(0.0, 0.0, true), false);
        }
        let mut begin = estimate(asked, 0.0, true);
        begin.lateral.acceleration_m_s2.slow = 0.01;
        assert!(corners(state.step(&c, &begin, false)));
        for _ in 1..hold {
            assert!(corners(state.step(&c, &estimate(0.0, 0.0, true), false)), "{asked}");
        }
        assert!(!corners(state.step(&c, &estimate(0.0, 0.0, true), false)), "{asked}");
    }
}

#[test]
fn cornering_outlasts_the_crossing_of_a_lane_change_and_ends() {
    let (c, mut state) = (Parameters::new(&Tuning::default()), State::INITIAL);
    for _ in 0..1_000 {
        state.step(&c, &estimate(0.0, 0.0, true), false);
    }
    assert!(corners(state.step(&c, &estimate(3.0, 0.0, true), false)));
    for _ in 1..HOLD_TICKS {
        assert!(corners(state.step(&c, &estimate(0.0, 0.0, true), false)));
    }
    assert!(!corners(state.step(&c, &estimate(0.0, 0.0, true), false)));
}

/// A measure of 0.7 on a smooth road, and of 0.7 / (1 + 0.03 l) on a rough one: with a witness of 2.5 m/s2 `l` is 25.
#[test]
fn a_bend_is_suspected_before_it_is_decided_on() {
    for (witness, bound, suspected) in [(0.0, 0.3, 0.7_f32), (2.5, 0.6 * 2.5 * 26.0_f32.sqrt(), 0.7 / 1.75)] {
        let (c, mut state) = (Parameters::new(&Tuning::default()), State::INITIAL);
        for _ in 0..4_000 {
            state.step(&c, &estimate(0.0, witness, true), false);
        }
        // The quick band alone: a measure of 1.2 times the square.
        let mut asked = |measure: f32| {
            let mut estimate = estimate(0.0, witness, true);
            estimate.lateral.acceleration_m_s2 = Bands {
                quick: bound * (measure / QUICK_SHARE).sqrt(),
                slow: 1e-6,
            };
            state.step(&c, &estimate, false)
        };
        assert_eq!(asked(0.97 * suspected), Cornering::No, "{witness}");
        assert_eq!(asked(1.03 * suspected), Cornering::Suspected, "{witness}");
        assert_eq!(asked(0.97), Cornering::Suspected, "{witness}");
        assert_eq!(asked(0.0), Cornering::No, "it is not held");
        assert_eq!(asked(1.03), Cornering::Yes(Side::Right), "{witness}");
    }
}

/// The side is that of the last decision, whatever the estimate does between two of them.
#[test]
fn a_bend_pushes_to_the_side_of_the_last_decision() {
    let (c, mut state) = (Parameters::new(&Tuning::default()), State::INITIAL);
    for _ in 0..1_000 {
        state.step(&c, &estimate(0.0, 0.0, true), false);
    }
    // A left turn pushes the body to the right.
    for (asked, side) in [
        (3.0, Side::Right),
        (0.0, Side::Right),
        (-0.1, Side::Right),
        (-3.0, Side::Left),
        (0.1, Side::Left),
    ] {
        assert_eq!(
            state.step(&c, &estimate(asked, 0.0, true), false),
            Cornering::Yes(side),
            "{asked}"
        );
    }
}

#[test]
fn cornering_is_not_over_while_the_gas_leans() {
    let (c, mut state) = (Parameters::new(&Tuning::default()), State::INITIAL);
    for _ in 0..1_000 {
        state.step(&c, &estimate(0.0, 0.0, true), false);
    }
    assert!(
        !corners(state.step(&c, &estimate(0.0, 0.0, true), true)),
        "a lean alone is no bend"
    );
    assert!(corners(state.step(&c, &estimate(3.0, 0.0, true), false)));
    for _ in 0..2 * HOLD_TICKS {
        assert!(corners(state.step(&c, &estimate(0.0, 0.0, true), true)));
    }
    for _ in 1..HOLD_TICKS {
        assert!(corners(state.step(&c, &estimate(0.0, 0.0, true), false)));
    }
    assert!(!corners(state.step(&c, &estimate(0.0, 0.0, true), false)));
}

#[test]
fn nothing_is_decided_while_the_road_is_learnt() {
    let (c, mut state) = (Parameters::new(&Tuning::default()), State::INITIAL);
    for _ in 0..LEARNING_TICKS {
        assert!(!corners(state.step(&c, &estimate(5.0, 0.0, false), false)));
    }
}

/// A road that has been known for long: mean squares of the witness and of the own estimate, quick and slow, m2/s4.
struct Road {
    corrected: bool,
    witness: [f32; 2],
    own: [f32; 2],
}

impl Road {
    /// The state on it, and an estimate with these accelerations whose witness is as large as its mean.
    fn with(&self, quick: f32, slow: f32) -> (State, Estimate) {
        let mut state = State::INITIAL;
        for (band, (witness, own)) in state.bands.iter_mut().zip(self.witness.into_iter().zip(self.own)) {
            (band.witness, band.own) = (witness, own);
        }
        state.known = LEARNING_TICKS;
        state.corrected = self.corrected;
        state.further_memory = OWN_MEMORY_TICKS - FIRST_OWN_MEMORY_TICKS;
        let mut estimate = estimate(quick, 0.0, self.corrected);
        estimate.lateral.acceleration_m_s2.slow = slow;
        let [quick_witness, slow_witness] = self.witness.map(libm::sqrtf);
        estimate.lateral.witness_m_s2 = Bands {
            quick: quick_witness,
            slow: slow_witness,
        };
        (state, estimate)
    }

    /// Least acceleration for which something holds that does not hold for less, m/s2.
    fn least(&self, holds: impl Fn(State, f32) -> bool, of: impl Fn(f32) -> (f32, f32)) -> f32 {
        let (mut low, mut high) = (0.0, 50.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            let (quick, slow) = of(middle);
            let (mut state, estimate) = self.with(quick, slow);
            state.hold = 10;
            state.step(&Parameters::new(&Tuning::default()), &estimate, false);
            if holds(state, middle) {
                high = middle
            } else {
                low = middle
            }
        }
        high
    }

    /// The bounds of the quick and of the slow acceleration as the page of the controller states them, m/s2.
    fn bounds(&self) -> [f64; 2] {
        let [w_q, w_s] = self.witness.map(|square| f64::from(square).sqrt());
        let [s_q, s_s] = self.own.map(|square| f64::from(square).sqrt());
        let k_w = if self.corrected { 0.6 } else { 3.9 };
        let l = w_q * w_q / 0.25;
        let quick = f64::max(k_w * w_q * (1.0 + l).sqrt(), 3.6 * s_q * (1.0 + 0.01 * l * l).sqrt());
        let slow = f64::max(
            k_w * w_s * (1.0 + 0.5 * l).sqrt(),
            4.9 * s_s * (1.0 + 0.0004 * l * l).sqrt(),
        );
        [quick.max(0.3), slow.max(0.3)]
    }

    /// The roots of the shares of the quick and of the slow band in the measure.
    fn roots() -> [f64; 2] {
        [1.2, 0.6].map(f64::sqrt)
    }
}

const ROADS: [Road; 6] = [
    Road {
        corrected: true,
        witness: [0.01, 0.02],
        own: [0.001, 0.002],
    },
    Road {
        corrected: true,
        witness: [0.9, 0.3],
        own: [0.001, 0.001],
    },
    Road {
        corrected: false,
        witness: [0.9, 0.3],
        own: [0.001, 0.001],
    },
    Road {
        corrected: false,
        witness: [0.04, 0.02],
        own: [0.0, 0.0],
    },
    Road {
        corrected: true,
        witness: [0.01, 0.02],
        own: [0.3, 0.2],
    },
    Road {
        corrected: true,
        witness: [1.6, 0.1],
        own: [4.0, 3.0],
    },
];

fn is_near(found: f32, expected: f64, what: &str) {
    assert!(
        (f64::from(found) / expected - 1.0).abs() < 0.01,
        "{what}: {found}, expected {expected}"
    );
}

/// With the other band nearly silent, to the same side and to the other.
#[test]
fn the_bounds_are_those_of_the_page() {
    let strong = |state: State, _| state.hold == HOLD_TICKS;
    let decided = |state: State, _| state.hold > 10;
    for road in &ROADS {
        let [quick, slow] = road.bounds();
        let [of_quick, of_slow] = Road::roots();
        let [decides, doubtless] = [1.0, 1.6];
        is_near(road.least(decided, |a| (a, 1e-4)), decides * quick / of_quick, "quick");
        is_near(road.least(decided, |a| (-1e-4, -a)), decides * slow / of_slow, "slow");
        is_near(
            road.least(strong, |a| (a, 1e-4)),
            doubtless * quick / of_quick,
            "quick, beyond doubt",
        );
        is_near(
            road.least(decided, |a| (a, -1e-4)),
            2.0_f64.sqrt() * quick / of_quick,
            "quick, opposed",
        );
        is_near(
            road.least(decided, |a| (1e-4, -a)),
            2.0_f64.sqrt() * slow / of_slow,
            "slow, opposed",
        );
        // Each band at the same part of its bound.
        let ratio = (slow / quick) as f32;
        is_near(
            road.least(decided, |a| (a, a * ratio)),
            quick / (of_quick * of_quick + of_slow * of_slow).sqrt(),
            "both",
        );
        // Cornering is held for as long as either band is above 0.6 of its bound.
        let held = |state: State, _| state.hold >= 10;
        is_near(road.least(held, |a| (a, 1e-4)), 0.6 * quick, "release of quick");
        is_near(road.least(held, |a| (1e-4, a)), 0.6 * slow, "release of slow");
    }
}

/// What enters the own mean square in one tick, as a part of what it lacks, and how much at most.
#[test]
fn the_own_mean_square_learns_as_the_page_says() {
    let c = Parameters::new(&Tuning::default());
    let road = Road {
        corrected: true,
        witness: [0.0, 0.0],
        own: [0.04, 0.02],
    };
    let learnt = |state: &State, before: f32| f64::from(state.bands[0].own - before);
    // 15 s: 3,000 ticks. Four times as slow in bends.
    for (hold, ticks) in [(0, 3_000.0), (100, 12_000.0)] {
        let (mut state, estimate) = road.with(0.25, 0.0);
        state.hold = hold;
        state.step(&c, &estimate, false);
        let expected = (0.0625 - 0.04) / ticks;
        assert!(
            (learnt(&state, 0.04) / expected - 1.0).abs() < 0.02,
            "{hold}: {state:?}"
        );
    }
    // A value above 2.2 times the mean square enters as that, and from nothing half of the witness's bound, 0.6 w.
    let (mut state, estimate) = road.with(3.0, 0.0);
    state.step(&c, &estimate, false);
    assert!(
        (learnt(&state, 0.04) / (1.2 * 0.04 / 3_000.0) - 1.0).abs() < 0.02,
        "{state:?}"
    );
    let shaken = Road {
        corrected: true,
        witness: [0.09, 0.09],
        own: [0.0, 0.0],
    };
    let (mut state, estimate) = shaken.with(3.0, 0.0);
    state.step(&c, &estimate, false);
    let l = 0.09 / 0.25;
    let half_bound = 0.5 * 0.36 * 0.09 * (1.0 + l);
    assert!(
        (learnt(&state, 0.0) / (half_bound / 3_000.0) - 1.0).abs() < 0.02,
        "{state:?}"
    );
}

/// From 1 s on it grows to 15 s, and begins again where the estimate becomes another one.
#[test]
fn the_own_memory_grows_and_begins_again() {
    let c = Parameters::new(&Tuning::default());
    let mut state = State::INITIAL;
    let memory_ticks = |state: &State| 200.0 + state.further_memory;
    for tick in 1..=5_000_u16 {
        // While the road is learnt, every value enters as it is.
        let before = state.bands[0].own;
        state.step(&c, &estimate(0.5, 0.0, false), false);
        assert_eq!(memory_ticks(&state), f32::min(200.0 + f32::from(tick), 3_000.0));
        if tick <= 500 {
            let part = (state.bands[0].own - before) / (0.25 - before);
            let expected = 1.0 / (199.0 + f32::from(tick));
            assert!((part / expected - 1.0).abs() < 1e-3, "tick {tick}: {part}");
        }
    }
    for corrected in [true, false] {
        state.step(&c, &estimate(0.0, 0.0, corrected), false);
        assert_eq!(memory_ticks(&state), 201.0);
        state.step(&c, &estimate(0.0, 0.0, corrected), false);
        assert_eq!(memory_ticks(&state), 202.0);
    }
}
