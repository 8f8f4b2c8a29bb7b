//! The vehicle on four struts, with 14 degrees of freedom: switching signals, steering and pedals in, motion and pressures out.
//!
//! It stands or rolls on a built-in road, to which the tool may add heights under the four wheels. Inputs hold for a step.

use std::sync::Arc;

use oleo_interface::tick::TICK_S;
use oleo_interface::{Axle, Corner, Corners, StrutValves, Valve};
use oleo_plant_sim::handling::{Controls, HandlingParameters, HandlingVehicle, VehicleSnapshot};
use oleo_plant_sim::model_file::{Checked, Quantity, Range};
use oleo_plant_sim::road::{self, Road};
use oleo_plant_sim::strut::{Strut, StrutModel};
use oleo_plant_sim::vehicle::{AxleParameters, BodyParameters, LayoutParameters, TyreParameters, VehicleParameters};
use serde::{Deserialize, Serialize};

use crate::complaint::Complaint;
use crate::definition::Definition;
use crate::model::{Model, is_on};
use crate::numbers::{Numbers, quantity};
use crate::raised_road::RaisedRoad;
use crate::strut;
use crate::variable::{Role, Variable};

const FIRST_VALVE: usize = 1;
const STEER: usize = FIRST_VALVE + 12;
const DRIVE: usize = STEER + 1;
const BRAKE: usize = DRIVE + 1;
const FIRST_HEIGHT: usize = BRAKE + 1;
const FIRST_OUTPUT: usize = FIRST_HEIGHT + 4;
/// Outputs of each corner: displacement, four pressures, force, load of the wheel.
const OF_CORNER: usize = 7;
/// Outputs of the body, each with unit and meaning.
const OF_BODY: [(&str, &str, &str); 13] = [
    (
        "station_m",
        "m",
        "way of the centre of mass ahead, from the start of the front axle",
    ),
    ("lateral_m", "m", "place of the centre of mass to the left"),
    ("heave_m", "m", "height of the centre of mass above that at rest"),
    ("yaw_rad", "rad", "heading, left positive"),
    ("pitch_rad", "rad", "pitch, nose down positive"),
    ("roll_rad", "rad", "roll, left side up positive"),
    ("speed_m_s", "m/s", "speed along the heading"),
    ("side_slip_rad", "rad", "side slip, left positive"),
    ("yaw_rate_rad_s", "rad/s", "rate of turn about the vertical of the body"),
    (
        "longitudinal_acceleration_m_s2",
        "m/s2",
        "horizontal acceleration along the heading",
    ),
    (
        "lateral_acceleration_m_s2",
        "m/s2",
        "horizontal acceleration to the left",
    ),
    ("heave_acceleration_m_s2", "m/s2", "vertical acceleration"),
    ("wheel_steer_rad", "rad", "angle of the front wheels against the body"),
];
const SPEED: usize = FIRST_OUTPUT + 4 * OF_CORNER + OF_BODY.len();
const FIRST_NUMBER: usize = SPEED + 1;

/// Length of a road that is made, m: beyond it random roads go on as their mirror image.
const ROAD_LENGTH_M: f64 = 1000.0;

/// What of a vehicle is not in its model files.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Start {
    /// Name of a built-in road.
    pub road: String,
    /// Seed of a random road.
    pub seed: u32,
    /// Speed at the start, m/s.
    pub speed_m_s: f64,
}

/// The definition of the FMU of a vehicle, and the vehicle behind it.
///
/// # Errors
/// An unknown road, a strut with faults of instruments, or a model that cannot be written as a file.
pub fn vehicle(
    vehicle: &VehicleParameters,
    handling: &HandlingParameters,
    strut: &StrutModel,
    start: &Start,
) -> Result<(Definition, VehicleUnit), Complaint> {
    strut::refuse_instruments(strut)?;
    if !road::NAMES.contains(&start.road.as_str()) {
        return Err(Complaint::new(format!(
            "--road {}: an FMU carries built-in roads only, {}; give heights through the inputs road_height_..._m",
            start.road,
            road::NAMES.join(", ")
        )));
    }
    let base = road::from_name_or_path(&start.road, ROAD_LENGTH_M, u64::from(start.seed)).map_err(Complaint::new)?;
    let (body_numbers, body) = Numbers::of(vehicle, describe_vehicle)?;
    let (strut_numbers, struts) = Numbers::of(strut, describe_strut)?;
    let split = body.len();
    let named = |prefix: &str, mut variable: Variable| {
        variable.name = format!("{prefix}.{}", variable.name);
        variable
    };
    let mut variables = inputs();
    variables.extend(outputs());
    variables.push(Variable::parameter(
        "initial_speed_m_s",
        "m/s",
        "speed at the start, straight ahead",
        Role::Fixed,
        Range::FromTo(0.0, 70.0),
        start.speed_m_s,
    ));
    debug_assert_eq!(variables.len(), FIRST_NUMBER);
    variables.extend(body.into_iter().map(|variable| named("vehicle", variable)));
    variables.extend(struts.into_iter().map(|variable| named("strut", variable)));
    let step_s = vehicle.solver.step_s;
    let definition = Definition {
        identifier: "oleo_vehicle",
        description: format!(
            "{} on four two-stage hydropneumatic struts, road {}",
            vehicle.name, start.road
        ),
        variables,
        tick_s: Some(step_s),
        step_s: TICK_S,
        stop_s: 10.0,
        terminal: None,
    };
    let unit = VehicleUnit {
        body_numbers,
        strut_numbers,
        split: FIRST_NUMBER + split,
        handling: handling.clone(),
        step_s,
        base,
        running: None,
    };
    Ok((definition, unit))
}

fn inputs() -> Vec<Variable> {
    let mut variables = vec![Variable::time()];
    for corner in Corner::ALL {
        variables.extend(Valve::ALL.map(|valve| {
            let name = format!("valve{}_{}", valve.number(), corner.key());
            let what = format!(
                "switching signal of valve {} of the strut {}: true opens",
                valve.number(),
                corner.name()
            );
            Variable::switch(name, Role::Input, what)
        }));
    }
    let force = Range::FromTo(0.0, 1e6);
    variables.extend([
        Variable::input(
            "steer_rad",
            "rad",
            Range::FromTo(-10.0, 10.0),
            "angle of the steering wheel over the steering ratio, left positive; the vehicle limits angle and rate",
        ),
        Variable::input("drive_force_N", "N", force, "drive force of all wheels together"),
        Variable::input("brake_force_N", "N", force, "brake force of all wheels together"),
    ]);
    variables.extend(Corner::ALL.map(|corner| {
        let name = format!("road_height_{}_m", corner.key());
        let what = format!("height that is added to the road under the wheel {}", corner.name());
        Variable::input(name, "m", Range::FromTo(-10.0, 10.0), what)
    }));
    variables
}

fn outputs() -> Vec<Variable> {
    let mut variables = Vec::new();
    for corner in Corner::ALL {
        let (key, name) = (corner.key(), corner.name());
        let what = format!("displacement of the strut {name}, compression positive");
        variables.push(Variable::output(format!("displacement_{key}_m"), "m", what));
        variables.extend((1..=4).map(|point| {
            let what = format!("gauge pressure p{point} of the strut {name}");
            Variable::output(format!("p{point}_{key}_Pa"), "Pa", what)
        }));
        let what = format!("force of the strut {name}, compression positive");
        variables.push(Variable::output(format!("force_{key}_N"), "N", what));
        let what = format!("load of the wheel {name}");
        variables.push(Variable::output(format!("wheel_load_{key}_N"), "N", what));
    }
    variables.extend(OF_BODY.map(|(name, unit, what)| Variable::output(name, unit, what)));
    variables
}

/// Numbers of the vehicle that an FMU has: all are settled when it is built. Coil springs and seats have no part in it.
fn describe_vehicle(keys: &[&str], _: Option<usize>) -> Option<(Quantity, Role)> {
    let table = match keys {
        ["body", _] => BodyParameters::quantities(),
        ["layout", _] => LayoutParameters::quantities(),
        ["front_axle" | "rear_axle", _] => AxleParameters::quantities(),
        ["tyre", _] => TyreParameters::quantities(),
        _ => return None,
    };
    Some((quantity(keys.last()?, table)?, Role::Fixed))
}

/// Numbers of the four struts: each is charged for its load, so that there is no static pressure to be set.
fn describe_strut(keys: &[&str], entry: Option<usize>) -> Option<(Quantity, Role)> {
    if keys == ["cylinder", "static_pressure_Pa"] {
        return None;
    }
    strut::describe(keys, entry).map(|(quantity, _)| (quantity, Role::Fixed))
}

/// A vehicle behind a table of values.
pub struct VehicleUnit {
    body_numbers: Numbers,
    strut_numbers: Numbers,
    /// Place of the first number of the strut.
    split: usize,
    handling: HandlingParameters,
    step_s: f64,
    base: Arc<dyn Road>,
    running: Option<Running>,
}

struct Running {
    model: HandlingVehicle,
    road: Arc<RaisedRoad>,
}

impl VehicleUnit {
    /// The vehicle of a table of values at its start.
    fn at_start(&self, values: &[f64]) -> Result<Running, Complaint> {
        let (body, strut) = values[FIRST_NUMBER..].split_at(self.split - FIRST_NUMBER);
        let parameters: VehicleParameters = self.body_numbers.model(body.iter().copied())?;
        parameters.check().map_err(Complaint::new)?;
        let strut: StrutModel = self.strut_numbers.model(strut.iter().copied())?;
        let load_n = parameters.static_strut_load_n();
        let signals = signals(values);
        let struts =
            Corners::try_from_fn(|corner| Strut::at_rest(&strut.clone().charged_for(load_n[corner]), signals[corner]));
        let road = Arc::new(RaisedRoad::on(
            Arc::clone(&self.base),
            -parameters.body_cg_behind_front_axle_m(),
            parameters.body_cg_behind_front_axle_m() - 0.5 * parameters.layout.wheelbase_m,
        ));
        road.raise(heights_m(values));
        let as_road: Arc<dyn Road> = Arc::clone(&road) as Arc<dyn Road>;
        let struts = struts.map_err(Complaint::new)?;
        let model = HandlingVehicle::new(&parameters, &self.handling, struts, as_road, values[SPEED]);
        Ok(Running {
            model: model.map_err(Complaint::new)?,
            road,
        })
    }
}

fn signals(values: &[f64]) -> Corners<StrutValves<bool>> {
    Corners::from_fn(|corner| {
        StrutValves::from_fn(|valve| is_on(values[FIRST_VALVE + 3 * corner.index() + valve.index()]))
    })
}

/// Heights that are added to the road under the wheels, m.
fn heights_m(values: &[f64]) -> Corners<f64> {
    Corners::from_fn(|corner| values[FIRST_HEIGHT + corner.index()])
}

impl Model for VehicleUnit {
    fn begin(&mut self, values: &[f64]) -> Result<(), Complaint> {
        self.running = Some(self.at_start(values)?);
        Ok(())
    }

    fn step(&mut self, values: &[f64], duration_s: f64) -> Result<(), Complaint> {
        let running = self.running.as_mut().ok_or_else(not_begun)?;
        let controls = Controls {
            steer_rad: values[STEER],
            drive_force_n: values[DRIVE],
            brake_force_n: values[BRAKE],
        };
        let signals = signals(values);
        running.road.raise(heights_m(values));
        for _ in 0..(duration_s / self.step_s).round() as u32 {
            running.road.follow(&running.model);
            running.model.step(signals, controls);
        }
        Ok(())
    }

    fn outputs(&self, values: &mut [f64]) {
        let Some(Running { model, .. }) = &self.running else {
            return;
        };
        let (displacement_m, struts, wheels) = (model.strut_displacement_m(), model.strut_output(), model.wheels());
        for corner in Corner::ALL {
            let first = FIRST_OUTPUT + OF_CORNER * corner.index();
            let [p1, p2, p3, p4] = struts[corner].pressure_pa;
            values[first..first + OF_CORNER].copy_from_slice(&[
                displacement_m[corner],
                p1,
                p2,
                p3,
                p4,
                struts[corner].force_n,
                wheels[corner].load_n,
            ]);
        }
        let motion = model.motion();
        let [x, y, z] = motion.position_m;
        let [_, _, yaw_rate] = motion.rates_rad_s;
        let body: [f64; OF_BODY.len()] = [
            x,
            y,
            z,
            motion.yaw_rad,
            motion.pitch_rad,
            motion.roll_rad,
            motion.speed_m_s,
            motion.side_slip_rad,
            yaw_rate,
            motion.longitudinal_acceleration_m_s2,
            motion.lateral_acceleration_m_s2,
            motion.vertical_acceleration_m_s2,
            model.wheel_steer_rad(Axle::Front),
        ];
        values[SPEED - OF_BODY.len()..SPEED].copy_from_slice(&body);
    }

    fn save(&self) -> Result<Vec<u8>, Complaint> {
        let running = self.running.as_ref().ok_or_else(not_begun)?;
        postcard::to_allocvec(&running.model.snapshot()).map_err(Complaint::new)
    }

    fn load(&mut self, values: &[f64], bytes: &[u8]) -> Result<(), Complaint> {
        let kept: VehicleSnapshot = postcard::from_bytes(bytes).map_err(Complaint::new)?;
        let mut running = self.at_start(values)?;
        running.model.restore(&kept);
        self.running = Some(running);
        Ok(())
    }
}

fn not_begun() -> Complaint {
    Complaint::new("the model has not begun: call the functions of the initialization mode first")
}

#[cfg(test)]
mod tests {
    use oleo_controller::{Configuration, Gauge, Inputs, State, StrutPressures, tick};

    use super::*;
    use crate::controller::controller;

    const SPEED_M_S: f64 = 12.0;
    const TICKS: usize = 600;

    fn start() -> Start {
        Start {
            road: "belgian".to_owned(),
            seed: 3,
            speed_m_s: SPEED_M_S,
        }
    }

    fn unit() -> (Definition, VehicleUnit) {
        let (body, handling) = (VehicleParameters::defender110(), HandlingParameters::defender110());
        vehicle(&body, &handling, &StrutModel::defender110(8000.0), &start()).unwrap()
    }

    /// The driver of the test: a slalom with some pedal.
    fn controls(k: usize) -> Controls {
        let t = TICK_S * k as f64;
        Controls {
            steer_rad: 0.03 * libm::sin(2.0 * t),
            drive_force_n: 700.0,
            brake_force_n: if k % 200 < 20 { 2000.0 } else { 0.0 },
        }
    }

    /// The vehicle and the controller in a loop of our own, without any table: force of each strut in each tick.
    fn own_loop() -> Vec<[u64; 4]> {
        let (body, handling) = (VehicleParameters::defender110(), HandlingParameters::defender110());
        let load_n = body.static_strut_load_n();
        let struts = Corners::from_fn(|corner| {
            Strut::at_rest(&StrutModel::defender110(load_n[corner]), StrutValves::default()).unwrap()
        });
        let road = road::from_name_or_path("belgian", ROAD_LENGTH_M, 3).unwrap();
        let mut vehicle = HandlingVehicle::new(&body, &handling, struts, road, SPEED_M_S).unwrap();
        let (configuration, mut state) = (Configuration::defender110(), State::new());
        (0..TICKS)
            .map(|k| {
                let displacement_m = vehicle.strut_displacement_m().map(|x| x as f32);
                let pressure = (vehicle.strut_output())
                    .map(|output| StrutPressures::from_array(output.pressure_pa).map(|p| Gauge(p as f32)));
                let inputs = Inputs::from_values(displacement_m, pressure);
                let signals = tick(&configuration, &mut state, &inputs).command.corners();
                for _ in 0..(TICK_S / body.solver.step_s).round() as u32 {
                    vehicle.step(signals, controls(k));
                }
                vehicle
                    .strut_output()
                    .map(|output| output.force_n.to_bits())
                    .into_array()
            })
            .collect()
    }

    /// Copies the outputs of one table into the inputs of the same name in another.
    fn connect(from: (&Definition, &[f64]), to: (&Definition, &mut [f64])) {
        for (place, input) in to.0.variables.iter().enumerate() {
            let same = |output: &Variable| output.role == Role::Output && output.name == input.name;
            if input.role == Role::Input
                && let Some(output) = from.0.variables.iter().position(same)
            {
                to.1[place] = from.1[output];
            }
        }
    }

    /// A tool that lets the controller step first drives our own loop, bit by bit; also when it goes on from saved states half-way.
    #[test]
    fn vehicle_and_controller_connected_by_name_are_our_own_loop() {
        let (vehicle_is, mut vehicle) = unit();
        let (controller_is, mut controller) = controller(oleo_controller::VehicleDescription::default());
        let (mut of_vehicle, mut of_controller) = (vehicle_is.start(), controller_is.start());
        vehicle.begin(&of_vehicle).unwrap();
        vehicle.outputs(&mut of_vehicle);
        controller.begin(&of_controller).unwrap();
        let mut opened = false;
        for (k, expected) in own_loop().into_iter().enumerate() {
            if k == TICKS / 2 {
                let kept = [vehicle.save().unwrap(), controller.save().unwrap()];
                let (fresh, other) = (unit().1, crate::controller::controller(Default::default()).1);
                (vehicle, controller) = (fresh, other);
                vehicle.load(&of_vehicle, &kept[0]).unwrap();
                controller.load(&of_controller, &kept[1]).unwrap();
            }
            connect((&vehicle_is, &of_vehicle), (&controller_is, &mut of_controller));
            controller.step(&of_controller, TICK_S).unwrap();
            controller.outputs(&mut of_controller);
            connect((&controller_is, &of_controller), (&vehicle_is, &mut of_vehicle));
            let controls = controls(k);
            of_vehicle[STEER] = controls.steer_rad;
            of_vehicle[DRIVE] = controls.drive_force_n;
            of_vehicle[BRAKE] = controls.brake_force_n;
            vehicle.step(&of_vehicle, TICK_S).unwrap();
            vehicle.outputs(&mut of_vehicle);
            let force = |corner: usize| of_vehicle[FIRST_OUTPUT + OF_CORNER * corner + 5].to_bits();
            assert_eq!([0, 1, 2, 3].map(force), expected, "tick {k}");
            opened |= of_vehicle[FIRST_VALVE] != 0.0;
        }
        assert!(opened, "the controller has opened a valve");
    }

    #[test]
    fn each_wheel_stands_on_its_own_height() {
        let (definition, mut unit) = unit();
        let mut values = definition.start();
        values[SPEED] = 0.0;
        unit.base = Arc::new(road::Flat);
        unit.begin(&values).unwrap();
        // The front left wheel is raised by 30 mm: it is pushed in, and so is the one across.
        values[FIRST_HEIGHT] = 0.03;
        for _ in 0..600 {
            unit.step(&values, TICK_S).unwrap();
        }
        unit.outputs(&mut values);
        let displacement = |corner: usize| values[FIRST_OUTPUT + OF_CORNER * corner];
        assert!(
            displacement(0) > 0.002 && displacement(3) > 0.002,
            "{} {}",
            displacement(0),
            displacement(3)
        );
        assert!(
            displacement(1) < -0.002 && displacement(2) < -0.002,
            "{} {}",
            displacement(1),
            displacement(2)
        );
    }

    #[test]
    fn an_unknown_road_is_refused_in_one_line() {
        let (body, handling) = (VehicleParameters::defender110(), HandlingParameters::defender110());
        let start = Start {
            road: "lane.crg".to_owned(),
            ..start()
        };
        let refused = vehicle(&body, &handling, &StrutModel::defender110(8000.0), &start);
        let complaint = refused.err().unwrap().to_string();
        assert!(
            complaint.starts_with("--road lane.crg: an FMU carries built-in roads only, belgian, "),
            "{complaint}"
        );
    }
}
