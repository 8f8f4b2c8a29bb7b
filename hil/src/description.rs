//! The controller's description of a vehicle, from the files that describe the vehicle to the plant.
//!
//! It holds what stands on a data sheet: dimensions, inertias over mass, anti-roll bars, oil and gas. What the vehicle carries is
//! not told, because nobody tells it to a car; the struts measure it.

use oleo_controller::VehicleDescription;
use oleo_interface::{Axle, Axles};
use oleo_plant_sim::handling::HandlingParameters;
use oleo_plant_sim::strut::StrutModel;
use oleo_plant_sim::vehicle::VehicleParameters;

/// The description of an unladen vehicle on four struts of one model.
pub fn describe(vehicle: &VehicleParameters, handling: &HandlingParameters, strut: &StrutModel) -> VehicleDescription {
    let ahead_m = vehicle.body_cg_behind_front_axle_m();
    let wheelbase_m = vehicle.layout.wheelbase_m;
    // The roll axis runs through both roll centres.
    let centre = |axle: Axle| handling.axle(axle).roll_centre_height_m;
    let axis_m = centre(Axle::Front) + (centre(Axle::Rear) - centre(Axle::Front)) * ahead_m / wheelbase_m;
    let body = &vehicle.body;
    let [volume_1_m3, volume_2_m3] = strut.accumulator.each_ref().map(|a| a.static_gas_volume_m3 as f32);
    VehicleDescription {
        piston_area_m2: strut.piston_area_m2() as f32,
        gas_volume_1_m3: volume_1_m3,
        gas_volume_2_m3: volume_2_m3,
        strut_spacing_m: Axles::from_fn(|axle| vehicle.axle(axle).strut_spacing_m as f32),
        axle_distance_m: Axles::new(ahead_m as f32, (wheelbase_m - ahead_m) as f32),
        roll_arm_m: (vehicle.body_cg_height_m() - axis_m) as f32,
        anti_roll_stiffness_n_m_rad: Axles::from_fn(|axle| vehicle.axle(axle).anti_roll_stiffness_n_m_rad as f32),
        roll_gyration_m: (body.roll_inertia_kg_m2 / body.sprung_mass_kg).sqrt() as f32,
        pitch_gyration_m: (body.pitch_inertia_kg_m2 / body.sprung_mass_kg).sqrt() as f32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_plant_sim::vehicle::{GRAVITY_M_S2, Load};

    fn of(vehicle: &VehicleParameters) -> VehicleDescription {
        describe(
            vehicle,
            &HandlingParameters::defender110(),
            &StrutModel::defender110(4000.0),
        )
    }

    /// The arms from the moments of the axle loads, the roll arm from the lever rule: no use of the description's own formulas.
    #[test]
    fn lengths_follow_from_statics() {
        let vehicle = VehicleParameters::defender110();
        let described = of(&vehicle);
        let load_n = vehicle.static_strut_load_n();
        let rear_share = load_n.of_axle(Axle::Rear).into_iter().sum::<f64>() / load_n.values().sum::<f64>();
        let front_m = f64::from(described.axle_distance_m.front);
        assert!(
            (front_m / vehicle.layout.wheelbase_m - rear_share).abs() < 1e-6,
            "{front_m}"
        );
        let weight_n = vehicle.body.sprung_mass_kg * GRAVITY_M_S2;
        assert!((load_n.values().sum::<f64>() / weight_n - 1.0).abs() < 1e-9);
        let axis_m = 0.50 * (1.0 - rear_share) + 0.62 * rear_share;
        assert!((f64::from(described.roll_arm_m) + axis_m - vehicle.body_cg_height_m()).abs() < 1e-6);
    }

    /// A load changes masses only, none of which are described. The laden vehicle's own description would be another one.
    #[test]
    fn a_load_is_not_in_the_description_of_the_unladen_vehicle() {
        let vehicle = VehicleParameters::defender110();
        assert_ne!(of(&vehicle), of(&Load::Laden.at_ride_height(&vehicle)));
    }

    /// The controller's own default is this vehicle, in the digits that a data sheet gives.
    #[test]
    fn the_controllers_default_is_the_built_in_vehicle() {
        let (described, built_in) = (of(&VehicleParameters::defender110()), VehicleDescription::default());
        let numbers = |d: VehicleDescription| {
            let axles =
                [d.strut_spacing_m, d.axle_distance_m, d.anti_roll_stiffness_n_m_rad].map(|a| [a.front, a.rear]);
            let others = [
                d.piston_area_m2,
                d.gas_volume_1_m3,
                d.gas_volume_2_m3,
                d.roll_arm_m,
                d.roll_gyration_m,
                d.pitch_gyration_m,
            ];
            axles.concat().into_iter().chain(others)
        };
        for (described, built_in) in numbers(described).zip(numbers(built_in)) {
            assert!(
                (described - built_in).abs() <= 2e-3 * described.abs(),
                "{described} {built_in}"
            );
        }
    }

    #[test]
    fn the_controller_accepts_it() {
        let builder = oleo_controller::Builder {
            vehicle: of(&VehicleParameters::defender110()),
            ..oleo_controller::Builder::default()
        };
        assert!(builder.build().is_ok());
    }
}
