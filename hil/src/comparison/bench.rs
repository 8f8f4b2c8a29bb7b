//! The vehicle under comparison, and the controller's description of it.

use oleo_controller::{Builder, VehicleDescription};
use oleo_interface::{Axle, Axles};
use oleo_plant_sim::handling::HandlingParameters;
use oleo_plant_sim::strut::StrutModel;
use oleo_plant_sim::vehicle::VehicleParameters;

/// A vehicle with its handling.
#[derive(Clone)]
pub struct Bench {
    /// Masses, dimensions, springs.
    pub vehicle: VehicleParameters,
    /// Tyres, axles, steering.
    pub handling: HandlingParameters,
}

impl Bench {
    /// The built-in Land Rover Defender 110.
    pub fn defender110() -> Self {
        Self {
            vehicle: VehicleParameters::defender110(),
            handling: HandlingParameters::defender110(),
        }
    }

    /// The controller of this vehicle as designed: the dimensions and inertias of its data sheet. What it carries is not told: the
    /// struts measure it.
    pub fn controller(&self) -> Builder {
        Builder {
            vehicle: describe(&self.vehicle, &self.handling, &StrutModel::defender110(1.0)),
            ..Builder::default()
        }
    }
}

/// The controller's description of a vehicle.
pub fn describe(vehicle: &VehicleParameters, handling: &HandlingParameters, strut: &StrutModel) -> VehicleDescription {
    let ahead_m = vehicle.body_cg_behind_front_axle_m();
    let wheelbase_m = vehicle.layout.wheelbase_m;
    // The roll axis runs through both roll centres.
    let centre = |axle: Axle| handling.axle(axle).roll_centre_height_m;
    let axis_m = centre(Axle::Front) + (centre(Axle::Rear) - centre(Axle::Front)) * ahead_m / wheelbase_m;
    let body = &vehicle.body;
    VehicleDescription {
        piston_area_m2: strut.piston_area_m2() as f32,
        strut_spacing_m: Axles::from_fn(|axle| vehicle.axle(axle).strut_spacing_m as f32),
        axle_distance_m: Axles::new(ahead_m as f32, (wheelbase_m - ahead_m) as f32),
        roll_arm_m: (vehicle.body_cg_height_m() - axis_m) as f32,
        anti_roll_stiffness_n_m_rad: Axles::from_fn(|axle| vehicle.axle(axle).anti_roll_stiffness_n_m_rad as f32),
        roll_gyration_m: (body.roll_inertia_kg_m2 / body.sprung_mass_kg).sqrt() as f32,
        pitch_gyration_m: (body.pitch_inertia_kg_m2 / body.sprung_mass_kg).sqrt() as f32,
        ..VehicleDescription::default()
    }
}
