//! The vehicle under comparison, and the controller's description of it.

use oleo_controller::Builder;
use oleo_interface::{Corner, Corners};
use oleo_plant_sim::handling::HandlingParameters;
use oleo_plant_sim::strut::StrutModel;
use oleo_plant_sim::variation::{SensorErrors, Variation};
use oleo_plant_sim::vehicle::VehicleParameters;

use crate::description;

/// Noise of the displacement sensors, m, and of the pressure sensors, Pa: the strut preset's `[noise]`.
const NOISE: (f64, f64) = (5.0e-6, 4.0e3);

/// A vehicle with its handling, its struts and its sensors.
#[derive(Clone, Debug, PartialEq)]
pub struct Bench {
    /// Masses, dimensions, springs.
    pub vehicle: VehicleParameters,
    /// Tyres, axles, steering.
    pub handling: HandlingParameters,
    /// Struts, charged for their loads.
    pub struts: Corners<StrutModel>,
    /// Displacement at rest as a sensor says that was set to zero when the struts were charged, m, compression positive.
    pub rest_displacement_m: Corners<f64>,
    /// Errors of the sensors.
    pub sensors: SensorErrors,
}

impl Bench {
    /// A vehicle on four such struts, each charged for the load that its corner carries.
    pub fn new(vehicle: VehicleParameters, handling: HandlingParameters, strut: &StrutModel) -> Self {
        let struts = (vehicle.static_strut_load_n()).map(|load_n| strut.clone().charged_for(load_n));
        Self {
            vehicle,
            handling,
            struts,
            rest_displacement_m: Corners::splat(0.0),
            sensors: SensorErrors {
                displacement_noise_m: NOISE.0,
                displacement_offset_m: Corners::splat(0.0),
                pressure_noise_pa: NOISE.1,
                pressure_offset_pa: Corners::splat(0.0),
            },
        }
    }

    /// The built-in Land Rover Defender 110.
    pub fn defender110() -> Self {
        Self::new(
            VehicleParameters::defender110(),
            HandlingParameters::defender110(),
            &StrutModel::defender110(1.0),
        )
    }

    /// A random variation of this vehicle.
    #[must_use]
    pub fn varied(&self, variation: &Variation) -> Self {
        let varied = variation.of(&self.vehicle, &self.handling, &self.struts[Corner::FrontLeft]);
        Self {
            vehicle: varied.vehicle,
            handling: varied.handling,
            struts: varied.struts,
            rest_displacement_m: varied.rest_displacement_m,
            sensors: variation.sensors,
        }
    }

    /// The controller of this vehicle as designed: the dimensions and inertias of its data sheet. What it carries is not told:
    /// the struts measure it.
    pub fn controller(&self) -> Builder {
        let strut = &self.struts[Corner::FrontLeft];
        Builder {
            vehicle: description::describe(&self.vehicle, &self.handling, strut),
            ..Builder::default()
        }
    }
}
