//! The suspension as set on the command line: fixed valves, or the controller called directly, without a bus between.

use oleo_controller::{Configuration, Inputs, State, ValveCommand, tick};
use oleo_interface::{Corners, Gauge, StrutPressures, StrutValves};
use oleo_plant_sim::model_file::InvalidValue;
use oleo_plant_sim::strut::{Strut, StrutModel, StrutOutput};
use oleo_plant_sim::vehicle::VehicleParameters;

use super::arguments::Setting;

/// Where the valves' signals come from.
pub enum Valves {
    Fixed(bool),
    Controlled {
        configuration: Box<Configuration>,
        state: Box<State>,
    },
}

impl Valves {
    pub fn new(setting: Setting) -> Self {
        match setting {
            Setting::Soft => Self::Fixed(true),
            Setting::Stiff | Setting::Baseline => Self::Fixed(false),
            Setting::Controlled => Self::Controlled {
                configuration: Box::new(Configuration::defender110()),
                state: Box::new(State::new()),
            },
        }
    }

    /// Signals before the first tick: what the struts start with.
    pub fn at_start(&self) -> [bool; 3] {
        [matches!(self, Self::Fixed(true)); 3]
    }

    /// Signals for the coming tick of 5 ms, and the valve word.
    pub fn decide(&mut self, displacement_m: [f64; 4], outputs: [StrutOutput; 4]) -> ([[bool; 3]; 4], u16) {
        let command = match self {
            Self::Fixed(true) => ValveCommand::SOFT,
            Self::Fixed(false) => ValveCommand::SAFE,
            Self::Controlled { configuration, state } => {
                let pressure = Corners::from_array(outputs)
                    .map(|output| StrutPressures::from_array(output.pressure_pa).map(|p| Gauge(p as f32)));
                let displacement_m = Corners::from_array(displacement_m).map(|x| x as f32);
                tick(configuration, state, &Inputs::from_values(displacement_m, pressure)).command
            }
        };
        (
            command.corners().map(StrutValves::into_array).into_array(),
            command.word(),
        )
    }
}

/// Four struts of the preset, each for its corner's static load.
pub fn struts(parameters: &VehicleParameters, signals: [bool; 3]) -> Result<[Strut; 4], InvalidValue> {
    let [a, b, c, d] = parameters.static_strut_load_n();
    let strut = |load_n: f64| Strut::at_rest(&StrutModel::defender110(load_n), StrutValves::from_array(signals));
    Ok([strut(a)?, strut(b)?, strut(c)?, strut(d)?])
}
