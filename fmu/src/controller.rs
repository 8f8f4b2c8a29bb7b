//! The controller: displacements and pressures in, switching signals out, a tick of 5 ms.
//!
//! A step reads the inputs as they are at its begin, decides, and its outputs hold from its end on: whoever couples the controller with a vehicle by
//! steps of both at once has one tick of delay, and whoever lets the controller step first and hands its outputs to the vehicle's step from the same
//! time has none, as the loop of `oleo drive`.

use oleo_controller::{
    Configuration, Corner, Corners, Gauge, Inputs, Outputs, State, StrutPressures, VehicleDescription, tick,
};
use oleo_interface::tick::TICK_S;
use oleo_plant_sim::model_file::Range;

use crate::complaint::Complaint;
use crate::controller_parameters;
use crate::decision;
use crate::definition::Definition;
use crate::model::Model;
use crate::variable::Variable;

const FIRST_DISPLACEMENT: usize = 1;
const FIRST_PRESSURE: usize = FIRST_DISPLACEMENT + 4;
const FIRST_OUTPUT: usize = FIRST_PRESSURE + 16;
const FIRST_PARAMETER: usize = FIRST_OUTPUT + decision::SIZE;

/// The definition of the FMU of the controller, and the controller behind it.
pub fn controller(vehicle: VehicleDescription) -> (Definition, ControllerUnit) {
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
    variables.extend(decision::variables());
    debug_assert_eq!(variables.len(), FIRST_PARAMETER);
    variables.extend(controller_parameters::variables(vehicle));
    let definition = Definition {
        identifier: "oleo_controller",
        description: "Controller of four two-stage hydropneumatic struts".to_owned(),
        variables,
        tick_s: Some(TICK_S),
        step_s: TICK_S,
        stop_s: 10.0,
        terminal: None,
    };
    (definition, ControllerUnit { running: None })
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
            configuration: controller_parameters::configuration(&values[FIRST_PARAMETER..])?,
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
        if let Some(Running { outputs, .. }) = &self.running {
            decision::write(outputs, &mut values[FIRST_OUTPUT..FIRST_PARAMETER]);
        }
    }

    fn save(&self) -> Result<Vec<u8>, Complaint> {
        let running = self.running.as_ref().ok_or_else(not_begun)?;
        postcard::to_allocvec(&running.state).map_err(Complaint::new)
    }

    fn load(&mut self, values: &[f64], bytes: &[u8]) -> Result<(), Complaint> {
        let state: State = postcard::from_bytes(bytes).map_err(Complaint::new)?;
        self.running = Some(Running {
            configuration: controller_parameters::configuration(&values[FIRST_PARAMETER..])?,
            state,
            outputs: Outputs::default(),
        });
        Ok(())
    }
}

fn not_begun() -> Complaint {
    Complaint::new("the model has not begun: call the functions of the initialization mode first")
}
