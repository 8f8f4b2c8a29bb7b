//! What the vehicle's step costs in accuracy: drives with steps of 0.5 to 5 ms against the same drives with 0.05 ms.
//!
//! `cargo run --release -p oleo-plant-sim --example step_error`
//!
//! Commands are given in advance, at ticks of 5 ms, so that every step meets the same ones. A deviation is the RMS over the ticks
//! and, but for the driver's acceleration, the four corners, over the RMS of the quantity itself about its mean.

use std::error::Error;
use std::sync::Arc;

use oleo_interface::{Corners, StrutValves};
use oleo_plant_sim::measures::RideMeter;
use oleo_plant_sim::road::{Road, from_name_or_path};
use oleo_plant_sim::strut::{Strut, StrutModel};
use oleo_plant_sim::vehicle::{RideVehicle, VehicleParameters};

const TICK_S: f64 = 0.005;
const TICKS: usize = 4000;
const REFERENCE_S: f64 = 0.000_05;
const STEPS_S: [f64; 4] = [0.0005, 0.001, 0.0025, 0.005];

/// How the valves are commanded.
#[derive(Clone, Copy)]
enum Commands {
    Soft,
    Stiff,
    /// A valve of a corner changes now and then, some fifteen times a second in all.
    Switched,
}

/// What a drive gave at its ticks.
struct Course {
    displacement_m: Vec<f64>,
    rod_pressure_pa: Vec<f64>,
    seat_m_s2: Vec<f64>,
    weighted_rms_m_s2: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "road, valves, step: deviation of displacement, of p1, of the driver's acceleration; weighted RMS over that of the reference"
    );
    for road in ["iso-c", "iso-e", "belgian"] {
        for (name, commands) in [
            ("soft", Commands::Soft),
            ("stiff", Commands::Stiff),
            ("switched", Commands::Switched),
        ] {
            let surface = from_name_or_path(road, 400.0, 1)?;
            let truth = drive(Arc::clone(&surface), commands, REFERENCE_S)?;
            for step_s in STEPS_S {
                let found = drive(Arc::clone(&surface), commands, step_s)?;
                println!(
                    "{road:8} {name:9} {:4.1} ms: {:.1e} {:.1e} {:.1e}; {:.5}",
                    step_s * 1e3,
                    deviation(&truth.displacement_m, &found.displacement_m),
                    deviation(&truth.rod_pressure_pa, &found.rod_pressure_pa),
                    deviation(&truth.seat_m_s2, &found.seat_m_s2),
                    found.weighted_rms_m_s2 / truth.weighted_rms_m_s2
                );
            }
        }
    }
    Ok(())
}

fn drive(road: Arc<dyn Road>, commands: Commands, step_s: f64) -> Result<Course, Box<dyn Error>> {
    let mut parameters = VehicleParameters::defender110();
    parameters.solver.step_s = step_s;
    let start = StrutValves::splat(!matches!(commands, Commands::Stiff));
    let [a, b, c, d] = parameters.static_strut_load_n().into_array();
    let strut = |load_n| Strut::at_rest(&StrutModel::defender110(load_n), start);
    let struts = Corners::from_array([strut(a)?, strut(b)?, strut(c)?, strut(d)?]);
    let mut vehicle = RideVehicle::new(&parameters, struts, road, 60.0 / 3.6)?;
    let (x_m, y_m) = parameters.seat_position_m(&parameters.driver_seat);
    let mut meter = RideMeter::new(TICK_S);
    let mut course = Course {
        displacement_m: Vec::new(),
        rod_pressure_pa: Vec::new(),
        seat_m_s2: Vec::new(),
        weighted_rms_m_s2: 0.0,
    };
    let mut signals = Corners::splat(start);
    let mut noise = 1_u32;
    let steps = (TICK_S / step_s).round() as usize;
    for _ in 0..TICKS {
        if matches!(commands, Commands::Switched) {
            for signal in signals.values_mut() {
                for valve in oleo_interface::Valve::ALL {
                    noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    if noise >> 16 < 400 {
                        signal[valve] = !signal[valve];
                    }
                }
            }
        }
        for _ in 0..steps {
            vehicle.step(signals);
        }
        course
            .displacement_m
            .extend(vehicle.strut_displacement_m().into_array());
        course
            .rod_pressure_pa
            .extend(vehicle.strut_output().map(|strut| strut.pressure_pa[0]).into_array());
        let felt = vehicle.vertical_acceleration_at(x_m, y_m);
        course.seat_m_s2.push(felt);
        meter.add(felt);
    }
    course.weighted_rms_m_s2 = meter.measures().weighted_rms_m_s2;
    Ok(course)
}

fn deviation(truth: &[f64], found: &[f64]) -> f64 {
    let mean = truth.iter().sum::<f64>() / truth.len() as f64;
    let size: f64 = truth.iter().map(|value| (value - mean) * (value - mean)).sum();
    let missed: f64 = truth
        .iter()
        .zip(found)
        .map(|(truth, found)| (truth - found) * (truth - found))
        .sum();
    (missed / size).sqrt()
}
