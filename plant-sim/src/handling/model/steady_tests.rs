//! The handling model in steady state against closed forms: bends against the bicycle model and the roll-axis model, links
//! against their share of the understeer, braking against the moment balance.

use std::sync::Arc;

use oleo_interface::{Axle, Corner, Corners};

use super::tests::{linear, on_springs, parameters, preset, without_links};
use super::*;
use crate::road::Flat;
use crate::vehicle::suspension::LinearElement;

/// Drive that keeps about to a speed.
fn hold(model: &HandlingModel<LinearElement>, speed_m_s: f64) -> Controls {
    let force = 20_000.0 * (speed_m_s - model.motion().speed_m_s);
    Controls {
        drive_force_n: force.max(0.0),
        brake_force_n: (-force).max(0.0),
        ..Controls::default()
    }
}

/// Steady state at a fixed steer angle and speed: `(steer - L / R) / a_y`, rad s2/m.
fn understeer(handling: &HandlingParameters, steer_rad: f64, speed: f64) -> (f64, f64) {
    let mut model = on_springs(handling, 4000.0, Arc::new(Flat), speed);
    for _ in 0..9000 {
        let held = hold(&model, speed);
        model.step(Corners::default(), Controls { steer_rad, ..held });
    }
    let motion = model.motion();
    let curvature = motion.rates_rad_s[2] / motion.speed_m_s;
    (
        (steer_rad - 2.794 * curvature) / motion.lateral_acceleration_m_s2,
        motion.lateral_acceleration_m_s2,
    )
}

#[test]
fn understeer_gradient_is_the_bicycle_models() {
    // Without tyre drag, camber effects and elastic links; a small angle: the linear bicycle model with pneumatic trails is
    // then exact.
    let mut handling = without_links();
    handling.tyre.qsy1 = 0.0;
    for coefficient in [
        &mut handling.tyre.phy3,
        &mut handling.tyre.pvy3,
        &mut handling.tyre.pvy4,
    ] {
        *coefficient = 0.0;
    }
    let mut p = parameters();
    for front_share in [0.5, 0.44, 0.56] {
        p.body.front_mass_share = front_share;
        let loads = p.static_wheel_load_n();
        let [front, rear] = [Corner::FrontLeft, Corner::RearLeft].map(|corner| {
            let free = 0.382 + loads[corner] / 240_000.0;
            let tyre = handling.tyre.at(loads[corner], 0.0, free);
            (2.0 * tyre.cornering_stiffness_n_rad(), tyre.pneumatic_trail_m())
        });
        let mass = p.total_mass_kg();
        let wheelbase = p.layout.wheelbase_m;
        let (a, b) = (wheelbase * (1.0 - front_share), wheelbase * front_share);
        let (a, b) = (a - front.1, b + rear.1);
        let expected = mass / (a + b) * (b / front.0 - a / rear.0);

        let elements = linear(&p, 40_000.0, 4000.0);
        let mut model = HandlingModel::with_elements(&p, &handling, elements, Arc::new(Flat), 20.0).unwrap();
        for _ in 0..12_000 {
            let held = hold(&model, 20.0);
            let steer_rad = 0.002;
            model.step(Corners::default(), Controls { steer_rad, ..held });
        }
        let motion = model.motion();
        let curvature = motion.rates_rad_s[2] / motion.speed_m_s;
        let found = (0.002 - wheelbase * curvature) / motion.lateral_acceleration_m_s2;
        assert!(
            (found - expected).abs() < 2e-5,
            "share {front_share}: {found:e} {expected:e}"
        );
    }
    // And in the nonlinear range it understeers more: load transfer and the sagging characteristic.
    let (small, _) = understeer(&preset(), 0.002, 20.0);
    let (large, lateral) = understeer(&preset(), 0.05, 15.0);
    assert!(
        lateral > 2.5 && (large - small).abs() < 0.02,
        "{small} {large} {lateral}"
    );
}

#[test]
fn roll_in_a_steady_bend_is_that_of_the_roll_axis_model() {
    // Sprung mass on springs about roll centres, tyres included: moments about the ground.
    let p = parameters();
    let handling = without_links();
    let mut model = on_springs(&handling, 4000.0, Arc::new(Flat), 15.0);
    for _ in 0..12_000 {
        let held = hold(&model, 15.0);
        let steer_rad = 0.012;
        model.step(Corners::default(), Controls { steer_rad, ..held });
    }
    let motion = model.motion();
    let lateral = motion.lateral_acceleration_m_s2;
    let (ms, h) = (p.body.sprung_mass_kg, p.body_cg_height_m());
    let axis = 0.5 * (handling.front_axle.roll_centre_height_m + handling.rear_axle.roll_centre_height_m);
    // Body over its axles: struts at half a metre, anti-roll bars (torsion makes them a little softer).
    let bars = p.front_axle.anti_roll_stiffness_n_m_rad + p.rear_axle.anti_roll_stiffness_n_m_rad;
    let spring = 2.0 * (0.5 * 40_000.0) + bars;
    let arm = h - axis;
    let relative = ms * arm * lateral / (spring - ms * GRAVITY_M_S2 * arm);
    // Axles over the tyres: everything above the ground.
    let tyre = 2.0 * (0.5 * 1.486 * 1.486 * 240_000.0);
    let mass = p.total_mass_kg();
    let height = p.body.vehicle_cg_height_m;
    let lean = (mass * height * lateral + ms * GRAVITY_M_S2 * arm * relative) / (tyre - mass * GRAVITY_M_S2 * height);
    let expected = relative + lean;
    assert!(
        (motion.roll_rad / expected - 1.0).abs() < 0.04,
        "{} {expected}",
        motion.roll_rad
    );
}

/// Understeer gradient of a small steer angle, rad s2/m, and the model at its end.
fn gradient(handling: &HandlingParameters) -> (f64, HandlingModel<LinearElement>) {
    let mut model = on_springs(handling, 4000.0, Arc::new(Flat), 20.0);
    for _ in 0..12_000 {
        let held = hold(&model, 20.0);
        let steer_rad = 0.004;
        model.step(Corners::default(), Controls { steer_rad, ..held });
    }
    let motion = model.motion();
    let curvature = motion.rates_rad_s[2] / motion.speed_m_s;
    let found = (0.004 - 2.794 * curvature) / motion.lateral_acceleration_m_s2;
    (found, model)
}

/// The linkage gives way by the front axle's side force times both trails over its stiffness.
#[test]
fn steering_linkage_understeers_by_its_closed_form() {
    let rigid = without_links();
    let mut elastic = rigid.clone();
    elastic.steering.linkage_stiffness_n_m_rad = 20_000.0;
    let p = parameters();
    let load = p.static_wheel_load_n()[Corner::FrontLeft];
    let trail = rigid.tyre.at(load, 0.0, 0.382 + load / 240_000.0).pneumatic_trail_m();
    let half = 0.5 * p.layout.wheelbase_m;
    // Side force of the front axle per lateral acceleration: moments about the rear axle's point of attack.
    let front = p.total_mass_kg() * (half + trail) / (2.0 * half);
    let expected = front * (trail + rigid.steering.castor_trail_m) / 20_000.0;
    let (with, without) = (gradient(&elastic).0, gradient(&rigid).0);
    assert!(
        ((with - without) / expected - 1.0).abs() < 0.03,
        "{with:e} {without:e} {expected:e}"
    );
    assert!(expected.to_degrees() * GRAVITY_M_S2 > 1.0, "it is the largest share");
}

/// Roll steer understeers by each axle's coefficient times the roll of the body against that axle.
#[test]
fn roll_steer_understeers_by_its_closed_form() {
    let straight = without_links();
    let mut steered = straight.clone();
    steered.front_axle.roll_understeer = 0.05;
    steered.rear_axle.roll_understeer = 0.03;
    let (without, _) = gradient(&straight);
    let (with, model) = gradient(&steered);
    let lateral = model.motion().lateral_acceleration_m_s2;
    let lean = |axle: Axle| -model.axles()[axle].roll / lateral;
    let expected = 0.05 * lean(Axle::Front) + 0.03 * lean(Axle::Rear);
    assert!(expected > 0.0);
    assert!(
        ((with - without) / expected - 1.0).abs() < 0.03,
        "{with:e} {without:e} {expected:e}"
    );
}

/// Braking steadily, the springs of an axle carry the load transfer `m a H / L` less what the links carry, `F h / d`, and less
/// the inertia of the axle itself at its own height.
#[test]
fn links_carry_their_share_of_the_load_transfer() {
    let p = parameters();
    let braked = |handling: &HandlingParameters| {
        let mut model = on_springs(handling, 6000.0, Arc::new(Flat), 35.0);
        for _ in 0..3000 {
            let controls = Controls {
                brake_force_n: 8000.0,
                ..Controls::default()
            };
            model.step(Corners::default(), controls);
        }
        model
    };
    let springs = |model: &HandlingModel<LinearElement>, axle: Axle| -> f64 {
        let compression = model.strut_displacement_m();
        compression.of_axle(axle).iter().map(|x| 40_000.0 * **x).sum()
    };
    let (straight, guided) = (braked(&without_links()), braked(&preset()));
    for model in [&straight, &guided] {
        let wheels = model.wheels();
        let force = |axle: Axle| -> f64 { wheels.of_axle(axle).iter().map(|wheel| -wheel.longitudinal_n).sum() };
        let decelerated = (force(Axle::Front) + force(Axle::Rear)) / p.total_mass_kg();
        assert!(decelerated > 3.5, "{decelerated}");
        let transfer = p.total_mass_kg() * decelerated * p.body.vehicle_cg_height_m / p.layout.wheelbase_m;
        for (axle, loaded) in [(Axle::Front, 1.0), (Axle::Rear, -1.0)] {
            let (mass, radius) = (p.axle(axle).mass_kg, p.axle(axle).tyre_radius_m);
            let links = preset();
            let links = links.axle(axle);
            // The instant centre sinks and rises with the body above this axle.
            let compression = model.strut_displacement_m();
            let sunk_m: f64 = compression.of_axle(axle).iter().map(|x| 0.5 * **x).sum();
            let wheel_m: f64 = wheels
                .of_axle(axle)
                .iter()
                .map(|w| 0.5 * (w.centre_height_m - radius))
                .sum();
            let height = links.side_view_instant_centre_height_m - sunk_m + wheel_m;
            let share = (force(axle) * height - mass * decelerated * (height - radius)) / links.side_view_swing_arm_m;
            let lift = if core::ptr::eq(model, &guided) { share } else { 0.0 };
            let (found, carried) = (springs(model, axle), loaded * (transfer - lift));
            // The body's weight moves as it pitches, spinning wheels are slowed and roll with resistance: some per cent.
            assert!(
                (found - carried).abs() < 0.07 * transfer,
                "{axle:?}: {found} {carried} of {transfer}"
            );
            // What the links take, alone.
            let taken = loaded * (springs(&straight, axle) - springs(&guided, axle));
            assert!(
                (taken - share).abs() < 0.03 * transfer,
                "{axle:?}: {taken} {share} of {transfer}"
            );
        }
    }
}

/// In a steady bend a unit in the centre of mass reads gravity and `v r` together, whatever the roll, and at another place of the body
/// `r^2` times the distance from the vertical axis less; speed and yaw rate are taken from the path through the world alone.
#[test]
fn an_inertial_unit_in_a_bend_reads_what_the_circle_says() {
    let speed = 15.0;
    let mut model = on_springs(&preset(), 4000.0, Arc::new(Flat), speed);
    let mut path = Vec::new();
    for step in 0..9000 {
        let held = hold(&model, speed);
        model.step(
            Corners::default(),
            Controls {
                steer_rad: 0.06,
                ..held
            },
        );
        if step >= 8900 {
            path.push(Vector3::from(model.motion().position_m));
        }
    }
    let motion = model.motion();
    let [before, after] = [path[98] - path[97], path[99] - path[98]];
    let yaw_rate = before.cross(&after).z / before.norm_squared() / model.step_s();
    let driven = after.norm() / model.step_s();
    assert!(
        motion.roll_rad.abs() > 0.02 && yaw_rate > 0.2,
        "{} {yaw_rate}",
        motion.roll_rad
    );

    let centre = Vector3::from(model.inertial_at([0.0; 3]).specific_force_m_s2);
    let expected = libm::hypot(GRAVITY_M_S2, driven * yaw_rate);
    assert!((centre.norm() - expected).abs() < 2e-3, "{} {expected}", centre.norm());
    let (sin, cos) = libm::sincos(motion.roll_rad);
    let rate = model.inertial_at([0.0; 3]).rate_rad_s;
    assert!(
        (rate[1] - yaw_rate * sin).abs() < 1e-3 && (rate[2] - yaw_rate * cos).abs() < 1e-3,
        "{rate:?}"
    );

    let ahead = Vector3::from(model.inertial_at([1.4, 0.0, 0.0]).specific_force_m_s2) - centre;
    assert!(
        (ahead.x + 1.4 * yaw_rate * yaw_rate).abs() < 1e-3 && ahead.yz().norm() < 5e-3,
        "{ahead}"
    );
}
