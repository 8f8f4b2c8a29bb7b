//! Computes the inertias and the geometry of the equations of motion from the two parameter files.

use nalgebra::Vector3;
use oleo_interface::{Axle, Axles};

use super::axle::AxleGeometry;
use super::dynamics::Masses;
use super::guide::Guide;
use super::parameters::HandlingParameters;
use crate::vehicle::VehicleParameters;

/// Inertias and geometry from both parameter files.
pub(super) fn masses(parameters: &VehicleParameters, handling: &HandlingParameters) -> Masses {
    let body = &parameters.body;
    let height_m = parameters.body_cg_height_m();
    let ahead_m = parameters.body_cg_behind_front_axle_m();
    let ahead_m = Axles::new(ahead_m, ahead_m - parameters.layout.wheelbase_m);
    let axles = Axles::from_fn(|place| {
        let (axle, more) = (parameters.axle(place), handling.axle(place));
        // Radius arms point backwards from the front axle, trailing links forwards from the rear one. The axle's roll against
        // the body is opposite to the body's lean, hence the signs of the yaw that understeers.
        let (ahead, understeers) = match place {
            Axle::Front => (-1.0, 1.0),
            Axle::Rear => (1.0, -1.0),
        };
        let guide = Guide {
            pitch_per_heave_rad_m: ahead / more.side_view_swing_arm_m,
            instant_centre_z_m: more.side_view_instant_centre_height_m - height_m,
            yaw_per_roll: understeers * more.roll_understeer,
        };
        AxleGeometry {
            mass_kg: axle.mass_kg,
            roll_inertia_kg_m2: axle.inertia_kg_m2,
            pitch_inertia_kg_m2: more.housing_pitch_inertia_kg_m2,
            roll_centre_m: Vector3::new(ahead_m[place], 0.0, more.roll_centre_height_m - height_m),
            drop_m: more.roll_centre_height_m - axle.tyre_radius_m,
            half_track_m: 0.5 * axle.track_m,
            half_strut_spacing_m: 0.5 * axle.strut_spacing_m,
            anti_roll_n_m_rad: axle.anti_roll_stiffness_n_m_rad,
            guide,
        }
    });
    let stiffness = handling.frame.torsional_stiffness_n_m_rad;
    let inertia = 0.25 * body.roll_inertia_kg_m2;
    Masses {
        body_kg: body.sprung_mass_kg,
        body_inertia_kg_m2: Vector3::new(
            body.roll_inertia_kg_m2,
            body.pitch_inertia_kg_m2,
            body.yaw_inertia_kg_m2,
        ),
        axles,
        spin_inertia_kg_m2: Axles::from_fn(|axle| handling.axle(axle).wheel_spin_inertia_kg_m2),
        torsional_stiffness_n_m_rad: stiffness,
        torsional_damping_n_m_s_rad: 2.0 * handling.frame.torsional_damping_ratio * (stiffness * inertia).sqrt(),
    }
}
