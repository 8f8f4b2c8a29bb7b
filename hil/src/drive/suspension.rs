//! The suspension of a drive: fixed valves, or the controller, which is called directly without a
//! bus.

use oleo_controller::{Builder, Configuration, ConfigurationError, Inputs, State, VehicleDescription, tick};
use oleo_interface::{Corners, Gauge, StrutPressures, StrutValves};
use oleo_plant_sim::course::Signals;
use oleo_plant_sim::model_file::InvalidValue;
use oleo_plant_sim::strut::{Strut, StrutOutput};
use oleo_plant_sim::vehicle::TemperedStrut;

use super::choice::Setting;

/// Where the valves' signals come from.
pub enum Valves {
    Fixed(bool),
    Controlled {
        configuration: Box<Configuration>,
        state: Box<State>,
    },
}

impl Valves {
    /// `vehicle` is what a controller knows of the vehicle.
    pub fn new(setting: Setting, vehicle: VehicleDescription) -> Result<Self, ConfigurationError> {
        Ok(match setting {
            Setting::Soft => Self::Fixed(true),
            Setting::Stiff | Setting::Baseline => Self::Fixed(false),
            Setting::Controlled => {
                let builder = Builder {
                    vehicle,
                    ..Builder::default()
                };
                Self::Controlled {
                    configuration: Box::new(builder.build()?),
                    state: Box::new(State::new()),
                }
            }
        })
    }

    /// Signals before the first tick: what the struts start with.
    pub fn at_start(&self) -> StrutValves<bool> {
        StrutValves::splat(matches!(self, Self::Fixed(true)))
    }

    /// Signals for the coming tick of 5 ms.
    pub fn decide(&mut self, displacement_m: Corners<f64>, outputs: Corners<StrutOutput>) -> Signals {
        match self {
            Self::Fixed(open) => Corners::splat(StrutValves::splat(*open)),
            Self::Controlled { configuration, state } => {
                let pressure =
                    outputs.map(|output| StrutPressures::from_array(output.pressure_pa).map(|p| Gauge(p as f32)));
                let inputs = Inputs::from_values(displacement_m.map(|x| x as f32), pressure);
                tick(configuration, state, &inputs).command.corners()
            }
        }
    }
}

/// Four struts at rest.
pub fn struts(models: &Corners<TemperedStrut>, signals: StrutValves<bool>) -> Result<Corners<Strut>, InvalidValue> {
    Corners::try_from_fn(|corner| Strut::at_rest(&models[corner].model, signals))
}
