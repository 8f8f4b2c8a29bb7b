//! A period of the controller with the readings of a drive over Belgian block, the springs soft.

use std::hint::black_box;

use divan::Bencher;
use oleo_controller::{Configuration, Inputs, Node, PlantEnd, State, tick};
use oleo_hil::instruments::Instruments;
use oleo_interface::tick::TICK_S;
use oleo_interface::{Corners, StrutValves};
use oleo_plant_sim::road;
use oleo_plant_sim::strut::{Strut, StrutModel};
use oleo_plant_sim::vehicle::{RideVehicle, VehicleParameters};

/// Ticks of the drive, 5 s. It is repeated as often as the timing asks.
const TICKS: u32 = 1000;

/// What the sensors say in every tick.
fn readings() -> Vec<Inputs> {
    const SPEED_M_S: f64 = 10.0;
    let parameters = VehicleParameters::defender110();
    let soft = StrutValves::new(true, true, true);
    let struts = (parameters.static_strut_load_n())
        .map(|load_n| Strut::at_rest(&StrutModel::defender110(load_n), soft).expect("the preset"));
    let length_m = SPEED_M_S * f64::from(TICKS) * TICK_S + 20.0;
    let road = road::from_name_or_path("belgian", length_m, 1).expect("a road");
    let mut vehicle = RideVehicle::new(&parameters, struts, road, SPEED_M_S).expect("a vehicle");
    let steps = (TICK_S / vehicle.step_s()).round() as u32;
    let mut sensors = Instruments::new(&[], 1);
    (0..TICKS)
        .map(|tick| {
            (0..steps).for_each(|_| vehicle.step(Corners::splat(soft)));
            sensors.read(tick, vehicle.strut_displacement_m(), vehicle.strut_output())
        })
        .collect()
}

/// Readings in, valves out, without a bus.
#[divan::bench]
fn controller_tick(bencher: Bencher) {
    let (configuration, mut state) = (Configuration::defender110(), State::new());
    let drive = readings();
    let mut inputs = drive.iter().cycle();
    bencher.bench_local(|| {
        tick(
            &configuration,
            &mut state,
            black_box(inputs.next().unwrap_or(&drive[0])),
        )
    });
}

/// The same with six frames received and checked, two frames sent, and the plant's end of the bus.
#[divan::bench]
fn controller_tick_with_frames(bencher: Bencher) {
    let (mut node, mut plant) = (Node::new(Configuration::defender110()), PlantEnd::new());
    let drive = readings();
    let mut inputs = drive.iter().cycle();
    let mut number = 0_u16;
    bencher.bench_local(|| {
        for frame in plant.encode(number, inputs.next().unwrap_or(&drive[0])) {
            node.receive(frame.id, &frame.data);
        }
        number = number.wrapping_add(1);
        let (outputs, frames) = node.tick();
        for frame in frames {
            plant.receive(frame.id, &frame.data);
        }
        plant.end_of_tick();
        outputs
    });
}
