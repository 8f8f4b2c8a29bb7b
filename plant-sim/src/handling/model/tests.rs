//! The handling model against what does not depend on it: weight, conservation, mirror images, the ride model.

use std::sync::Arc;

use oleo_interface::{Axles, StrutValves};

use super::*;
use crate::road::{Flat, Road};
use crate::strut::StrutModel;
use crate::vehicle::RideModel;
use crate::vehicle::suspension::LinearElement;

const SOFT: Corners<StrutValves<bool>> = Corners::from_array([StrutValves::new(true, true, true); 4]);

pub(super) fn parameters() -> VehicleParameters {
    VehicleParameters::defender110()
}

pub(super) fn linear(parameters: &VehicleParameters, stiffness: f64, damping: f64) -> Corners<LinearElement> {
    parameters
        .static_strut_load_n()
        .map(|load| LinearElement::new(load, stiffness, damping))
}

pub(super) fn on_springs(
    handling: &HandlingParameters,
    damping: f64,
    road: Arc<dyn Road>,
    speed: f64,
) -> HandlingModel<LinearElement> {
    let p = parameters();
    HandlingModel::with_elements(&p, handling, linear(&p, 40_000.0, damping), road, speed).unwrap()
}

fn on_struts(road: Arc<dyn Road>, speed: f64) -> HandlingVehicle {
    let p = parameters();
    let struts = p
        .static_strut_load_n()
        .map(|load| Strut::at_rest(&StrutModel::defender110(load), StrutValves::splat(true)).unwrap());
    HandlingVehicle::new(&p, &HandlingParameters::defender110(), struts, road, speed).unwrap()
}

#[test]
fn at_rest_it_stays_and_the_wheels_carry_the_weight() {
    let mut model = on_struts(Arc::new(Flat), 0.0);
    for _ in 0..1000 {
        model.step(SOFT, Controls::default());
    }
    let loads = model.wheels().map(|wheel| wheel.load_n);
    let weight = parameters().total_mass_kg() * GRAVITY_M_S2;
    assert!((loads.values().sum::<f64>() / weight - 1.0).abs() < 2e-4, "{loads:?}");
    let expected = parameters().static_wheel_load_n();
    for (corner, load) in loads.iter() {
        assert!((load / expected[corner] - 1.0).abs() < 1e-3, "{load} {expected:?}");
    }
    let motion = model.motion();
    assert!(
        motion.position_m[2].abs() < 1e-4 && motion.speed_m_s.abs() < 1e-3,
        "{motion:?}"
    );
    assert_eq!((motion.position_m[1], motion.yaw_rad, motion.roll_rad), (0.0, 0.0, 0.0));
}

/// The preset with links that guide the axle straight up and down, and a rigid steering linkage.
pub(super) fn without_links() -> HandlingParameters {
    let mut handling = preset();
    handling.steering.linkage_stiffness_n_m_rad = 1e9;
    for axle in [&mut handling.front_axle, &mut handling.rear_axle] {
        axle.side_view_swing_arm_m = 1e6;
        axle.side_view_instant_centre_height_m = 0.0;
        axle.roll_understeer = 0.0;
    }
    handling
}

/// Thrown into the air, spinning about all axes with spinning wheels and swinging axles: no force but gravity.
fn thrown(step_s: f64, mut handling: HandlingParameters) -> HandlingModel<LinearElement> {
    let mut p = parameters();
    p.solver.step_s = step_s;
    handling.frame.torsional_damping_ratio = 0.0;
    let elements = linear(&p, 40_000.0, 0.0);
    let mut model = HandlingModel::with_elements(&p, &handling, elements, Arc::new(Flat), 20.0).unwrap();
    let rates = Axles::new(
        AxleCoordinates { heave: 0.4, roll: 0.8 },
        AxleCoordinates {
            heave: -0.3,
            roll: -0.5,
        },
    );
    model.throw(50.0, [20.0, 1.0, 5.0], [1.5, -0.4, 0.7], rates);
    model
}

pub(super) fn preset() -> HandlingParameters {
    HandlingParameters::defender110()
}

fn energy(model: &HandlingModel<LinearElement>) -> f64 {
    let load = parameters().static_strut_load_n();
    let displacement = model.strut_displacement_m();
    let springs = displacement
        .iter()
        .map(|(corner, x)| load[corner] * x + 0.5 * 40_000.0 * x * x);
    model.energy_j() + springs.sum::<f64>()
}

fn drift(step_s: f64, handling: HandlingParameters) -> (f64, f64, f64) {
    let mut model = thrown(step_s, handling);
    let (momentum, angular) = model.momentum();
    let start = energy(&model);
    let steps = (1.2 / step_s).round() as usize;
    let mut worst = (0.0f64, 0.0f64);
    for i in 1..=steps {
        model.step(Corners::default(), Controls::default());
        let (now, turning) = model.momentum();
        let fallen = Vector3::new(
            0.0,
            0.0,
            -parameters().total_mass_kg() * GRAVITY_M_S2 * step_s * i as f64,
        );
        worst.0 = worst.0.max((now - momentum - fallen).norm() / momentum.norm());
        worst.1 = worst.1.max((turning - angular).norm() / angular.norm());
    }
    // It has turned by far more than a right angle meanwhile: nothing is small.
    assert!(model.wheels().values().all(|wheel| wheel.load_n == 0.0));
    (worst.0, worst.1, (energy(&model) - start).abs())
}

#[test]
fn in_the_air_momentum_and_energy_are_conserved() {
    let (momentum, angular, lost) = drift(0.001, without_links());
    assert!(momentum < 2e-4 && angular < 2e-4, "{momentum:e} {angular:e}");
    // Some 7 kJ of relative motion and turning; second order: a quarter at half the step.
    assert!(lost < 20.0, "{lost}");
    let (half_momentum, half_angular, half_lost) = drift(0.0005, without_links());
    for (whole, half) in [(momentum, half_momentum), (angular, half_angular), (lost, half_lost)] {
        assert!(half < 0.4 * whole + 1e-9, "{whole:e} {half:e}");
    }
}

/// With links, up to the small terms that `guide` leaves out: they do not fall with the step.
#[test]
fn in_the_air_links_keep_momentum_and_energy() {
    let (momentum, angular, lost) = drift(0.001, preset());
    assert!(
        momentum < 2e-4 && angular < 2e-4 && lost < 20.0,
        "{momentum:e} {angular:e} {lost}"
    );
}

/// On the ground, where tyres and links act on each other: an undamped vehicle that bounces, rolls and slides with links far
/// steeper than a real vehicle's may lose energy in its tyres, but not gain any.
#[test]
fn links_make_no_energy() {
    let mut p = parameters();
    p.front_axle.tyre_damping_n_s_m = 0.0;
    p.rear_axle.tyre_damping_n_s_m = 0.0;
    let mut handling = preset();
    handling.frame.torsional_damping_ratio = 0.0;
    for axle in [&mut handling.front_axle, &mut handling.rear_axle] {
        axle.side_view_swing_arm_m = 0.9;
        axle.side_view_instant_centre_height_m = 0.8;
        axle.roll_understeer = 0.2;
    }
    let elements = linear(&p, 40_000.0, 0.0);
    let mut model = HandlingModel::with_elements(&p, &handling, elements, Arc::new(Flat), 15.0).unwrap();
    model.throw(0.0, [15.0, 0.5, -0.3], [0.4, 0.2, 0.1], Axles::default());
    let tyres = |model: &HandlingModel<LinearElement>| -> f64 {
        let free_m = p.front_axle.tyre_radius_m + p.static_wheel_load_n()[Corner::FrontLeft] / 240_000.0;
        let squash = |wheel: &WheelState| (free_m - (wheel.centre_height_m - wheel.road_height_m)).max(0.0);
        let wheels = model.wheels();
        wheels
            .values()
            .map(|wheel| 0.5 * 240_000.0 * squash(wheel) * squash(wheel))
            .sum()
    };
    let start = energy(&model) + tyres(&model);
    let mut least = start;
    for _ in 0..4000 {
        model.step(Corners::default(), Controls::default());
        let now = energy(&model) + tyres(&model);
        // Of some 230 kJ of motion, 3 kJ of it in the suspension.
        assert!(now < least + 15.0, "{now} {least}");
        least = least.min(now);
    }
    assert!(start - least > 1000.0, "the tyres take some: {start} {least}");
}

#[test]
fn damping_only_takes_energy() {
    let p = parameters();
    let handling = preset();
    let mut model =
        HandlingModel::with_elements(&p, &handling, linear(&p, 40_000.0, 2500.0), Arc::new(Flat), 0.0).unwrap();
    model.throw(
        30.0,
        [0.0; 3],
        [1.0, 0.5, -0.7],
        Axles::from_fn(|_| AxleCoordinates { heave: 0.6, roll: 1.0 }),
    );
    let mut last = energy(&model);
    let start = last;
    for _ in 0..1500 {
        model.step(Corners::default(), Controls::default());
        let now = energy(&model);
        assert!(now < last + 0.05, "{now} {last}");
        last = now;
    }
    assert!(start - last > 100.0);
}

/// Waves of 2 m and 1 m, left and right unlike: over a base of 2 m their slope is nothing.
struct Waves;
impl Road for Waves {
    fn height_m(&self, station_m: f64, lateral_m: f64) -> f64 {
        let x = core::f64::consts::PI * station_m;
        let phase = if lateral_m > 0.0 { 0.4 } else { -0.9 };
        0.01 * libm::sin(x + phase) + 0.005 * libm::sin(2.0 * x - phase)
    }
}

#[test]
fn with_vertical_forces_only_it_moves_as_the_ride_model_does() {
    // No friction, and a plane that sees no slope: what is left is heave, pitch and roll on the same springs. Tyre damping
    // is off since it is the one thing the two models feed with different road speeds then.
    let mut p = parameters();
    p.front_axle.tyre_damping_n_s_m = 0.0;
    p.rear_axle.tyre_damping_n_s_m = 0.0;
    let road: Arc<dyn Road> = Arc::new(Waves);
    let springs = || linear(&p, 40_000.0, 2500.0);
    let mut ride: RideModel<LinearElement> = RideModel::with_elements(&p, springs(), Arc::clone(&road), 10.0).unwrap();
    let mut handling = without_links();
    handling.ground.plane_length_m = 2.0;
    handling.frame.torsional_stiffness_n_m_rad = 1e8;
    handling.tyre.friction_scale = 0.0;
    let mut model = HandlingModel::with_elements(&p, &handling, springs(), road, 10.0).unwrap();
    let (mut difference, mut size) = ([0.0; 4], [0.0; 4]);
    for i in 0..6000 {
        model.step(Corners::default(), Controls::default());
        ride.step(Corners::default());
        if i > 2000 {
            let (a, b) = (model.motion(), ride.body());
            let (axle, _) = model.axle_heave_roll(Axle::Front);
            let pairs = [
                (a.position_m[2], b.heave_m),
                (a.pitch_rad, b.pitch_rad),
                (a.roll_rad, b.roll_rad),
                (axle, ride.state().0.front_heave),
            ];
            for (k, (x, y)) in pairs.into_iter().enumerate() {
                difference[k] += (x - y) * (x - y);
                size[k] += y * y;
            }
        }
    }
    let ratio: [f64; 4] = core::array::from_fn(|k| (difference[k] / size[k]).sqrt());
    println!("relative difference to the ride model: heave, pitch, roll, front axle {ratio:?}");
    // Appendix A has no fore-aft or sideways motion. Here the axles' mass swings with the body's pitch (4 % more inertia)
    // and its roll pushes them sideways; the axles' own heave has neither.
    assert!(
        ratio[0] < 0.06 && ratio[1] < 0.05 && ratio[2] < 0.5 && ratio[3] < 0.01,
        "{ratio:?}"
    );
}

#[test]
fn tripped_it_rolls_over_and_the_equations_hold_beyond() {
    let p = parameters();
    let mut model = on_springs(&preset(), 4000.0, Arc::new(Flat), 20.0);
    model.throw(0.0, [20.0, 0.0, 0.0], [9.0, 0.0, 0.0], Axles::default());
    let mut worst: f64 = 0.0;
    for _ in 0..2000 {
        model.step(Corners::default(), Controls::default());
        worst = worst.max(model.motion().roll_rad.abs());
        assert!(model.motion().position_m.iter().all(|x| x.is_finite()));
        if worst > 2.0 {
            break;
        }
    }
    assert!(worst > 2.0, "{worst} {}", p.name);
}

#[test]
fn a_strut_that_does_not_carry_its_corner_is_refused() {
    let p = parameters();
    let struts =
        Corners::from_fn(|_| Strut::at_rest(&StrutModel::defender110(3000.0), StrutValves::splat(true)).unwrap());
    let refused = HandlingVehicle::new(&p, &preset(), struts, Arc::new(Flat), 10.0);
    assert!(matches!(
        refused.err(),
        Some(RideError::StaticLoad {
            corner: Corner::FrontLeft,
            ..
        })
    ));
}
