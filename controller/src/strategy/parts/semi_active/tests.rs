//! Tests of damper switching in ride mode.

use super::*;
use oleo_interface::Axles;

fn settled(policy: DamperPolicy, extension_m_s: f32, velocity: f32, acceleration: f32, x_m: f32) -> bool {
    let parameters = parameters(policy);
    let mut state = CornerState::INITIAL;
    for _ in 0..100 {
        state.step(&parameters, -extension_m_s, acceleration, velocity, 0.0, x_m);
    }
    state.high
}

fn parameters(policy: DamperPolicy) -> Parameters {
    let tuning = Tuning {
        policy,
        ..Tuning::default()
    };
    Parameters::new(&VehicleDescription::default(), &tuning)
}

/// Struts half a metre to the side, 1.389 m ahead and 1.405 m behind: a rigid body. The integral of a constant acceleration
/// levels off at that times the time constant of 0.2 Hz, 0.8 s.
#[test]
fn the_body_moves_differently_over_each_strut() {
    let parameters = parameters(DamperPolicy::Low);
    let estimate = Estimate {
        vertical_acceleration_m_s2: 1.0,
        roll_acceleration_rad_s2: 0.4,
        pitch_acceleration_rad_s2: 0.2,
        ..Estimate::default()
    };
    let expected = [
        1.0 + 0.2 - 0.2778,
        1.0 - 0.2 - 0.2778,
        1.0 + 0.2 + 0.281,
        1.0 - 0.2 + 0.281,
    ];
    let mut state = State::INITIAL;
    for _ in 0..2_000 {
        state.step(&parameters, &estimate, &Trusted::default());
    }
    let there = parameters.place_m.zip(state.corners).into_array();
    for ((place_m, corner), expected) in there.into_iter().zip(expected) {
        let found = acceleration_at(place_m, &estimate);
        assert!((found - expected).abs() < 1e-3, "{found}, expected {expected}");
        let velocity = expected / (2.0 * core::f32::consts::PI * 0.2);
        assert!(
            (corner.velocity_m_s - velocity).abs() < 0.01,
            "{} m/s, expected {velocity}",
            corner.velocity_m_s
        );
    }
}

#[test]
fn quadrants_of_both_rules() {
    for w in [0.3, -0.3] {
        for v in [0.4, -0.4] {
            assert_eq!(settled(DamperPolicy::Karnopp, w, v, 0.0, 0.0), w * v > 0.0);
            assert_eq!(settled(DamperPolicy::HoelscherHuang, w, 0.0, 5.0 * v, 0.0), w * v > 0.0);
            assert!(!settled(DamperPolicy::Low, w, v, 5.0 * v, 0.0));
            // The body's velocity decides where it is large against the acceleration, and the acceleration else.
            assert_eq!(settled(DamperPolicy::ShAdd, w, v, -5.0 * v, 0.0), w * v > 0.0);
            assert_eq!(settled(DamperPolicy::ShAdd, w, 0.1 * v, -5.0 * v, 0.0), w * v < 0.0);
        }
    }
}

#[test]
fn a_quiet_body_rests_the_valves_and_a_near_stop_does_not() {
    assert!(!settled(DamperPolicy::Karnopp, 0.3, 0.05, 0.0, 0.0));
    assert!(settled(DamperPolicy::Karnopp, -0.3, 0.0, 0.0, 0.07));
    assert!(!settled(DamperPolicy::Karnopp, 0.3, 0.0, 0.0, 0.07));
}

/// Names lead back to policies, and each value outside its range is named.
#[test]
fn policies_have_names_and_values_have_ranges() {
    for name in <DamperPolicy as strum::VariantNames>::VARIANTS {
        assert_eq!(name.parse().map(DamperPolicy::name), Ok(*name));
    }
    assert_eq!(Tuning::default().check(), Ok(()));
    let velocity = Tuning {
        body_velocity_share_s: -0.1,
        ..Tuning::default()
    };
    let name = velocity.check().map_err(|error| error.name);
    assert_eq!(name, Err("tuning.strategy.ride_handling.dampers.body_velocity_share_s"));
    let acceleration = Tuning {
        body_acceleration_share: 101.0,
        ..Tuning::default()
    };
    let name = acceleration.check().map_err(|error| error.name);
    assert_eq!(
        name,
        Err("tuning.strategy.ride_handling.dampers.body_acceleration_share")
    );
}

#[test]
fn near_resonance_the_velocity_decides_and_above_it_the_acceleration() {
    // 11.9 rad/s: 15 m/s2 of 2 m/s is nearer to the resonance, 30 m/s2 is above it.
    assert!(settled(DamperPolicy::ShAdd, 0.3, 2.0, -15.0, 0.0));
    assert!(!settled(DamperPolicy::ShAdd, 0.3, 2.0, -30.0, 0.0));
}

#[test]
fn near_each_stop_the_damping_is_high_while_the_strut_moves_on_towards_it() {
    for (x_m, extension_m_s, high) in [
        (0.07, -0.3, true),
        (0.07, 0.3, false),
        (0.05, -0.3, false),
        (-0.12, 0.3, true),
        (-0.12, -0.3, false),
        (-0.10, 0.3, false),
    ] {
        assert_eq!(
            settled(DamperPolicy::Karnopp, extension_m_s, 0.0, 0.0, x_m),
            high,
            "{x_m} m, {extension_m_s} m/s"
        );
    }
}

/// A strut that stands still, or only reaches the limit, is not braked.
#[test]
fn a_strut_must_be_beyond_the_limit_and_move_on() {
    let (jounce, rebound) = NEAR_STOP_M;
    for (x_m, speed_m_s) in [(0.07, 0.0), (-0.12, 0.0), (jounce, 0.3), (-rebound, -0.3)] {
        assert!(!near_stop(x_m, speed_m_s), "{x_m} m, {speed_m_s} m/s");
    }
}

/// Whatever the combination says: of a body at rest it sets no damper high, and near a stop one is.
#[test]
fn stops_come_before_the_combination() {
    let (parameters, mut state) = (parameters(DamperPolicy::NellSteyn), State::INITIAL);
    let trusted = Trusted {
        displacement_m: Corners::from_array([0.07, 0.0, -0.12, 0.07]),
        ..Trusted::default()
    };
    let estimate = Estimate {
        strut_speed_m_s: Corners::from_array([0.3, 0.3, -0.3, -0.3]),
        ..Estimate::default()
    };
    let low = state.step(&parameters, &estimate, &trusted);
    assert_eq!(low.into_array(), [false, true, false, true]);
}

/// Each strut stands half the spacing of its axle from the middle, the front ones ahead of the centre of gravity.
#[test]
fn struts_stand_where_the_vehicle_has_them() {
    let vehicle = VehicleDescription {
        axle_distance_m: Axles::new(1.2, 1.6),
        strut_spacing_m: Axles::new(0.8, 1.4),
        ..VehicleDescription::default()
    };
    let expected = [(1.2, 0.4), (1.2, -0.4), (-1.6, 0.7), (-1.6, -0.7)];
    assert_eq!(places_m(&vehicle).into_array(), expected);
}

/// Within 0.02 m/s nothing changes, and beyond it on the other side the damping is low again.
#[test]
fn the_relative_speed_has_a_dead_band() {
    let parameters = parameters(DamperPolicy::Karnopp);
    let mut state = State::INITIAL;
    let mut low = |extension_m_s: f32| {
        let mut last = Corners::splat(false);
        for _ in 0..100 {
            for corner in state.corners.values_mut() {
                corner.velocity_m_s = 0.4;
            }
            let estimate = Estimate {
                strut_speed_m_s: Corners::splat(-extension_m_s),
                ..Estimate::default()
            };
            last = state.step(&parameters, &estimate, &Trusted::default());
        }
        last
    };
    for (extension_m_s, is_low) in [
        (0.01, true),
        (0.03, false),
        (0.01, false),
        (-0.01, false),
        (-0.03, true),
        (-0.01, true),
    ] {
        assert_eq!(low(extension_m_s), Corners::splat(is_low), "{extension_m_s} m/s");
    }
}
