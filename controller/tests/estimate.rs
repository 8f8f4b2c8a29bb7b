//! The estimator against rigid-body mechanics worked out beforehand: a body of known mass and inertia is given a motion, the forces that
//! cause it are computed by Newton and Euler in f64, and the estimate must find the motion again.

use oleo_controller::estimate::{GRAVITY_M_S2, State};
use oleo_controller::plausibility::Trusted;
use oleo_controller::{
    Axles, Builder, Configuration, Corner, Corners, Estimate, Gauge, Side, StrutPressures, VehicleDescription,
};

const MASS_KG: f64 = 1600.0;
const G: f64 = GRAVITY_M_S2 as f64;

struct Motion {
    vertical: f64,
    roll: f64,
    pitch: f64,
}

/// Pressures of the four struts that give the body these accelerations from rest; displacements zero.
fn trusted(motion: &Motion) -> Trusted {
    let b = VehicleDescription::default();
    let Axles { front: a, rear: c } = b.axle_distance_m.map(f64::from);
    let half = 0.5 * f64::from(b.strut_spacing_m.front);
    let roll_inertia = MASS_KG * f64::from(b.roll_gyration_m * b.roll_gyration_m);
    let pitch_inertia = MASS_KG * f64::from(b.pitch_gyration_m * b.pitch_gyration_m);
    let (front_weight, rear_weight) = (MASS_KG * G * c / (a + c) / 2.0, MASS_KG * G * a / (a + c) / 2.0);
    // Heave force shared as the weight, so that it turns nothing; a couple left to right; a couple front to rear (nose down: rear up).
    let heave = motion.vertical / G;
    let side = roll_inertia * motion.roll / (4.0 * half);
    let ends = pitch_inertia * motion.pitch / (2.0 * (a + c));
    let force = Corners::from_array([
        front_weight * (1.0 + heave) + side - ends,
        front_weight * (1.0 + heave) - side - ends,
        rear_weight * (1.0 + heave) + side + ends,
        rear_weight * (1.0 + heave) - side + ends,
    ]);
    let pressure = force.map(|f| StrutPressures::splat(Gauge((f / f64::from(b.piston_area_m2)) as f32)));
    Trusted {
        pressure,
        ..Trusted::default()
    }
}

fn still() -> Motion {
    Motion {
        vertical: 0.0,
        roll: 0.0,
        pitch: 0.0,
    }
}

fn at_rest() -> (Configuration, State) {
    let (c, mut state) = (Configuration::defender110(), State::default());
    // Until the memories have grown to their length.
    for _ in 0..4_000 {
        let estimate = state.step(&c.estimate, &trusted(&still()));
        assert!(estimate.vertical_acceleration_m_s2.abs() < 1e-4);
    }
    (c, state)
}

fn near(what: &str, found: f32, expected: f64, tolerance: f64) {
    assert!(
        (f64::from(found) - expected).abs() <= tolerance,
        "{what}: {found}, expected {expected}"
    );
}

#[test]
fn accelerations_are_found_again() {
    for (vertical, roll, pitch) in [(2.0, 0.0, 0.0), (0.0, 1.5, 0.0), (0.0, 0.0, 1.2), (-1.0, 0.7, -0.9)] {
        let (c, mut state) = at_rest();
        let e = state.step(&c.estimate, &trusted(&Motion { vertical, roll, pitch }));
        near("vertical", e.vertical_acceleration_m_s2, vertical, 2e-3);
        near("roll", e.roll_acceleration_rad_s2, roll, 2e-3);
        near("pitch", e.pitch_acceleration_rad_s2, pitch, 2e-3);
    }
}

/// A load that is not in the middle turns nothing, and anti-roll bars turn the body back by their stiffness over its inertia.
#[test]
fn an_uneven_load_turns_nothing_and_each_bar_turns_back() {
    let vehicle = VehicleDescription {
        strut_spacing_m: Axles::new(1.0, 1.2),
        anti_roll_stiffness_n_m_rad: Axles::new(5.0e3, 8.0e3),
        ..VehicleDescription::default()
    };
    let builder = Builder {
        vehicle,
        ..Builder::default()
    };
    let (c, mut state) = (builder.build().expect("a valid vehicle"), State::default());
    let force_n = Corners::from_array([5_200.0, 4_000.0, 3_800.0, 3_000.0]);
    let weight_n: f64 = force_n.values().sum();
    let at = |displacement_m: [f32; 4]| Trusted {
        displacement_m: Corners::from_array(displacement_m),
        pressure: force_n.map(|f| StrutPressures::splat(Gauge((f / f64::from(vehicle.piston_area_m2)) as f32))),
        ..Trusted::default()
    };
    for _ in 0..4_000 {
        let e = state.step(&c.estimate, &at([0.0; 4]));
        near("roll at rest", e.roll_acceleration_rad_s2, 0.0, 1e-4);
        near("pitch at rest", e.pitch_acceleration_rad_s2, 0.0, 1e-4);
    }
    let e = state.step(&c.estimate, &at([-0.01, 0.01, -0.006, 0.006]));
    let bars_n_m = 5.0e3 * 0.02 / 1.0 + 8.0e3 * 0.012 / 1.2;
    let inertia = weight_n / G * f64::from(vehicle.roll_gyration_m * vehicle.roll_gyration_m);
    near("roll", e.roll_acceleration_rad_s2, -bars_n_m / inertia, 1e-3);
    near("pitch", e.pitch_acceleration_rad_s2, 0.0, 1e-4);
}

#[test]
fn attitude_and_speed_from_displacements() {
    let (c, mut state) = at_rest();
    let mut e = Estimate::default();
    let rate = Corners::from_array([0.1f32, 0.3, -0.2, 0.1]); // m/s
    for n in 0..200 {
        let x = rate.map(|v| v * n as f32 * 0.005 * 0.1);
        e = state.step(
            &c.estimate,
            &Trusted {
                displacement_m: x,
                ..trusted(&still())
            },
        );
    }
    for (_, (speed, rate)) in e.strut_speed_m_s.zip(rate).iter() {
        near("speed", *speed, f64::from(0.1 * rate), 1e-4);
    }
    near("roll rate", e.roll_rate_rad_s, 0.1 * (0.2 + 0.3) / 2.0, 1e-4);
    let t = 199.0 * 0.005 * 0.1;
    near("roll", e.roll_rad, t * (0.2 + 0.3) / 2.0, 1e-5);
    near("pitch", e.pitch_rad, t * (0.2 + 0.05) / 2.794, 1e-5);
    near("heave", e.heave_m, -t * (0.2 * 1.405 - 0.05 * 1.389) / 2.794, 1e-5);
}

#[test]
fn steady_cornering() {
    // Left turn of 3 m/s2, body rolled by phi: struts and bars hold m (a_y h + g h phi) about the roll axis.
    let b = VehicleDescription::default();
    let (a_y, phi, h) = (3.0, 0.03, f64::from(b.roll_arm_m));
    let bars = phi * f64::from(b.anti_roll_stiffness_n_m_rad.front + b.anti_roll_stiffness_n_m_rad.rear);
    let struts = MASS_KG * h * (a_y + G * phi) - bars;
    let (c, mut state) = at_rest();
    let mut turn = trusted(&still());
    for corner in Corner::ALL {
        // Four struts at half a metre: right side loaded.
        let side = if corner.side() == Side::Left { -1.0 } else { 1.0 };
        let more = (side * struts / 4.0 / 0.5 / f64::from(b.piston_area_m2)) as f32;
        turn.pressure[corner].p1 = turn.pressure[corner].p1 + more;
        turn.displacement_m[corner] = (side * 0.5 * phi) as f32;
    }
    let mut lateral = 0.0f32;
    for _ in 0..200 {
        lateral = state.step(&c.estimate, &turn).lateral.acceleration_m_s2.quick;
    }
    near("lateral", lateral, a_y, 0.2); // after 1 s: bias learning and static load have taken a little
}

#[test]
fn what_p1_shows_too_much_is_no_force() {
    let (parameters, state) = at_rest();
    let motion = Motion { roll: 1.5, ..still() };
    let right = trusted(&motion);
    let mut wrong = right;
    for (corner, offset_pa) in [(Corner::FrontLeft, 0.7e6), (Corner::RearRight, -0.4e6)] {
        wrong.pressure[corner].p1 = Gauge(wrong.pressure[corner].p1.pa() + offset_pa);
        wrong.p1_offset_pa[corner] = offset_pa;
    }
    let [right, wrong] = [right, wrong].map(|trusted| { state }.step(&parameters.estimate, &trusted));
    let near_to = |a: f32, b: f32| (a - b).abs() < 1e-3;
    assert!(near_to(
        wrong.vertical_acceleration_m_s2,
        right.vertical_acceleration_m_s2
    ));
    assert!(near_to(wrong.roll_acceleration_rad_s2, right.roll_acceleration_rad_s2));
    near("roll", right.roll_acceleration_rad_s2, motion.roll, 1e-2);
}

#[test]
fn payload_needs_no_parameter() {
    let (c, mut state) = (Configuration::defender110(), State::default());
    let load = |share: f32| {
        let mut t = trusted(&still());
        for pressure in t.pressure.values_mut() {
            pressure.p1 = Gauge(pressure.p1.pa() * share);
        }
        t
    };
    for _ in 0..4_000 {
        state.step(&c.estimate, &load(1.7));
    }
    near(
        "laden",
        state.step(&c.estimate, &load(1.7 * 1.1)).vertical_acceleration_m_s2,
        0.1 * G,
        1e-3,
    );
}

/// Running mean squares with a time constant of 1 s, of a motion that stays for a second.
#[test]
fn running_mean_squares() {
    let (c, mut state) = at_rest();
    let motion = Motion {
        vertical: 0.5,
        ..still()
    };
    let mut lateral_square = 0.0;
    let mut last = Estimate::default();
    for _ in 0..200 {
        last = state.step(&c.estimate, &trusted(&motion));
        let lateral = f64::from(last.lateral.acceleration_m_s2.quick);
        lateral_square += (lateral * lateral - lateral_square) * (1.0 - libm::exp(-0.005));
    }
    // The static load learns a twentieth of it meanwhile.
    near(
        "vertical",
        last.vertical_mean_square,
        0.25 * (1.0 - libm::exp(-1.0)),
        0.01,
    );
    near("lateral", last.lateral_mean_square, lateral_square, 1e-6);

    let (c, mut state) = at_rest();
    let motion = Motion { roll: 0.4, ..still() };
    let mut lateral_square = 0.0;
    for _ in 0..200 {
        last = state.step(&c.estimate, &trusted(&motion));
        let lateral = f64::from(last.lateral.acceleration_m_s2.quick);
        lateral_square += (lateral * lateral - lateral_square) * (1.0 - libm::exp(-0.005));
    }
    assert!(lateral_square > 1e-3, "{lateral_square}");
    near(
        "lateral",
        last.lateral_mean_square,
        lateral_square,
        1e-3 * lateral_square,
    );
}

/// What the left struts show too much from the first tick on is taken for uneven load, and a bend in which the controller starts is not:
/// there the gas carries the right side, too.
#[test]
fn uneven_load_from_the_start_is_no_bend_and_a_bend_is_no_uneven_load() {
    let c = Configuration::defender110();
    let b = VehicleDescription::default();
    for sign in [1.0, -1.0] {
        let uneven_n = sign * 1_000.0;
        let mut shown = trusted(&still());
        for corner in Corner::ALL {
            let side = if corner.side() == Side::Left { 1.0 } else { -1.0 };
            let more_pa = (side * uneven_n / f64::from(b.piston_area_m2)) as f32;
            shown.pressure[corner].p1 = shown.pressure[corner].p1 + more_pa;
        }
        let mut state = State::default();
        let started = state.step(&c.estimate, &shown).lateral.acceleration_m_s2;
        near("at once", started.quick, 0.0, 1e-3);
        for _ in 0..1_000 {
            let lateral = state.step(&c.estimate, &shown).lateral.acceleration_m_s2;
            near("uneven load", lateral.slow, 0.0, 1e-2);
        }

        // Four struts at half a metre, and the stiffness of the first gas.
        let lateral_m_s2 = -4.0 * 0.5 * uneven_n / (MASS_KG * f64::from(b.roll_arm_m));
        let stiffness_n_m = f64::from(b.piston_area_m2) * MASS_KG * G / (4.0 * f64::from(b.gas_volume_1_m3));
        let all_m = -2.0 * uneven_n / stiffness_n_m;
        // What the gas explains of it, in the mean: all, more than all, and a part, which is less than at first.
        for (shares, explained) in [
            ([1.0, 1.0], 1.0),
            ([1.5, 1.5], 1.0),
            ([0.6, 0.6], 0.6),
            ([0.8, 0.2], 0.5),
        ] {
            let mut state = State::default();
            let mut quick = 0.0;
            for tick in 0..400 {
                shown.load_to_right_m = (all_m * shares[tick % 2]) as f32;
                quick = state.step(&c.estimate, &shown).lateral.acceleration_m_s2.quick;
                if tick == 0 {
                    near("at once", quick, lateral_m_s2 * f64::min(shares[0], 1.0), 0.01);
                }
            }
            // In 2 s the bias learns an eighth of it, or of 1.2 m/s2.
            let bias_m_s2 = (explained * lateral_m_s2).clamp(-1.2, 1.2) * (1.0 - libm::exp(-2.0 / 15.0));
            near("bend", quick, explained * lateral_m_s2 - bias_m_s2, 0.05);
        }
    }
}
