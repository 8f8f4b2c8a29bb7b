//! What the checks find, and what they call a fault where there is none:
//! `cargo run --release -p oleo-hil --example detection_table [-- FIRST_SEED]`.
//!
//! The controller drives the ride model with full struts, without a bus in between. First it drives without a fault, on every road,
//! with every strategy and several seeds: each change of the mode after the start is a false alarm. Then each fault begins after
//! 10 s, in several sizes; the table says in how many of the drives it was found within 20 s, and after how long. Displacements have
//! noise of 0.05 mm and pressures of 10 kPa (standard deviation), and both have the resolution of the bus.

use oleo_controller::can::{DISPLACEMENT_STEP_M, PRESSURE_STEP_PA};
use oleo_controller::{
    Configuration, Corner, Corners, FaultCode, Gauge, Inputs, Mode, Reading, State, Strategy, StrutPressures, Valve,
    ValveCommand, tick,
};
use oleo_interface::StrutValves;
use oleo_interface::tick::{TICK_S, TICKS_PER_SECOND};
use oleo_plant_sim::road::from_name_or_path;
use oleo_plant_sim::strut::{Strut, StrutModel};
use oleo_plant_sim::vehicle::{RideVehicle, VehicleParameters};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

const FAULT_BEGINS: u32 = 10 * TICKS_PER_SECOND;
const TICKS: u32 = 30 * TICKS_PER_SECOND;
const PLACE: Corner = Corner::FrontLeft;

type Failure = Box<dyn std::error::Error>;

/// A drive without its fault.
#[derive(Clone, Copy)]
struct Drive {
    road: &'static str,
    speed_m_s: f64,
    seed: u64,
    strategy: Strategy,
}

/// What goes wrong. Sizes are SI.
#[derive(Clone, Copy)]
enum Fault {
    Nothing,
    DisplacementOffset(f32),
    DisplacementGain(f32),
    DisplacementFrozen,
    DisplacementLate(usize),
    DisplacementDrift(f32),
    DisplacementsSwapped(Corner),
    PressureOffset(f32),
    StuckOpen(Valve),
    StuckClosed(Valve),
}

/// When and as what a fault was found.
struct Found {
    after_s: f64,
    cause: FaultCode,
}

/// Noise of a sensor whose standard deviation is 1.
fn noise(random: &mut ChaCha8Rng) -> f32 {
    StandardNormal.sample(random)
}

fn run(drive: &Drive, fault: Fault) -> Result<Vec<Found>, Failure> {
    let parameters = VehicleParameters::defender110();
    let struts: Result<Vec<Strut>, _> = (parameters.static_strut_load_n().into_array().into_iter())
        .map(|load_n| Strut::at_rest(&StrutModel::defender110(load_n), StrutValves::default()))
        .collect();
    let Ok(struts) = <[Strut; 4]>::try_from(struts?) else {
        return Err("four loads make four struts".into());
    };
    let road_m = drive.speed_m_s * f64::from(TICKS) * TICK_S + 20.0;
    let road = from_name_or_path(drive.road, road_m, drive.seed)?;
    let mut vehicle = RideVehicle::new(&parameters, Corners::from_array(struts), road, drive.speed_m_s)?;
    let steps = (TICK_S / vehicle.step_s()).round() as u32;
    let configuration = Configuration::defender110().with_strategy(drive.strategy);
    let mut state = State::new();
    let mut random = ChaCha8Rng::seed_from_u64(drive.seed);
    let (mut past, mut held) = (Vec::new(), None);
    let (mut found, mut before) = (Vec::new(), Mode::StartUp);
    for n in 0..TICKS {
        let on = n >= FAULT_BEGINS;
        let truth = vehicle.strut_displacement_m().map(|x| x as f32);
        past.push(truth[PLACE]);
        let mut x = truth;
        let mut pressure =
            (vehicle.strut_output()).map(|strut| StrutPressures::from_array(strut.pressure_pa.map(|p| p as f32)));
        if on {
            match fault {
                Fault::DisplacementOffset(more) => x[PLACE] += more,
                Fault::DisplacementGain(gain) => x[PLACE] *= gain,
                Fault::DisplacementFrozen => x[PLACE] = *held.get_or_insert(truth[PLACE]),
                Fault::DisplacementLate(ticks) => x[PLACE] = past[past.len() - 1 - ticks],
                Fault::DisplacementDrift(a_second) => x[PLACE] += a_second * (n - FAULT_BEGINS) as f32 * TICK_S as f32,
                Fault::DisplacementsSwapped(other) => (x[PLACE], x[other]) = (truth[other], truth[PLACE]),
                Fault::PressureOffset(more) => pressure[PLACE].p2 += more,
                Fault::Nothing | Fault::StuckOpen(_) | Fault::StuckClosed(_) => {}
            }
        }
        let sampled = |value: f32, step: f32| (value / step).round() * step;
        let inputs = Inputs {
            displacement: x.map(|x| Reading::new(sampled(x + 5.0e-5 * noise(&mut random), DISPLACEMENT_STEP_M))),
            ..Inputs::from_values(
                Corners::default(),
                pressure.map(|strut| strut.map(|p| Gauge(sampled(p + 1.0e4 * noise(&mut random), PRESSURE_STEP_PA)))),
            )
        };
        let outputs = tick(&configuration, &mut state, &inputs);
        if outputs.mode > Mode::Normal && outputs.mode != before {
            found.push(Found {
                after_s: (f64::from(n) - f64::from(FAULT_BEGINS)) * TICK_S,
                cause: outputs.fault,
            });
        }
        before = outputs.mode;
        let driven: ValveCommand = match fault {
            Fault::StuckOpen(valve) if on => outputs.command.with(PLACE, valve, true),
            Fault::StuckClosed(valve) if on => outputs.command.with(PLACE, valve, false),
            _ => outputs.command,
        };
        for _ in 0..steps {
            vehicle.step(driven.corners());
        }
    }
    Ok(found)
}

fn drives(roads: &[(&'static str, f64)], seeds: std::ops::Range<u64>, strategies: &[Strategy]) -> Vec<Drive> {
    let mut drives = Vec::new();
    for (road, speed_km_h) in roads {
        for seed in seeds.clone() {
            for strategy in strategies {
                drives.push(Drive {
                    road,
                    speed_m_s: speed_km_h / 3.6,
                    seed,
                    strategy: *strategy,
                });
            }
        }
    }
    drives
}

/// Smallest and largest of some times, if there are any.
fn span(times_s: &[f64]) -> String {
    let least = times_s.iter().copied().fold(f64::INFINITY, f64::min);
    let most = times_s.iter().copied().fold(0.0, f64::max);
    if times_s.is_empty() {
        String::new()
    } else {
        format!(", {least:.2} to {most:.2} s")
    }
}

fn main() -> Result<(), Failure> {
    let first_seed = std::env::args().nth(1).map_or(Ok(1), |text| text.parse::<u64>())?;
    let roads = [
        ("flat", 80.0),
        ("iso-a", 100.0),
        ("iso-b", 100.0),
        ("iso-c", 80.0),
        ("iso-d", 60.0),
        ("belgian", 40.0),
        ("belgian", 60.0),
        ("apg-both", 14.5),
        ("apg-left", 14.5),
        ("belgian", 30.0),
        ("iso-c", 120.0),
        ("iso-e", 40.0),
        ("iso-f", 25.0),
    ];
    let strategies = [Strategy::RoadAndCornering, Strategy::AlwaysSoft, Strategy::AlwaysStiff];
    println!("| drive without a fault | drives | with a false alarm | causes |\n|---|---|---|---|");
    for road in roads {
        for strategy in strategies {
            let drives = drives(&[road], first_seed..first_seed + 8, &[strategy]);
            let mut causes: Vec<&str> = Vec::new();
            let mut alarmed = 0;
            for drive in &drives {
                let found = run(drive, Fault::Nothing)?;
                alarmed += u32::from(!found.is_empty());
                causes.extend(found.iter().map(|found| found.cause.name()));
            }
            causes.sort_unstable();
            causes.dedup();
            println!(
                "| {} at {} km/h, {} | {} | {alarmed} | {} |",
                road.0,
                road.1,
                strategy.name(),
                drives.len(),
                causes.join(", ")
            );
        }
    }

    let faults: [(&str, Fault); 24] = [
        ("displacement off by 20 mm", Fault::DisplacementOffset(0.02)),
        ("displacement off by 50 mm", Fault::DisplacementOffset(0.05)),
        ("displacement off by 70 mm", Fault::DisplacementOffset(0.07)),
        ("displacement drifts by 2 mm/s", Fault::DisplacementDrift(0.002)),
        ("displacement drifts by 5 mm/s", Fault::DisplacementDrift(0.005)),
        ("displacement frozen, with noise", Fault::DisplacementFrozen),
        ("displacement with gain 0.5", Fault::DisplacementGain(0.5)),
        ("displacement with gain 1.5", Fault::DisplacementGain(1.5)),
        ("displacement with gain 2", Fault::DisplacementGain(2.0)),
        ("displacement with gain 3", Fault::DisplacementGain(3.0)),
        ("displacement with the wrong sign", Fault::DisplacementGain(-1.0)),
        ("displacement 50 ms late", Fault::DisplacementLate(10)),
        ("displacement 100 ms late", Fault::DisplacementLate(20)),
        ("displacement 200 ms late", Fault::DisplacementLate(40)),
        (
            "displacements front left and right swapped",
            Fault::DisplacementsSwapped(Corner::FrontRight),
        ),
        (
            "displacements front and rear left swapped",
            Fault::DisplacementsSwapped(Corner::RearLeft),
        ),
        ("p2 off by 0.5 MPa", Fault::PressureOffset(0.5e6)),
        ("p2 off by 1.2 MPa", Fault::PressureOffset(1.2e6)),
        ("p2 off by 1.7 MPa", Fault::PressureOffset(1.7e6)),
        ("p2 off by 3 MPa", Fault::PressureOffset(3.0e6)),
        ("valve 1 stuck open", Fault::StuckOpen(Valve::Bypass1)),
        ("valve 1 stuck closed", Fault::StuckClosed(Valve::Bypass1)),
        ("valve 3 stuck open", Fault::StuckOpen(Valve::Spring)),
        ("valve 3 stuck closed", Fault::StuckClosed(Valve::Spring)),
    ];
    let drives_with_fault = [("iso-c", 80.0), ("belgian", 60.0)]
        .into_iter()
        .flat_map(|road| [Strategy::RoadAndCornering, Strategy::AlwaysStiff].map(|strategy| (road, strategy)));
    print!("\n| fault, front left |");
    for ((road, speed_km_h), strategy) in drives_with_fault.clone() {
        print!(" {road}, {speed_km_h} km/h, {} |", strategy.name());
    }
    println!("\n|---|---|---|---|---|");
    for (name, fault) in faults {
        print!("| {name} |");
        for (road, strategy) in drives_with_fault.clone() {
            let drives = drives(&[road], first_seed..first_seed + 3, &[strategy]);
            let mut after_s: Vec<f64> = Vec::new();
            for drive in &drives {
                let found = run(drive, fault)?.into_iter().find(|found| found.after_s >= 0.0);
                after_s.extend(found.map(|found| found.after_s));
            }
            print!(" {} of {}{} |", after_s.len(), drives.len(), span(&after_s));
        }
        println!();
    }
    Ok(())
}
