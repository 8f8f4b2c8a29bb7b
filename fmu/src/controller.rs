//! The controller: displacements and pressures in, switching signals out, a tick of 5 ms.
//!
//! A step reads the inputs as they are at its begin, decides, and its outputs hold from its end on: whoever couples the controller with a vehicle by
//! steps of both at once has one tick of delay, and whoever lets the controller step first and hands its outputs to the vehicle's step from the same
//! time has none, as the loop of `oleo drive`.

use oleo_controller::{
    Builder, Configuration, Corner, Corners, Gauge, Inputs, Outputs, State, Strategy, StrutPressures, Valve,
    VehicleDescription, tick,
};
use oleo_interface::tick::TICK_S;
use oleo_plant_sim::model_file::Range;
use serde::{Deserialize, Serialize};

use crate::complaint::Complaint;
use crate::definition::Definition;
use crate::model::{Model, switch};
use crate::variable::{Kind, Role, Variable, Word};

const FIRST_DISPLACEMENT: usize = 1;
const FIRST_PRESSURE: usize = FIRST_DISPLACEMENT + 4;
const FIRST_OUTPUT: usize = FIRST_PRESSURE + 16;
const VALVES: usize = 12;
/// Outputs beside the valves' signals.
const MODE: usize = FIRST_OUTPUT + VALVES;
const FIRST_PARAMETER: usize = MODE + 9;

/// The words of [`Mode`], in the order of their numbers.
const MODES: [Word; 5] = [
    (
        "start-up",
        "waits for the first complete set of readings; all valves closed",
    ),
    ("normal", "the strategy sets all valves"),
    (
        "degraded",
        "readings of one axle are missing; springs stiff, the other axle's dampers follow the strategy",
    ),
    ("safe", "readings of both axles are missing; all valves closed"),
    ("latched", "all valves closed until a restart"),
];
/// The words of [`FaultCode`], in the order of their numbers.
const FAULTS: [Word; 12] = [
    ("none", "no fault"),
    ("sensor-range", "a reading is outside its range"),
    ("sensor-rate", "a reading changes faster than the hardware can move"),
    ("sensor-stuck", "a reading does not change while its neighbours do"),
    (
        "sensor-vote",
        "one pressure of a strut disagrees with the others at rest",
    ),
    ("oil-balance", "displacement and gas volumes of a strut disagree"),
    ("valve-stuck", "oil moves through a valve 3 that is commanded closed"),
    ("message-lost", "a sensor message is late or not trustworthy"),
    ("bus-silent", "no sensor message arrives any more"),
    ("foreign-sender", "somebody else sends commands"),
    ("solenoid", "a solenoid could not be switched"),
    (
        "internal",
        "the controller's own arithmetic gave something that is not finite",
    ),
];
/// The words of [`Strategy`], in the order of the numbers here.
const STRATEGIES: [Word; 4] = [
    ("always-soft", "all valves open, for comparison"),
    ("always-stiff", "all valves closed, for comparison"),
    ("ride-handling", "ride mode or handling mode by running RMS"),
    (
        "road-and-cornering",
        "stiff on a smooth road and as soon as the vehicle corners; low damping by the road else",
    ),
];

/// Numbers of the description of a vehicle: name, unit, range, what it is, and the place of the number.
type Number = (
    &'static str,
    &'static str,
    Range,
    &'static str,
    fn(&mut VehicleDescription) -> &mut f32,
);
const NUMBERS: [Number; 12] = [
    (
        "vehicle.piston_area_m2",
        "m2",
        Range::FromTo(1e-4, 1e-1),
        "piston area of every strut",
        |v| &mut v.piston_area_m2,
    ),
    (
        "vehicle.gas_volume_1_m3",
        "m3",
        Range::FromTo(1e-6, 1e-1),
        "gas volume of accumulator 1 at the static position",
        |v| &mut v.gas_volume_1_m3,
    ),
    (
        "vehicle.gas_volume_2_m3",
        "m3",
        Range::FromTo(1e-6, 1e-1),
        "gas volume of accumulator 2 at the static position",
        |v| &mut v.gas_volume_2_m3,
    ),
    (
        "vehicle.strut_spacing_front_m",
        "m",
        Range::FromTo(0.2, 4.0),
        "distance between the front struts",
        |v| &mut v.strut_spacing_m.front,
    ),
    (
        "vehicle.strut_spacing_rear_m",
        "m",
        Range::FromTo(0.2, 4.0),
        "distance between the rear struts",
        |v| &mut v.strut_spacing_m.rear,
    ),
    (
        "vehicle.axle_distance_front_m",
        "m",
        Range::FromTo(0.2, 10.0),
        "distance of the front axle from the centre of mass",
        |v| &mut v.axle_distance_m.front,
    ),
    (
        "vehicle.axle_distance_rear_m",
        "m",
        Range::FromTo(0.2, 10.0),
        "distance of the rear axle from the centre of mass",
        |v| &mut v.axle_distance_m.rear,
    ),
    (
        "vehicle.roll_arm_m",
        "m",
        Range::FromTo(0.05, 3.0),
        "height of the centre of mass above the roll axis",
        |v| &mut v.roll_arm_m,
    ),
    (
        "vehicle.anti_roll_stiffness_front_N_m_rad",
        "N m/rad",
        Range::FromTo(0.0, 1e6),
        "anti-roll bar at the front",
        |v| &mut v.anti_roll_stiffness_n_m_rad.front,
    ),
    (
        "vehicle.anti_roll_stiffness_rear_N_m_rad",
        "N m/rad",
        Range::FromTo(0.0, 1e6),
        "anti-roll bar at the rear",
        |v| &mut v.anti_roll_stiffness_n_m_rad.rear,
    ),
    (
        "vehicle.roll_gyration_m",
        "m",
        Range::FromTo(0.1, 5.0),
        "radius of gyration in roll",
        |v| &mut v.roll_gyration_m,
    ),
    (
        "vehicle.pitch_gyration_m",
        "m",
        Range::FromTo(0.1, 10.0),
        "radius of gyration in pitch",
        |v| &mut v.pitch_gyration_m,
    ),
];

/// The description of a vehicle as a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct DescriptionFile(std::collections::BTreeMap<String, f64>);

impl DescriptionFile {
    /// Writes a description.
    pub fn of(mut vehicle: VehicleDescription) -> Self {
        let key = |name: &str| name.trim_start_matches("vehicle.").to_owned();
        Self(
            NUMBERS
                .iter()
                .map(|(name, .., place)| (key(name), f64::from(*place(&mut vehicle))))
                .collect(),
        )
    }

    /// Reads a description. A key that is absent has its default.
    pub fn vehicle(&self) -> VehicleDescription {
        let mut vehicle = VehicleDescription::default();
        for (name, .., place) in &NUMBERS {
            if let Some(number) = self.0.get(name.trim_start_matches("vehicle.")) {
                *place(&mut vehicle) = *number as f32;
            }
        }
        vehicle
    }
}

/// The definition of the FMU of the controller, and the controller behind it.
pub fn controller(mut vehicle: VehicleDescription) -> (Definition, ControllerUnit) {
    let mut variables = vec![Variable::time()];
    for corner in Corner::ALL {
        let name = format!("displacement_{}_m", corner.key());
        let what = format!(
            "displacement of the strut {}, compression positive; beyond 0.25 m no valid reading",
            corner.name()
        );
        variables.push(Variable::input(name, "m", Range::Finite, what));
    }
    for corner in Corner::ALL {
        variables.extend((1..=4).map(|point| {
            let name = format!("p{point}_{}_Pa", corner.key());
            let what = format!("gauge pressure p{point} of the strut {}", corner.name());
            Variable::input(name, "Pa", Range::Finite, what)
        }));
    }
    for corner in Corner::ALL {
        variables.extend(Valve::ALL.map(|valve| {
            let name = format!("valve{}_{}", valve.number(), corner.key());
            let what = format!(
                "switching signal of valve {} of the strut {}: true opens",
                valve.number(),
                corner.name()
            );
            Variable::switch(name, Role::Output, what)
        }));
    }
    let word = |name: &str, list, words, role, start: usize, what: &str| Variable {
        name: name.to_owned(),
        description: what.to_owned(),
        kind: Kind::Word { list, words },
        role,
        start: start as f64,
    };
    variables.extend([
        word("mode", "Mode", &MODES, Role::Output, 0, "mode of the controller"),
        word(
            "fault",
            "Fault",
            &FAULTS,
            Role::Output,
            0,
            "first cause of a mode other than normal",
        ),
        Variable::switch(
            "handling",
            Role::Output,
            "the strategy is in handling mode: stiff springs and high damping",
        ),
        Variable::switch("rollover_guard", Role::Output, "the roll-over guard is active"),
        Variable::output(
            "invalid_readings",
            "",
            "number of readings that may not be used, 0 to 20",
        ),
        Variable::output(
            "roll_rad",
            "rad",
            "estimated roll of the body against the axles, right side down positive",
        ),
        Variable::output(
            "pitch_rad",
            "rad",
            "estimated pitch of the body against the axles, nose down positive",
        ),
        Variable::output(
            "vertical_acceleration_m_s2",
            "m/s2",
            "estimated vertical acceleration of the body, up positive",
        ),
        Variable::output(
            "lateral_acceleration_m_s2",
            "m/s2",
            "estimated lateral acceleration of the body, left positive",
        ),
    ]);
    debug_assert_eq!(variables.len(), FIRST_PARAMETER);
    let strategy = place_of(Strategy::default());
    variables.push(word(
        "strategy",
        "Strategy",
        &STRATEGIES,
        Role::Fixed,
        strategy,
        "how valves are decided",
    ));
    variables.extend(NUMBERS.iter().map(|(name, unit, range, what, place)| {
        let start = f64::from(*place(&mut vehicle));
        Variable::parameter(*name, unit, *what, Role::Fixed, *range, start)
    }));
    let definition = Definition {
        identifier: "oleo_controller",
        description: "Controller of four two-stage hydropneumatic struts".to_owned(),
        variables,
        tick_s: Some(TICK_S),
        step_s: TICK_S,
        stop_s: 10.0,
    };
    (definition, ControllerUnit { running: None })
}

/// Place of a strategy in the list of words.
fn place_of(strategy: Strategy) -> usize {
    STRATEGIES
        .iter()
        .position(|(name, _)| *name == strategy.name())
        .unwrap_or(0)
}

/// A controller behind a table of values.
pub struct ControllerUnit {
    running: Option<Running>,
}

struct Running {
    configuration: Configuration,
    state: State,
    outputs: Outputs,
}

fn configuration(values: &[f64]) -> Result<Configuration, Complaint> {
    let mut vehicle = VehicleDescription::default();
    let (strategy, numbers) = values[FIRST_PARAMETER..].split_first().ok_or_else(not_begun)?;
    for ((.., place), number) in NUMBERS.iter().zip(numbers) {
        *place(&mut vehicle) = *number as f32;
    }
    let (name, _) = STRATEGIES.get(*strategy as usize).ok_or_else(not_begun)?;
    let strategy = name.parse().map_err(Complaint::new)?;
    let builder = Builder {
        vehicle,
        strategy,
        ..Builder::default()
    };
    builder.build().map_err(Complaint::new)
}

/// The readings of a table. A displacement or pressure that does not fit into single precision is no valid reading.
fn inputs(values: &[f64]) -> Inputs {
    let displacement_m = Corners::from_fn(|corner| values[FIRST_DISPLACEMENT + corner.index()] as f32);
    let pressure = Corners::from_fn(|corner| {
        let first = FIRST_PRESSURE + 4 * corner.index();
        StrutPressures::from_array([0, 1, 2, 3].map(|point| Gauge(values[first + point] as f32)))
    });
    Inputs::from_values(displacement_m, pressure)
}

impl Model for ControllerUnit {
    fn begin(&mut self, values: &[f64]) -> Result<(), Complaint> {
        self.running = Some(Running {
            configuration: configuration(values)?,
            state: State::new(),
            outputs: Outputs::default(),
        });
        Ok(())
    }

    fn step(&mut self, values: &[f64], duration_s: f64) -> Result<(), Complaint> {
        let running = self.running.as_mut().ok_or_else(not_begun)?;
        let inputs = inputs(values);
        for _ in 0..(duration_s / TICK_S).round() as u32 {
            running.outputs = tick(&running.configuration, &mut running.state, &inputs);
        }
        Ok(())
    }

    fn outputs(&self, values: &mut [f64]) {
        let Some(Running { outputs, .. }) = &self.running else {
            return;
        };
        for corner in Corner::ALL {
            for valve in Valve::ALL {
                let place = FIRST_OUTPUT + 3 * corner.index() + valve.index();
                values[place] = switch(outputs.command.is_open(corner, valve));
            }
        }
        let Outputs { estimate, .. } = outputs;
        values[MODE..FIRST_PARAMETER].copy_from_slice(&[
            f64::from(outputs.mode.raw()),
            f64::from(outputs.fault.raw()),
            switch(outputs.handling),
            switch(outputs.rollover_guard),
            f64::from(outputs.invalid_readings),
            f64::from(estimate.roll_rad),
            f64::from(estimate.pitch_rad),
            f64::from(estimate.vertical_acceleration_m_s2),
            f64::from(estimate.lateral.acceleration_m_s2.quick),
        ]);
    }

    fn save(&self) -> Result<Vec<u8>, Complaint> {
        let running = self.running.as_ref().ok_or_else(not_begun)?;
        postcard::to_allocvec(&running.state).map_err(Complaint::new)
    }

    fn load(&mut self, values: &[f64], bytes: &[u8]) -> Result<(), Complaint> {
        let state: State = postcard::from_bytes(bytes).map_err(Complaint::new)?;
        self.running = Some(Running {
            configuration: configuration(values)?,
            state,
            outputs: Outputs::default(),
        });
        Ok(())
    }
}

fn not_begun() -> Complaint {
    Complaint::new("the model has not begun: call the functions of the initialization mode first")
}

#[cfg(test)]
mod tests {
    use oleo_controller::{FaultCode, Mode};
    use strum::VariantArray;

    use super::*;

    /// A word that is added to the controller is to be added here.
    #[test]
    fn the_words_are_those_of_the_controller() {
        let words = |list: &[Word]| list.iter().map(|word| word.0).collect::<Vec<_>>();
        let modes: Vec<&str> = Mode::VARIANTS.iter().map(|mode| mode.name()).collect();
        let faults: Vec<&str> = FaultCode::VARIANTS.iter().map(|fault| fault.name()).collect();
        let strategies: Vec<&str> = Strategy::VARIANTS.iter().map(|strategy| strategy.name()).collect();
        assert_eq!((words(&MODES), words(&FAULTS)), (modes, faults));
        assert_eq!(words(&STRATEGIES), strategies);
        assert!((0..).zip(Mode::VARIANTS).all(|(number, mode)| mode.raw() == number));
        assert!(
            (0..)
                .zip(FaultCode::VARIANTS)
                .all(|(number, fault)| fault.raw() == number)
        );
    }

    #[test]
    fn a_description_survives_its_file() {
        let vehicle = VehicleDescription {
            roll_arm_m: 0.61,
            ..VehicleDescription::default()
        };
        let text = toml::to_string(&DescriptionFile::of(vehicle)).unwrap();
        let read: DescriptionFile = toml::from_str(&text).unwrap();
        assert_eq!(read.vehicle(), vehicle);
    }
}
