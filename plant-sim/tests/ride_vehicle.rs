//! The ride model against what is known of it without it: energy, eigenfrequencies, symmetry, equilibrium, a library's
//! ODE solver, and the order of its step.

use std::sync::Arc;

use oleo_interface::{Axle, Corner, Corners, Side};
use oleo_plant_sim::road::{Flat, Road};
use oleo_plant_sim::vehicle::equations::{Coordinates, Equations};
use oleo_plant_sim::vehicle::linear::Linearisation;
use oleo_plant_sim::vehicle::suspension::LinearElement;
use oleo_plant_sim::vehicle::{BaselineVehicle, RideError, RideModel, VehicleParameters};

const STIFFNESS_N_M: Corners<f64> = Corners::from_array([33e3, 33e3, 55e3, 55e3]);

/// Defender on linear springs and dampers.
fn linear(
    parameters: &VehicleParameters,
    damping_n_s_m: f64,
    road: Arc<dyn Road>,
    speed_m_s: f64,
) -> RideModel<LinearElement> {
    let load = parameters.static_strut_load_n();
    let elements = Corners::from_fn(|corner| LinearElement::new(load[corner], STIFFNESS_N_M[corner], damping_n_s_m));
    RideModel::with_elements(parameters, elements, road, speed_m_s).unwrap()
}

fn with_step(step_s: f64) -> VehicleParameters {
    let mut parameters = VehicleParameters::defender110();
    parameters.solver.step_s = step_s;
    parameters
}

/// Smooth in all derivatives, different left and right, and level before the start.
struct Waves;
impl Road for Waves {
    fn height_m(&self, station_m: f64, lateral_m: f64) -> f64 {
        if station_m <= 0.0 {
            return 0.0;
        }
        let entry = station_m * station_m * station_m / (1.0 + station_m * station_m * station_m);
        entry * (0.012 * libm::sin(1.3 * station_m) + 0.006 * lateral_m * libm::sin(0.9 * station_m))
    }
}

/// Energy in springs and tyres relative to the static state, J: the part that the equations do not hold.
fn spring_energy_j(model: &RideModel<LinearElement>, parameters: &VehicleParameters) -> f64 {
    let load = parameters.static_strut_load_n();
    let wheel_load = parameters.static_wheel_load_n();
    let mut energy = 0.0;
    for (i, x) in model.strut_displacement_m().iter() {
        energy += load[i] * x + 0.5 * STIFFNESS_N_M[i] * x * x;
    }
    for (i, wheel) in model.wheels().iter() {
        let deflection = wheel.road_height_m - wheel.height_m;
        let rate = parameters.axle_of(i).tyre_stiffness_n_m;
        // A tyre off the ground stores nothing.
        let elastic = (wheel_load[i] + rate * deflection).max(0.0);
        energy += 0.5 * (elastic * elastic - wheel_load[i] * wheel_load[i]) / rate;
    }
    energy
}

fn energy_j(model: &RideModel<LinearElement>, parameters: &VehicleParameters) -> f64 {
    let (q, rate) = model.state();
    let equations = model.equations();
    equations.kinetic_energy_j(&q, &rate) + equations.potential_energy_j(&q) + spring_energy_j(model, parameters)
}

/// A state with every mode in it and roll large enough for the quadratic terms to count.
fn shaken() -> (Coordinates, Coordinates) {
    (
        Coordinates::from_array([0.01, 0.002, -0.002, 0.01, 0.03, 0.004, -0.003]),
        Coordinates::from_array([0.05, 0.1, -0.1, 0.2, -0.1, 0.1, 0.1]),
    )
}

/// Largest departure from the initial energy in 2 s without damping, J.
fn undamped_drift_j(step_s: f64) -> f64 {
    let mut parameters = with_step(step_s);
    parameters.front_axle.tyre_damping_n_s_m = 0.0;
    parameters.rear_axle.tyre_damping_n_s_m = 0.0;
    let mut model = linear(&parameters, 0.0, Arc::new(Flat), 0.0);
    let (q, rate) = shaken();
    model.set_state(q, rate);
    // The first step brings the springs to the state that was set.
    model.step(Corners::default());
    let start = energy_j(&model, &parameters);
    let mut worst: f64 = 0.0;
    for _ in 0..(2.0 / step_s).round() as u32 {
        model.step(Corners::default());
        worst = worst.max((energy_j(&model, &parameters) - start).abs());
    }
    worst
}

#[test]
fn undamped_energy_is_conserved_to_second_order() {
    let (coarse, fine) = (undamped_drift_j(1e-3), undamped_drift_j(5e-4));
    assert!(coarse < 0.2, "of some 50 J: {coarse}");
    assert!((3.3..4.7).contains(&(coarse / fine)), "{coarse} / {fine}");
}

/// Work of the road less dissipation less the gain in stored energy, J, after 3 s over the waves.
fn damped_balance_j(step_s: f64) -> (f64, f64) {
    let parameters = with_step(step_s);
    let damping = 2500.0;
    let mut model = linear(&parameters, damping, Arc::new(Waves), 8.0);
    let start = energy_j(&model, &parameters);
    let (mut work, mut lost) = (0.0, 0.0);
    let power = |model: &RideModel<LinearElement>| {
        let (_, rate) = model.state();
        let mut work = 0.0;
        let mut lost = 0.0;
        for (i, wheel) in model.wheels().iter() {
            work += wheel.force_n * wheel.road_height_rate_m_s;
            let squash = wheel.road_height_rate_m_s - wheel.height_rate_m_s;
            lost += parameters.axle_of(i).tyre_damping_n_s_m * squash * squash;
        }
        for extension_rate in model.equations().extension(&rate).into_array() {
            lost += damping * extension_rate * extension_rate;
        }
        (work, lost)
    };
    let mut before = power(&model);
    for _ in 0..(3.0 / step_s).round() as u32 {
        model.step(Corners::default());
        let now = power(&model);
        work += 0.5 * step_s * (before.0 + now.0);
        lost += 0.5 * step_s * (before.1 + now.1);
        before = now;
    }
    (work - lost - (energy_j(&model, &parameters) - start), lost)
}

#[test]
fn work_in_is_dissipation_plus_stored_energy() {
    let (coarse, lost) = damped_balance_j(1e-3);
    let (fine, _) = damped_balance_j(5e-4);
    assert!(lost > 100.0, "the road does work: {lost}");
    assert!(coarse.abs() < 2e-3 * lost, "{coarse} of {lost}");
    assert!((3.0..5.0).contains(&(coarse / fine)), "{coarse} / {fine}");
}

/// M and K assembled spring by spring against the forces' own derivatives.
#[test]
fn linearisation_is_the_derivative_of_the_equations() {
    let parameters = VehicleParameters::defender110();
    let matrices = Linearisation::new(&parameters, STIFFNESS_N_M);
    let equations = Equations::new(&parameters);
    let load = parameters.static_strut_load_n();
    let wheel_load = parameters.static_wheel_load_n();
    let acceleration = |q: &Coordinates| {
        let extension = equations.extension(q);
        let wheel = equations.wheel_height(q);
        let tension = Corners::from_fn(|i| -load[i] + STIFFNESS_N_M[i] * extension[i]);
        let road = Corners::from_fn(|i| wheel_load[i] - parameters.axle_of(i).tyre_stiffness_n_m * wheel[i]);
        equations
            .acceleration(q, &Coordinates::default(), tension, road)
            .to_array()
    };
    for j in 0..7 {
        let mut moved = [0.0; 7];
        moved[j] = 1e-4;
        let plus = acceleration(&Coordinates::from_array(moved));
        let minus = acceleration(&Coordinates::from_array(moved.map(|x| -x)));
        for i in 0..7 {
            let force = matrices.mass[i] * (plus[i] - minus[i]) / 2e-4;
            let expected = -matrices.stiffness[(i, j)];
            assert!(
                (force - expected).abs() < 1e-3 * (1.0 + expected.abs()),
                "row {i} column {j}: {force} {expected}"
            );
        }
    }
}

/// Each mode swings at its frequency: zero crossings of the time simulation against the eigenvalues.
#[test]
fn time_simulation_swings_at_the_eigenfrequencies() {
    let mut parameters = with_step(2.5e-4);
    parameters.front_axle.tyre_damping_n_s_m = 0.0;
    parameters.rear_axle.tyre_damping_n_s_m = 0.0;
    for mode in Linearisation::new(&parameters, STIFFNESS_N_M).modes() {
        let mut model = linear(&parameters, 0.0, Arc::new(Flat), 0.0);
        model.set_state(Coordinates::default(), Coordinates::default().plus(0.01, mode.shape));
        let moving = mode.shape.to_array().iter().position(|x| *x == 1.0).unwrap();
        let mut crossings = Vec::new();
        let mut last = 0.0;
        while crossings.len() < 21 {
            model.step(Corners::default());
            let now = model.state().0.to_array()[moving];
            if last < 0.0 && now >= 0.0 {
                crossings.push(model.time_s() - model.step_s() * now / (now - last));
            }
            last = now;
        }
        let frequency = 20.0 / (crossings[20] - crossings[0]);
        assert!(
            (frequency / mode.frequency_hz - 1.0).abs() < 1e-3,
            "{}: {frequency} {}",
            mode.name(),
            mode.frequency_hz
        );
    }
}

/// In heave-symmetric cases the modes have closed forms: two-mass quarter cars when nothing couples.
#[test]
fn symmetric_vehicle_has_the_quarter_car_s_frequencies() {
    let mut parameters = VehicleParameters::defender110();
    parameters.rear_axle = parameters.front_axle;
    parameters.body.sprung_mass_kg = 1600.0;
    let k = 40e3;
    let modes = Linearisation::new(&parameters, Corners::from_array([k; 4])).modes();
    let (ms, mu, kt) = (
        400.0,
        parameters.front_axle.mass_kg / 2.0,
        parameters.front_axle.tyre_stiffness_n_m,
    );
    let (b, c) = ((k / ms + (k + kt) / mu), k * kt / (ms * mu));
    for sign in [-1.0, 1.0] {
        let omega = (0.5 * (b + sign * (b * b - 4.0 * c).sqrt())).sqrt();
        let hertz = omega / (2.0 * core::f64::consts::PI);
        assert!(
            modes.iter().any(|mode| (mode.frequency_hz / hertz - 1.0).abs() < 1e-9),
            "{hertz}"
        );
    }
}

struct Mirrored<R>(R);
impl<R: Road> Road for Mirrored<R> {
    fn height_m(&self, station_m: f64, lateral_m: f64) -> f64 {
        self.0.height_m(station_m, -lateral_m)
    }
}

#[test]
fn a_mirrored_road_gives_mirrored_bits() {
    let parameters = VehicleParameters::defender110();
    let mut one = BaselineVehicle::baseline(&parameters, Arc::new(Waves), 10.0).unwrap();
    let mut other = BaselineVehicle::baseline(&parameters, Arc::new(Mirrored(Waves)), 10.0).unwrap();
    for _ in 0..3000 {
        one.step(Corners::default());
        other.step(Corners::default());
        let (a, b) = (one.body(), other.body());
        assert_eq!(a.heave_m.to_bits(), b.heave_m.to_bits());
        assert_eq!(a.pitch_rate_rad_s.to_bits(), b.pitch_rate_rad_s.to_bits());
        assert_eq!(a.roll_rad, -b.roll_rad);
        assert_eq!(a.roll_acceleration_rad_s2, -b.roll_acceleration_rad_s2);
        let (a, b) = (one.strut_displacement_m(), other.strut_displacement_m());
        for axle in Axle::ALL {
            let [left, right] = Side::ALL.map(|side| axle.corner(side));
            assert_eq!((a[left], a[right]), (b[right], b[left]));
        }
    }
    assert!(one.body().roll_rad.abs() > 1e-4, "the road rolls it");
}

#[test]
fn static_equilibrium_stays_still_wherever_the_road_s_zero_is() {
    struct Plateau;
    impl Road for Plateau {
        fn height_m(&self, _station_m: f64, _lateral_m: f64) -> f64 {
            221.0
        }
    }
    let parameters = VehicleParameters::defender110();
    let mut model = BaselineVehicle::baseline(&parameters, Arc::new(Plateau), 20.0).unwrap();
    for _ in 0..10_000 {
        model.step(Corners::default());
    }
    assert!(model.state().0.to_array().iter().all(|x| x.abs() < 1e-9));
    assert!(model.vertical_acceleration_at(1.0, 0.5).abs() < 1e-9);
}

#[test]
fn wheels_leave_the_ground_and_fall_freely() {
    /// The road drops away.
    struct Cliff;
    impl Road for Cliff {
        fn height_m(&self, station_m: f64, _lateral_m: f64) -> f64 {
            if station_m > 0.5 { -3.0 } else { 0.0 }
        }
    }
    let parameters = VehicleParameters::defender110();
    let mut model = BaselineVehicle::baseline(&parameters, Arc::new(Cliff), 20.0).unwrap();
    let mut airborne = 0;
    let mut centre_acceleration: f64 = 0.0;
    for _ in 0..600 {
        model.step(Corners::default());
        let wheels = model.wheels();
        assert!(wheels.values().all(|wheel| wheel.force_n >= 0.0));
        if wheels.values().all(|wheel| wheel.force_n == 0.0) {
            airborne += 1;
            let (mass, a) = (parameters.total_mass_kg(), model.body().heave_acceleration_m_s2);
            // Internal forces cancel: in the air the whole vehicle's centre of mass falls with g.
            let struts: f64 = model.suspension_force_n().values().sum();
            let axles = -struts - (mass - parameters.body.sprung_mass_kg) * 9.80665;
            centre_acceleration = (parameters.body.sprung_mass_kg * a + axles) / mass;
            assert!((centre_acceleration + 9.80665).abs() < 1e-9);
        }
    }
    assert!(airborne > 100, "{airborne} {centre_acceleration}");
}

#[test]
fn suspension_for_another_vehicle_and_bad_speeds_are_refused() {
    let parameters = VehicleParameters::defender110();
    let elements = Corners::from_array([8000.0, 4000.0, 4000.0, 4000.0]).map(|load| LinearElement::new(load, 4e4, 0.0));
    let error = RideModel::with_elements(&parameters, elements, Arc::new(Flat), 1.0)
        .err()
        .unwrap();
    assert!(
        matches!(
            error,
            RideError::StaticLoad {
                corner: Corner::FrontLeft,
                ..
            }
        ),
        "{error}"
    );
    for speed in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            BaselineVehicle::baseline(&parameters, Arc::new(Flat), speed),
            Err(RideError::Speed(_))
        ));
    }
}

/// The same linear vehicle written as a first-order system and solved by a library (Dormand and Prince's method of eighth order).
mod library {
    use super::*;
    use differential_equations::prelude::{ExplicitRungeKutta, IVP, ODE};

    /// State at `end_s` of the linear vehicle over [`Waves`].
    pub fn state_at(end_s: f64, speed_m_s: f64, damping_n_s_m: f64) -> [f64; 14] {
        let parameters = VehicleParameters::defender110();
        let equations = Equations::new(&parameters);
        let load = parameters.static_strut_load_n();
        let wheel_load = parameters.static_wheel_load_n();
        let half_track = 0.5 * parameters.front_axle.track_m;
        let (kt, ct) = (
            parameters.front_axle.tyre_stiffness_n_m,
            parameters.front_axle.tyre_damping_n_s_m,
        );
        let wheelbase = parameters.layout.wheelbase_m;
        let rates = move |x: &[f64], t: f64| -> [f64; 14] {
            let q = Coordinates::from_array(core::array::from_fn(|i| x[i]));
            let v = Coordinates::from_array(core::array::from_fn(|i| x[7 + i]));
            let (stretch, stretch_rate) = (equations.extension(&q), equations.extension(&v));
            let (height, height_rate) = (equations.wheel_height(&q), equations.wheel_height(&v));
            let mut tension = Corners::default();
            let mut road = Corners::default();
            for i in Corner::ALL {
                tension[i] = -load[i] + STIFFNESS_N_M[i] * stretch[i] + damping_n_s_m * stretch_rate[i];
                let station = match i.axle() {
                    Axle::Front => speed_m_s * t,
                    Axle::Rear => speed_m_s * t - wheelbase,
                };
                let side = match i.side() {
                    Side::Left => half_track,
                    Side::Right => -half_track,
                };
                let rise = (Waves.height_m(station + 1e-5, side) - Waves.height_m(station - 1e-5, side)) / 2e-5;
                road[i] = wheel_load[i]
                    + kt * (Waves.height_m(station, side) - height[i])
                    + ct * (speed_m_s * rise - height_rate[i]);
            }
            let a = equations.acceleration(&q, &v, tension, road).to_array();
            core::array::from_fn(|i| if i < 7 { x[7 + i] } else { a[i - 7] })
        };
        let solution = IVP::ode(&Rates(rates), 0.0, end_s, [0.0; 14])
            .t_eval([end_s])
            .method(ExplicitRungeKutta::dop853().rtol(1e-9).atol(1e-11))
            .solve()
            .expect("a solution");
        *solution.last().expect("a state at the end").1
    }

    /// A right-hand side.
    struct Rates<F>(F);

    impl<F: Fn(&[f64], f64) -> [f64; 14]> ODE<f64, [f64; 14]> for Rates<F> {
        fn diff(&self, t: f64, y: &[f64; 14], slope: &mut [f64; 14]) {
            *slope = (self.0)(y, t);
        }
    }
}

/// Step halving against the library's solution: the error falls as the square of the step.
#[test]
fn fixed_step_converges_to_the_library_s_solution() {
    let (end_s, speed, damping) = (2.0, 8.0, 2000.0);
    let truth = library::state_at(end_s, speed, damping);
    let error = |step_s: f64| -> f64 {
        let parameters = with_step(step_s);
        let mut model = linear(&parameters, damping, Arc::new(Waves), speed);
        for _ in 0..(end_s / step_s).round() as u32 {
            model.step(Corners::default());
        }
        let (q, rate) = model.state();
        let (q, rate) = (q.to_array(), rate.to_array());
        (0..7)
            .map(|i| (q[i] - truth[i]).abs().max(0.05 * (rate[i] - truth[7 + i]).abs()))
            .fold(0.0, f64::max)
    };
    let errors = [2.5e-3, 1.25e-3, 6.25e-4].map(error);
    assert!(errors[1] < 5e-5, "m and rad, of some 10 mm: {errors:?}");
    for pair in errors.windows(2) {
        assert!((3.3..4.7).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
}

/// Over a rough road the reading is the one of angles that are small: heave, pitch and roll accelerations with their arms along z, gravity
/// on the tilted axes along x and y, and the rates.
#[test]
fn an_inertial_unit_reads_the_small_motion_of_the_body() {
    let parameters = VehicleParameters::defender110();
    let road = oleo_plant_sim::road::from_name_or_path("belgian", 60.0, 1).expect("built in");
    let mut model = BaselineVehicle::baseline(&parameters, road, 12.0).expect("it stands");
    let at_rest = model.inertial_at([0.4, 0.3, -0.2]);
    assert!((at_rest.specific_force_m_s2[2] - 9.806_65).abs() < 0.1, "{at_rest:?}");
    let [x, y, z] = [0.8, -0.5, 0.4];
    let (mut largest, mut most) = (0.0f64, [0.0f64; 2]);
    for _ in 0..3000 {
        model.step(Default::default());
        let (body, reading) = (model.body(), model.inertial_at([x, y, z]));
        let [along, across, up] = reading.specific_force_m_s2;
        let upward = 9.806_65 + body.heave_acceleration_m_s2;
        let expected = [
            z * body.pitch_acceleration_rad_s2 - upward * body.pitch_rad,
            -z * body.roll_acceleration_rad_s2 + upward * body.roll_rad,
            9.806_65 + model.vertical_acceleration_at(x, y),
        ];
        for (found, expected) in [along, across, up].into_iter().zip(expected) {
            largest = largest.max((found - expected).abs());
        }
        let [roll_rate, pitch_rate, _] = reading.rate_rad_s;
        assert!((roll_rate - body.roll_rate_rad_s).abs() < 1e-12);
        assert!((pitch_rate - body.pitch_rate_rad_s).abs() < 1e-3);
        most = [most[0].max(along.abs()), most[1].max(across.abs())];
    }
    // Terms of second order remain.
    assert!(largest < 0.15 && most[0] > 0.5 && most[1] > 0.5, "{largest} {most:?}");
}
