//! Tests of the strategy that forecasts.

use super::cost::of_levels;
use super::*;
use crate::strategy::parts::forecast::{COMMON, STEP_S};
use oleo_interface::{Absolute, Gauge, StrutPressures};

const AREA_M2: f32 = 1.963_495_4e-3;

fn strategy(tuning: &Tuning) -> Predictive {
    Predictive::new(&VehicleDescription::default(), tuning)
}

fn trusted() -> Trusted {
    Trusted {
        pressure: Corners::splat(StrutPressures::splat(Gauge(2.0e6))),
        charge: Corners::splat(Absolute(2.101_325e6)),
        ..Trusted::default()
    }
}

/// A road with this vertical RMS, m/s2, and a known delay of 30 ticks.
fn on(vertical_rms: f32) -> Estimate {
    Estimate {
        vertical_mean_square: vertical_rms * vertical_rms,
        static_load_n: Corners::splat(2.0e6 * AREA_M2),
        axle_delay_ticks: Some(30),
        ..Estimate::default()
    }
}

#[test]
fn all_combinations_are_looked_at_once() {
    let found: [u32; 81] = core::array::from_fn(|place| {
        let is_it = |levels: &Corners<u8>| levels.values().fold(0, |n, level| 3 * n + usize::from(*level)) == place;
        combinations().filter(is_it).count() as u32
    });
    assert_eq!(found, [1; 81]);
}

/// The numbers of the equation by hand: 400 N more at one strut of 4 x 3,927 N in every step.
#[test]
fn forces_become_motions_at_the_seats() {
    let c = strategy(&Tuning::default());
    let mut courses = Corners::splat([[0.0; STEPS]; LEVELS.len()]);
    courses[Corner::RearLeft][2] = [400.0; STEPS];
    let per_mass = GRAVITY_M_S2 / (4.0 * 2.0e6 * AREA_M2);
    let sums = Sums::of(&courses, &c.levers, per_mass);
    let [_, rears] = &sums.axles;
    let [heave, roll, pitch] = of_levels(rears, [2, 0])
        .map(|steps| steps[7])
        .expect("levels that there are");
    assert!((heave - 400.0 * per_mass).abs() < 1e-5);
    assert!((roll - 400.0 * per_mass * 0.4 * 0.5 / (0.661 * 0.661)).abs() < 1e-5);
    assert!((pitch - 400.0 * per_mass * 0.68 * 1.405 / (1.25 * 1.25)).abs() < 1e-5);

    // Thirteen scored steps, in which 0.8 of the lag is taken off; then the velocities.
    let kept = libm::expf(-2.0 * core::f32::consts::PI * 4.0 * STEP_S);
    let felt = |step: usize| 1.0 - 0.8 * (1.0 - libm::powf(kept, (step + 1) as f32));
    let scored: f32 = (COMMON..STEPS).map(|step| STEP_S * felt(step) * felt(step)).sum();
    let end_s = STEP_S * STEPS as f32;
    let expected = (scored + 3.0 * end_s * end_s) * (heave * heave + roll * roll + pitch * pitch);
    let cost = c.cost.of(&sums, [1, 1], [2, 0], [0.0; 3], [0.0; 3]);
    assert!((cost / expected - 1.0).abs() < 1e-3, "{cost}, expected {expected}");
    assert_eq!(c.cost.of(&sums, [1, 1], [1, 1], [0.0; 3], [0.0; 3]), 0.0);
    assert_eq!(
        c.cost.of(&sums, [1, 1], [0, 3], [0.0; 3], [0.0; 3]),
        f32::MAX,
        "a level that there is not is never the best"
    );
}

/// Equal forces at all four struts lift the body and hardly pitch it, and a body that falls as fast as they lift it comes to rest: by hand
/// 0.98 m/s2, 0.157 m/s in 160 ms. Then velocities cost nothing, and else three times their square.
#[test]
fn forces_of_all_struts_add_up_and_brake_the_body() {
    let c = strategy(&Tuning::default());
    let courses = Corners::splat([[392.7; STEPS]; LEVELS.len()]);
    let sums = Sums::of(&courses, &c.levers, GRAVITY_M_S2 / (4.0 * 2.0e6 * AREA_M2));
    let cost = |heave_m_s: f32| c.cost.of(&sums, [1, 1], [1, 1], [heave_m_s, 0.0, 0.0], [0.0; 3]);
    let lifted_m_s = 0.980_7 * 0.16;
    let at_rest = cost(-lifted_m_s);
    for heave_m_s in [-0.5, 0.0, 0.5] {
        let end_m_s = heave_m_s + lifted_m_s;
        let velocities = cost(heave_m_s) - at_rest;
        assert!(
            (velocities - 3.0 * end_m_s * end_m_s).abs() < 1e-3,
            "{velocities} m2/s3 at {heave_m_s} m/s"
        );
    }
    let (front, rear) = (sums.axles[0][1][1][0], sums.axles[1][1][1][0]);
    assert!((front[0] - 0.490_3).abs() < 1e-3 && (rear[0] - 0.490_3).abs() < 1e-3);
    assert!(front[1].abs() < 1e-6 && rear[1].abs() < 1e-6, "no roll");
}

/// A place on the left rises in a positive roll, and one ahead falls in a positive pitch.
#[test]
fn places_of_the_body_move_with_it() {
    for (place_m, expected) in [
        ((1.4, 0.5), 0.1 + 0.5 * 0.2 - 1.4 * 0.3),
        ((1.4, -0.5), 0.1 - 0.5 * 0.2 - 1.4 * 0.3),
        ((-1.4, 0.5), 0.1 + 0.5 * 0.2 + 1.4 * 0.3),
        ((0.0, 0.0), 0.1),
    ] {
        let found: f32 = over(place_m, [0.1, 0.2, 0.3]);
        assert!((found - expected).abs() < 1e-6, "{found} m/s, expected {expected}");
    }
}

/// Speed of the road that the front wheels met in the last tick, m/s.
fn met(state: &State) -> [f32; 2] {
    state.met_m_s.each_ref().map(|Ring(ring)| ring[state.now])
}

/// Struts that rest 10 mm in their stops, 2,100 N, on tyres that are compressed by that (8.75 mm) with a sensor that reads 0.1 MPa too
/// much: nothing moves, and no road is met.
#[test]
fn a_wheel_in_balance_meets_no_road() {
    let (c, mut state) = (strategy(&Tuning::default()), Predictive::INITIAL);
    let mut trusted = trusted();
    for corner in Corner::ALL {
        trusted.pressure[corner].p1 = Gauge(2.1e6);
    }
    trusted.p1_offset_pa = Corners::splat(1.0e5);
    trusted.displacement_m = Corners::splat(0.09);
    for wheel in state.wheels.values_mut() {
        (wheel.strut_m, wheel.tyre_m) = (0.09, 2_100.0 / 2.4e5);
    }
    let balanced = state.wheels;
    c.observe(&mut state, &on(2.0), &trusted);
    for (corner, wheel) in state.wheels.iter() {
        assert!((wheel.strut_m_s - balanced[corner].strut_m_s).abs() < 1e-3, "{wheel:?}");
    }
    assert!(met(&state).into_iter().all(|met_m_s| met_m_s.abs() < 1e-3));
}

/// A strut that is found 1 mm shorter than it was to be is a road of 7.795 * 1 mm / 5 ms, which is kept for the side of a front wheel.
#[test]
fn roads_are_kept_for_the_side_that_met_them() {
    let c = strategy(&Tuning::default());
    for (corner, expected) in [
        (Corner::FrontLeft, [1.559, 0.0]),
        (Corner::FrontRight, [0.0, 1.559]),
        (Corner::RearLeft, [0.0, 0.0]),
    ] {
        let (mut state, mut trusted) = (Predictive::INITIAL, trusted());
        trusted.displacement_m[corner] = 0.001;
        c.observe(&mut state, &on(2.0), &trusted);
        for (found, expected) in met(&state).into_iter().zip(expected) {
            assert!((found - expected).abs() < 5e-3, "{found} m/s, expected {expected}");
        }
    }
}

/// Valve 2 was told to close 8 ticks, 40 ms, ago: it acts in the second step.
#[test]
fn a_change_is_known_by_its_age() {
    let (c, mut state) = (strategy(&Tuning::default()), Predictive::INITIAL);
    let corner = Corner::RearLeft;
    state.wheels[corner].strut_m_s = 0.5;
    (state.before[corner], state.level[corner], state.held[corner]) = (1, 2, HOLD_TICKS - 8);
    let course = |state: &State| c.courses(state, &Corners::splat(false), &on(2.0), &trusted())[corner][0];
    let moving = course(&state);
    state.level[corner] = 1;
    let settled = course(&state);
    assert_eq!(moving.into_iter().zip(settled).position(|(a, b)| a != b), Some(1));
}

/// What the front wheel met 30 ticks ago is what the rear one meets now; what comes after the delay is not known.
#[test]
fn the_road_ahead_of_the_rear_wheel_is_that_behind_the_front_one() {
    let mut state = Predictive::INITIAL;
    for tick in 0..300_u16 {
        state.now = (state.now + 1) % HISTORY;
        let [Ring(left), _] = &mut state.met_m_s;
        left[state.now] = f32::from(tick);
    }
    // The last tick is 299, so the front wheel was at 269 when it was where the rear one is.
    let ahead = state.ahead(Side::Left, 30);
    assert_eq!((ahead[0], ahead[1], ahead[14]), (270.5, 272.5, 298.5));
    assert_eq!(ahead[15], 0.0);
    assert_eq!(state.ahead(Side::Right, 30), [0.0; STEPS]);
    assert_eq!(state.ahead(Side::Left, 127)[0], 173.5, "the longest delay that is kept");
}

#[test]
fn other_roads_are_the_default_strategys() {
    let c = strategy(&Tuning::default());
    for (vertical_rms, valves) in [(0.1, ValveCommand::SAFE), (0.8, ValveCommand::SOFT)] {
        let mut state = Predictive::INITIAL;
        // The road is first looked at in the second tick.
        c.step(&mut state, &on(vertical_rms), &trusted());
        for _ in 0..500 {
            let demand = c.step(&mut state, &on(vertical_rms), &trusted());
            assert_eq!(demand.valves, valves, "{vertical_rms} m/s2");
        }
    }
}

/// On a rough road on which the body heaves.
fn heaving() -> State {
    State {
        road: road_and_cornering::State::heaving(),
        ..Predictive::INITIAL
    }
}

/// Drives two seconds on a road on which the body heaves while these wheels meet a wave of 3 Hz; returns the commands.
fn commands(tuning: &Tuning, moving: &'static [Corner]) -> impl Iterator<Item = ValveCommand> + use<> {
    let (c, mut state) = (strategy(tuning), heaving());
    (0..400_u16).map(move |tick| {
        let wave = 0.06 * libm::sinf(2.0 * core::f32::consts::PI * 3.0 * f32::from(tick) * 0.005);
        let mut trusted = trusted();
        moving.iter().for_each(|corner| trusted.displacement_m[*corner] = wave);
        c.step(&mut state, &on(2.0), &trusted).valves
    })
}

#[test]
fn rear_valves_move_at_most_every_100_ms_and_front_ones_not_at_all() {
    let firm = valves(FIRM);
    let (mut before, mut last, mut changes) = (None, None, 0);
    for (tick, command) in commands(&Tuning::default(), &Corner::ALL).enumerate() {
        assert_eq!(command.strut(Corner::FrontLeft), firm);
        assert_eq!(command.strut(Corner::FrontRight), firm);
        let rear = command.strut(Corner::RearLeft);
        if before.is_some_and(|before| before != rear) {
            assert!(
                last.is_none_or(|last| tick - last >= usize::from(HOLD_TICKS)),
                "tick {tick}"
            );
            (last, changes) = (Some(tick), changes + 1);
        }
        before = Some(rear);
    }
    assert!(changes > 2, "{changes} changes");
}

/// Whatever a valve would be allowed to do in between: it is decided every fourth tick.
#[test]
fn decisions_are_20_ms_apart() {
    let (c, mut state) = (strategy(&Tuning::default()), heaving());
    let (mut before, mut changes) = (state.level, [0; 4]);
    for tick in 0..400_u16 {
        let wave = 0.06 * libm::sinf(2.0 * core::f32::consts::PI * 3.0 * f32::from(tick) * 0.005);
        let mut trusted = trusted();
        trusted.displacement_m = Corners::splat(wave);
        state.held = Corners::splat(0);
        c.step(&mut state, &on(2.0), &trusted);
        changes[usize::from(tick % 4)] += u32::from(state.level != before);
        before = state.level;
    }
    assert_eq!(
        changes.into_iter().filter(|changes| *changes > 0).count(),
        1,
        "{changes:?}"
    );
    assert!(changes.into_iter().sum::<u32>() > 10, "{changes:?}");
}

/// What is decided for all four dampers of a body with these velocities over wheels that stand still, if little but the velocities at the
/// end counts.
fn braking(velocity: Motions) -> [u8; 4] {
    let c = strategy(&Tuning {
        velocity_cost_per_s: 1000.0,
        front: true,
        ..Tuning::default()
    });
    let mut state = Predictive::INITIAL;
    state.velocity = velocity;
    for (corner, wheel) in state.wheels.iter_mut() {
        wheel.strut_m_s = -over(c.places_m[corner], velocity);
    }
    c.decide(&mut state, &on(2.0), &trusted());
    state.level.into_array()
}

/// A strut that is moved by the body over it brakes it whichever way it goes, and most with high damping. So one damper of each axle is high
/// at least; both would now and then turn the motion round.
#[test]
fn a_body_that_moves_is_braked_at_both_axles() {
    for sign in [-1.0, 1.0] {
        for velocity in [[0.2, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 0.4]] {
            let [fl, fr, rl, rr] = braking(velocity.map(|velocity| sign * velocity));
            assert_eq!(
                (fl.max(fr), rl.max(rr)),
                (2, 2),
                "{sign} of {velocity:?}: {fl} {fr} {rl} {rr}"
            );
        }
    }
}

/// Nothing is to be gained where nothing moves, not even if the least gain is enough.
#[test]
fn at_rest_no_valve_moves() {
    let tuning = Tuning {
        less_share: 0.0,
        ..Tuning::default()
    };
    let (c, mut state) = (strategy(&tuning), Predictive::INITIAL);
    c.decide(&mut state, &on(2.0), &trusted());
    assert_eq!(state.level, Corners::splat(FIRM));
}

/// The wave is under the front wheel alone: with preview the rear damper of that side moves, and without it has no reason to.
#[test]
fn only_with_preview_do_the_rear_dampers_meet_the_road_of_the_front_wheels() {
    let mut before = commands(&Tuning::default(), &[Corner::FrontLeft]);
    assert!(before.any(|command| command.strut(Corner::RearLeft) != valves(FIRM)));
    let tuning = Tuning {
        preview: false,
        ..Tuning::default()
    };
    assert!(commands(&tuning, &[Corner::FrontLeft]).all(|command| command.strut(Corner::RearLeft) == valves(FIRM)));
}

#[test]
fn every_value_has_its_range() {
    assert_eq!(Predictive::check(&Tuning::default()), Ok(()));
    let name = |change: fn(&mut Tuning)| {
        let mut tuning = Tuning::default();
        change(&mut tuning);
        Predictive::check(&tuning).map_err(|error| error.name)
    };
    assert_eq!(
        name(|tuning| tuning.velocity_cost_per_s = -1.0),
        Err("tuning.strategy.predictive.velocity_cost_per_s")
    );
    assert_eq!(
        name(|tuning| tuning.less_share = 1.1),
        Err("tuning.strategy.predictive.less_share")
    );
    assert_eq!(
        name(|tuning| tuning.road.rough_m_s2.begin = 11.0),
        Err("tuning.strategy.road_and_cornering.rough_m_s2")
    );
}
