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
        for _ in 0..500 {
            let demand = c.step(&mut state, &on(vertical_rms), &trusted());
            assert_eq!(demand.valves, valves, "{vertical_rms} m/s2");
        }
    }
}

/// Drives two seconds on a very rough road while these wheels meet a wave of 3 Hz; returns the commands.
fn commands(tuning: &Tuning, moving: &'static [Corner]) -> impl Iterator<Item = ValveCommand> + use<> {
    let (c, mut state) = (strategy(tuning), Predictive::INITIAL);
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
