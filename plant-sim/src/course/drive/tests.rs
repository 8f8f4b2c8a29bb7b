use oleo_interface::{Side, StrutValves};

use super::*;
use crate::course::{LaneChange, Run};
use crate::road::{Bend, Flat, Road, SideSlope, belgian::belgian_block};
use crate::strut::{Strut, StrutModel};
use crate::vehicle::StrutElement;
use crate::vehicle::suspension::CoilElement;
use crate::vehicle::{GRAVITY_M_S2, Load};

const SPEED_M_S: f64 = 60.0 / 3.6;

fn course(manoeuvre: Manoeuvre, road: Arc<dyn Road>) -> Course {
    Course {
        manoeuvre,
        driver: DriverStyle::Eased,
        road,
    }
}

fn severe() -> Manoeuvre {
    Manoeuvre::LaneChange {
        kind: LaneChange::Severe,
        speed_m_s: SPEED_M_S,
        entry_m: 40.0,
        duration_s: None,
    }
}

fn on_struts(course: &Course) -> Drive<StrutElement> {
    let p = VehicleParameters::defender110();
    let elements = p.static_strut_load_n().map(|load_n| {
        StrutElement::new(Strut::at_rest(&StrutModel::defender110(load_n), StrutValves::splat(true)).unwrap())
    });
    Drive::begin(course, &p, &HandlingParameters::defender110(), elements).unwrap()
}

fn on_coils(course: &Course) -> Run {
    let p = VehicleParameters::defender110();
    Drive::begin(
        course,
        &p,
        &HandlingParameters::defender110(),
        CoilElement::of_vehicle(&p),
    )
    .unwrap()
    .to_end(|_| Default::default(), |_| {})
    .unwrap()
}

/// A road with left and right unlike each other.
struct Rough {
    side: f64,
}
impl Road for Rough {
    fn height_m(&self, station_m: f64, lateral_m: f64) -> f64 {
        let y = self.side * lateral_m;
        0.02 * libm::sin(station_m * 1.3 + 2.0 * y) + 0.015 * libm::sin(station_m * 4.1 - 3.0 * y)
    }
}

#[test]
fn a_mirrored_drive_gives_mirrored_bits() {
    let bend = |side: f64| Manoeuvre::ConstantRadius {
        radius_m: 50.0 * side,
        from_m_s: 8.0,
        to_m_s: 14.0,
        duration_s: 4.0,
    };
    let step = |side: f64| Manoeuvre::StepSteer {
        speed_m_s: 17.0,
        angle_rad: 0.05 * side,
        at_s: 0.5,
        duration_s: 3.0,
    };
    let open = Signals::from_fn(|_| StrutValves::from_fn(|_| true));
    for manoeuvre in [&bend as &dyn Fn(f64) -> Manoeuvre, &step] {
        let drive = |side: f64| {
            let mut drive = on_struts(&course(manoeuvre(side), Arc::new(Rough { side })));
            for _ in 0..500 {
                drive.tick(open, |_| {}).unwrap();
            }
            drive.sample(open)
        };
        let (a, b) = (drive(1.0), drive(-1.0));
        assert!(a.lateral_m.abs() > 0.5 && a.roll_rad.abs() > 1e-4);
        assert_eq!(
            (a.station_m, a.lateral_m, a.heave_m),
            (b.station_m, -b.lateral_m, b.heave_m)
        );
        assert_eq!(
            (a.yaw_rad, a.pitch_rad, a.roll_rad),
            (-b.yaw_rad, b.pitch_rad, -b.roll_rad)
        );
        let mirrored = Corners::from_fn(|corner| match corner.side() {
            Side::Left => b.strut_displacement_m[corner.axle().corner(Side::Right)],
            Side::Right => b.strut_displacement_m[corner.axle().corner(Side::Left)],
        });
        assert_eq!(a.strut_displacement_m, mirrored);
    }
}

/// What `hil` does, tick by tick, is what a drive to the end does; the valves of the last tick are in the sample.
#[test]
fn tick_by_tick_is_the_same_drive() {
    let course = course(severe(), Arc::new(belgian_block(300.0, 1).unwrap()));
    let open = Signals::from_fn(|_| StrutValves::from_fn(|_| true));
    let whole = on_struts(&course).to_end(|_| (open, open), |_| {}).unwrap();
    let mut drive = on_struts(&course);
    let mut samples = vec![drive.sample(open)];
    while drive.ending().is_none() {
        drive.tick(open, |_| {}).unwrap();
        samples.push(drive.sample(open));
    }
    assert_eq!(whole.history, samples);
    assert_eq!(whole.ending, Ending::Completed);
    assert!(
        whole.max_lateral_m_s2 > 2.0,
        "a lane change: {}",
        whole.max_lateral_m_s2
    );
    let rough = samples
        .iter()
        .map(|s| s.vertical_acceleration_m_s2.abs())
        .fold(0.0, f64::max);
    assert!(rough > 2.0, "on Belgian block: {rough}");
    let pressure = drive.model().strut_output()[oleo_interface::Corner::FrontLeft].pressure_pa;
    assert!(pressure.iter().all(|p| (1e5..3e7).contains(p)));
}

/// Braking distance at the deceleration asked for, `V^2 / (2 a)`, which tyres and brakes can give; the rolling resistance, some
/// 0.1 m/s2, shortens it.
#[test]
fn braking_takes_the_distance_of_the_closed_form() {
    let run = on_coils(&course(
        Manoeuvre::Braking {
            speed_m_s: 20.0,
            radius_m: None,
            deceleration_m_s2: 4.0,
            at_s: 1.0,
            duration_s: 15.0,
        },
        Arc::new(Flat),
    ));
    assert_eq!(run.ending, Ending::Completed);
    let last = run.history.last().unwrap();
    assert!(last.speed_m_s < 0.5 && last.time_s < 8.0);
    let begin = run.history.iter().find(|s| s.time_s >= 1.0).unwrap();
    let distance = last.station_m - begin.station_m;
    assert!((distance / (20.0 * 20.0 / 8.0) - 1.0).abs() < 0.06, "{distance} m");
    let dive = run.history.iter().map(|s| s.pitch_rad).fold(0.0, f64::max);
    assert!((0.005..0.1).contains(&dive), "nose down by {dive} rad");
}

#[test]
fn braking_in_a_bend_stands_and_stays_on_its_wheels() {
    let radius_m = Some(-60.0);
    let course = course(
        Manoeuvre::Braking {
            speed_m_s: 14.0,
            radius_m,
            deceleration_m_s2: 5.0,
            at_s: 6.0,
            duration_s: 20.0,
        },
        Arc::new(Bend::new(Arc::new(belgian_block(300.0, 1).unwrap()), -60.0)),
    );
    let run = on_coils(&course);
    assert_eq!(run.ending, Ending::Completed);
    let last = run.history.last().unwrap();
    assert!(last.time_s < 12.0 && last.lateral_m < -5.0, "{last:?}");
}

/// From 10 m/s with 2 m/s2 for 4 s: 18 m/s, less the rolling resistance and the slower start of wheels and tyres.
#[test]
fn acceleration_gains_speed_by_force_over_mass() {
    let run = on_coils(&course(
        Manoeuvre::Acceleration {
            speed_m_s: 10.0,
            acceleration_m_s2: 2.0,
            at_s: 1.0,
            duration_s: 5.0,
        },
        Arc::new(Flat),
    ));
    let gained = run.history.last().unwrap().speed_m_s - 10.0;
    assert!((0.88..1.0).contains(&(gained / 8.0)), "{gained} m/s");
    assert!(run.history.last().unwrap().pitch_rad < -0.002, "it squats");
}

/// On a side slope of 10 % the loads shift by `m g sin(slope) h / t` to the lower side, and a driver holds the line.
#[test]
fn a_side_slope_shifts_the_loads_by_statics() {
    let straight = Manoeuvre::Straight {
        speed_m_s: 10.0,
        duration_s: 15.0,
    };
    let run = on_coils(&course(straight, Arc::new(SideSlope::new(Arc::new(Flat), 0.1, 5.0))));
    assert_eq!(run.ending, Ending::Completed);
    let last = run.history.last().unwrap();
    let p = VehicleParameters::defender110();
    let angle = libm::atan(0.1);
    let load = &last.wheel_load_n;
    let (left, right): (f64, f64) = [Side::Left, Side::Right]
        .map(|side| Axle::ALL.map(|axle| load[axle.corner(side)]).iter().sum::<f64>())
        .into();
    let shift = 0.5 * (right - left);
    let statics =
        p.total_mass_kg() * GRAVITY_M_S2 * libm::sin(angle) * p.body.vehicle_cg_height_m / p.front_axle.track_m;
    // The body leans to the lower side, which brings its centre of mass over by some centimetres more.
    assert!(
        (1.0..1.12).contains(&(shift / statics)),
        "{shift} N against {statics} N"
    );
    assert!(last.roll_rad > angle && last.lateral_m.abs() < 1.0, "{last:?}");
}

/// The same lane change asks for more of the hard driver's vehicle, and for more still with a load.
#[test]
fn the_hard_driver_rolls_the_body_further() {
    let drive = |driver, load: Load| {
        let p = load.on_coil_springs(&VehicleParameters::defender110());
        let course = Course {
            driver,
            ..course(severe(), Arc::new(Flat))
        };
        Drive::begin(
            &course,
            &p,
            &HandlingParameters::defender110(),
            CoilElement::of_vehicle(&p),
        )
        .unwrap()
        .to_end(|_| Default::default(), |_| {})
        .unwrap()
    };
    let eased = drive(DriverStyle::Eased, Load::AsSold);
    let hard = drive(DriverStyle::Hard, Load::AsSold);
    let laden = drive(DriverStyle::Hard, Load::LadenRoof);
    assert!(
        hard.max_lateral_m_s2 > 1.3 * eased.max_lateral_m_s2,
        "{} {}",
        hard.max_lateral_m_s2,
        eased.max_lateral_m_s2
    );
    assert!(hard.max_roll_rad > eased.max_roll_rad && laden.max_roll_rad > hard.max_roll_rad);
}
