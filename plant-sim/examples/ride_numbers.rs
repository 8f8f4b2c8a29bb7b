//! The ride model's numbers: eigenfrequencies, comfort over the built-in roads, the APG obstacle, the time of a step.
//!
//! `cargo run --release -p oleo-plant-sim --example ride_numbers`

use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

use oleo_interface::{Corner, Corners, StrutValves};
use oleo_plant_sim::measures::RideMeter;
use oleo_plant_sim::road::{Road, belgian, from_name_or_path, spectrum::SpectrumEstimator};
use oleo_plant_sim::strut::{Strut, StrutModel};
use oleo_plant_sim::vehicle::linear::Linearisation;
use oleo_plant_sim::vehicle::suspension::LinearElement;
use oleo_plant_sim::vehicle::{BaselineVehicle, RideModel, RideVehicle, VehicleParameters};

const SOFT: StrutValves<bool> = StrutValves::new(true, true, true);
const STIFF: StrutValves<bool> = StrutValves::new(false, false, false);

fn main() -> Result<(), Box<dyn Error>> {
    let parameters = VehicleParameters::defender110();
    eigenfrequencies(&parameters);
    comfort(&parameters)?;
    obstacle(&parameters)?;
    built_in_spectrum()?;
    step_time(&parameters)?;
    Ok(())
}

fn struts(parameters: &VehicleParameters, signals: StrutValves<bool>) -> Result<Corners<Strut>, Box<dyn Error>> {
    let [a, b, c, d] = parameters.static_strut_load_n().into_array();
    let strut = |load_n| Strut::at_rest(&StrutModel::defender110(load_n), signals);
    Ok(Corners::from_array([strut(a)?, strut(b)?, strut(c)?, strut(d)?]))
}

fn eigenfrequencies(parameters: &VehicleParameters) {
    let coil = Corners::from_array([33e3, 33e3, 55e3, 55e3]);
    let load = parameters.static_strut_load_n();
    // Isothermal rate of a gas spring at its static state: k = p A^2 / V = (F / A + p_atm) A^2 / V.
    let area = core::f64::consts::PI / 4.0 * 0.05 * 0.05;
    let gas = |volume_m3: f64| load.map(|f| (f / area + 101_325.0) * area * area / volume_m3);
    for (name, rates) in [
        ("coil", coil),
        ("soft 0.5 l", gas(0.5e-3)),
        ("stiff 0.1 l", gas(0.1e-3)),
    ] {
        println!(
            "eigenfrequencies, {name} ({:.1} / {:.1} kN/m):",
            rates[Corner::FrontLeft] / 1e3,
            rates[Corner::RearLeft] / 1e3
        );
        for mode in Linearisation::new(parameters, rates).modes() {
            println!("  {:7.3} Hz  {}", mode.frequency_hz, mode.name());
        }
    }
}

fn comfort(parameters: &VehicleParameters) -> Result<(), Box<dyn Error>> {
    let speed = 60.0 / 3.6;
    println!("weighted RMS Wb (m/s2) driver, passenger; MSDV driver; 20 s at 60 km/h");
    for name in ["belgian", "iso-c", "iso-d", "iso-e"] {
        let road = from_name_or_path(name, 400.0, 1)?;
        for (setting, signals) in [("soft", SOFT), ("stiff", STIFF)] {
            let mut vehicle = RideVehicle::new(parameters, struts(parameters, signals)?, Arc::clone(&road), speed)?;
            let numbers = drive(parameters, &mut vehicle, signals);
            println!("  {name:8} {setting:6} {numbers}");
        }
        let mut vehicle = BaselineVehicle::baseline(parameters, Arc::clone(&road), speed)?;
        println!("  {name:8} coil   {}", drive(parameters, &mut vehicle, ()));
    }
    Ok(())
}

fn drive<E: oleo_plant_sim::vehicle::suspension::SuspensionElement>(
    parameters: &VehicleParameters,
    vehicle: &mut RideModel<E>,
    signal: E::Signal,
) -> String {
    let driver = parameters.seat_position_m(&parameters.driver_seat);
    let passenger = parameters.seat_position_m(&parameters.passenger_seat);
    let mut meters = [RideMeter::new(vehicle.step_s()), RideMeter::new(vehicle.step_s())];
    let (mut low, mut high, mut airborne): (f64, f64, u32) = (0.0, 0.0, 0);
    for _ in 0..20_000 {
        vehicle.step(Corners::from_array([signal; 4]));
        for (meter, (x, y)) in meters.iter_mut().zip([driver, passenger]) {
            meter.add(vehicle.vertical_acceleration_at(x, y));
        }
        for x in vehicle.strut_displacement_m().into_array() {
            low = low.min(x);
            high = high.max(x);
        }
        airborne += u32::from(vehicle.wheels().values().any(|wheel| wheel.force_n == 0.0));
    }
    let [driver, passenger] = meters.map(|meter| meter.measures());
    format!(
        "{:5.2} {:5.2}  MSDV {:5.2}  strut {:+.3} to {:+.3} m  a wheel off the ground {:.1} %",
        driver.weighted_rms_m_s2,
        passenger.weighted_rms_m_s2,
        driver.msdv_m_s1_5,
        low,
        high,
        f64::from(airborne) / 200.0
    )
}

fn obstacle(parameters: &VehicleParameters) -> Result<(), Box<dyn Error>> {
    println!("APG obstacle, left wheels: least and largest strut displacement (m), roll (deg)");
    for speed_km_h in [5.0, 10.0] {
        let road = from_name_or_path("apg-left", 20.0, 0)?;
        let speed = speed_km_h / 3.6;
        for (setting, signals) in [("soft", SOFT), ("stiff", STIFF)] {
            let mut vehicle = RideVehicle::new(parameters, struts(parameters, signals)?, Arc::clone(&road), speed)?;
            let (mut low, mut high, mut roll): (f64, f64, f64) = (0.0, 0.0, 0.0);
            while vehicle.station_m() < 20.0 {
                vehicle.step(Corners::from_array([signals; 4]));
                for x in vehicle.strut_displacement_m().into_array() {
                    low = low.min(x);
                    high = high.max(x);
                }
                roll = roll.max(vehicle.body().roll_rad.abs());
            }
            let degrees = roll * 180.0 / core::f64::consts::PI;
            println!("  {speed_km_h:4} km/h {setting:6} {low:+.4} {high:+.4}  {degrees:.2}");
        }
    }
    Ok(())
}

/// The built-in track against its table (and so against the measured surface).
fn built_in_spectrum() -> Result<(), Box<dyn Error>> {
    let road = from_name_or_path("belgian", 600.0, 1)?;
    let side = |y: f64| {
        (0..60_000)
            .map(|i| road.height_m(10.0 + 0.01 * f64::from(i), y))
            .collect::<Vec<_>>()
    };
    let mut estimator = SpectrumEstimator::new(8192, 0.01);
    estimator.add(&side(0.743), &side(-0.743));
    println!("Belgian block, Gd (m3): band, measured surface, built-in track");
    for band in belgian::bands() {
        if let Some(made) = estimator.band(band.low_per_m, band.high_per_m) {
            println!(
                "  {:6.3} to {:6.3} cycles/m  {:.3e} {:.3e}  coherence {:+.2}{:+.2}i {:+.2}{:+.2}i",
                band.low_per_m,
                band.high_per_m,
                band.psd_m3,
                made.psd_m3,
                band.coherence.re,
                band.coherence.im,
                made.coherence.re,
                made.coherence.im
            );
        }
    }
    Ok(())
}

fn step_time(parameters: &VehicleParameters) -> Result<(), Box<dyn Error>> {
    let road: Arc<dyn Road> = from_name_or_path("belgian", 2000.0, 1)?;
    let load = parameters.static_strut_load_n();
    let elements = load.map(|load_n| LinearElement::new(load_n, 4e4, 2500.0));
    let mut bare = RideModel::with_elements(parameters, elements, Arc::clone(&road), 16.7)?;
    let mut full = RideVehicle::new(parameters, struts(parameters, SOFT)?, road, 16.7)?;
    let steps = 100_000;
    let started = Instant::now();
    (0..steps).for_each(|_| bare.step(Corners::default()));
    let bare_ns = started.elapsed().as_nanos() as f64 / f64::from(steps);
    let started = Instant::now();
    (0..steps).for_each(|_| full.step(Corners::from_array([SOFT; 4])));
    let full_ns = started.elapsed().as_nanos() as f64 / f64::from(steps);
    println!("one step: {bare_ns:.0} ns without struts, {full_ns:.0} ns with four struts");
    Ok(())
}
