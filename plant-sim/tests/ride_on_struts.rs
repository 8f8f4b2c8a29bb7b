//! The ride model on the two-stage struts, over the built-in roads: what the report's own model could not finish.

use std::sync::Arc;

use oleo_interface::{Axle, Corner, Corners, Side, StrutValves};
use oleo_plant_sim::measures::RideMeter;
use oleo_plant_sim::road::{ApgObstacle, Flat, Road, from_name_or_path};
use oleo_plant_sim::strut::{Strut, StrutModel};
use oleo_plant_sim::vehicle::{RideError, RideVehicle, VehicleParameters};

const SOFT: StrutValves<bool> = StrutValves::new(true, true, true);
const STIFF: StrutValves<bool> = StrutValves::new(false, false, false);

fn vehicle(step_s: f64, signals: StrutValves<bool>, road: Arc<dyn Road>, speed_km_h: f64) -> RideVehicle {
    let mut parameters = VehicleParameters::defender110();
    parameters.solver.step_s = step_s;
    let struts = parameters
        .static_strut_load_n()
        .map(|load| Strut::at_rest(&StrutModel::defender110(load), signals).unwrap());
    RideVehicle::new(&parameters, struts, road, speed_km_h / 3.6).unwrap()
}

#[test]
fn rests_on_its_struts() {
    for signals in [SOFT, STIFF] {
        let mut model = vehicle(1e-3, signals, Arc::new(Flat), 60.0);
        for _ in 0..3000 {
            model.step(Corners::from_array([signals; 4]));
        }
        let (q, rate) = model.state();
        assert!(
            q.to_array().iter().chain(&rate.to_array()).all(|x| x.abs() < 1e-6),
            "{q:?} {rate:?}"
        );
        let carried: f64 = model.strut_output().values().map(|out| out.force_n).sum();
        assert!((carried / (1600.0 * 9.80665) - 1.0).abs() < 1e-6);
    }
}

#[test]
fn a_strut_charged_for_a_truck_is_refused_in_one_line() {
    let parameters = VehicleParameters::defender110();
    let struts = Corners::from_fn(|_| Strut::at_rest(&StrutModel::defender110(16e3), SOFT).unwrap());
    let error = RideVehicle::new(&parameters, struts, Arc::new(Flat), 1.0)
        .err()
        .unwrap();
    assert!(matches!(
        error,
        RideError::StaticLoad {
            corner: Corner::FrontLeft,
            ..
        }
    ));
    assert!(!error.to_string().contains('\n'));
}

/// Report, section 2.2: at 10 km/h over the APG obstacle its simulation ended where a table ended. Here it goes through
/// and settles again, in every setting and with either side.
#[test]
fn apg_obstacle_is_crossed_to_the_end() {
    for (name, signals, speed) in [
        ("apg-left", SOFT, 10.0),
        ("apg-right", SOFT, 10.0),
        ("apg-both", STIFF, 10.0),
        ("apg-both", SOFT, 60.0),
    ] {
        let mut model = vehicle(1e-3, signals, from_name_or_path(name, 20.0, 0).unwrap(), speed);
        let mut travel: f64 = 0.0;
        let mut roll: f64 = 0.0;
        for _ in 0..12_000 {
            model.step(Corners::from_array([signals; 4]));
            travel = model
                .strut_displacement_m()
                .values()
                .fold(travel, |most, x| most.max(x.abs()));
            roll = if model.body().roll_rad.abs() > roll.abs() {
                model.body().roll_rad
            } else {
                roll
            };
            assert!(model.body().heave_acceleration_m_s2.is_finite());
        }
        assert!(travel > 0.02, "{name}: the struts move {travel} m");
        match name {
            "apg-left" => assert!(roll > 0.03, "left side up is positive: {roll}"),
            "apg-right" => assert!(roll < -0.03, "{roll}"),
            _ => assert!(roll.abs() < 1e-9, "{roll}"),
        }
        let body = model.body();
        assert!(
            body.heave_m.abs() < 0.02 && body.roll_rad.abs() < 0.02,
            "{name} settles: {body:?}"
        );
    }
}

#[test]
fn mirrored_obstacles_give_mirrored_bits() {
    let on = |side| {
        let side = Some(side);
        vehicle(1e-3, SOFT, Arc::new(ApgObstacle { start_m: 1.0, side }), 15.0)
    };
    let (mut left, mut right) = (on(Side::Left), on(Side::Right));
    for step in 0..1500 {
        let signals = if (step / 200) % 2 == 0 { SOFT } else { STIFF };
        left.step(Corners::from_array([signals; 4]));
        right.step(Corners::from_array([signals; 4]));
        assert_eq!(left.body().heave_m.to_bits(), right.body().heave_m.to_bits());
        assert_eq!(left.body().roll_rad, -right.body().roll_rad);
        let (a, b) = (left.strut_output(), right.strut_output());
        for axle in Axle::ALL {
            for (side, other) in [(Side::Left, Side::Right), (Side::Right, Side::Left)] {
                let (a, b) = (a[axle.corner(side)], b[axle.corner(other)]);
                assert_eq!(a.force_n.to_bits(), b.force_n.to_bits());
                assert_eq!(a.pressure_pa, b.pressure_pa);
            }
        }
    }
}

/// Belgian block at 60 km/h, 5 s: the weighted RMS at 1 ms against a quarter of the step.
#[test]
fn a_millisecond_is_short_enough() {
    let road = from_name_or_path("belgian", 120.0, 1).unwrap();
    let parameters = VehicleParameters::defender110();
    let (x, y) = parameters.seat_position_m(&parameters.driver_seat);
    let weighted = |step_s: f64, signals: StrutValves<bool>| {
        let mut model = vehicle(step_s, signals, Arc::clone(&road), 60.0);
        let mut meter = RideMeter::new(1e-3);
        let each = (1e-3 / step_s).round() as u32;
        for step in 1..=5000 * each {
            model.step(Corners::from_array([signals; 4]));
            if step % each == 0 {
                meter.add(model.vertical_acceleration_at(x, y));
            }
        }
        meter.measures().weighted_rms_m_s2
    };
    for signals in [SOFT, STIFF] {
        let (coarse, fine) = (weighted(1e-3, signals), weighted(2.5e-4, signals));
        println!("weighted RMS, 1 ms {coarse:.4}, 0.25 ms {fine:.4} m/s2");
        assert!(fine > 0.5, "the road is rough");
        assert!((coarse / fine - 1.0).abs() < 0.01, "{coarse} {fine}");
    }
}

/// The same run twice, and in a thread of its own: the same bits.
#[test]
fn a_run_is_its_bits() {
    let run = || {
        let mut model = vehicle(1e-3, SOFT, from_name_or_path("belgian", 60.0, 9).unwrap(), 60.0);
        for _ in 0..1000 {
            model.step(Corners::from_array([SOFT; 4]));
        }
        model.state().0.to_array().map(f64::to_bits)
    };
    let other = std::thread::spawn(run).join().unwrap();
    assert_eq!(run(), other);
}
