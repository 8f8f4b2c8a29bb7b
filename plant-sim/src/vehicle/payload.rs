//! A mass that the vehicle carries besides what its parameters say, in one point of its middle plane.
//!
//! It is what a vehicle has that its model lacks: luggage, a winch, a second battery. Masses and moments add, inertias by the parallel-axis
//! theorem, as for the loads of [`super::Load`]. The models of the vehicle are the same left and right at rest, so that a place off the
//! middle plane cannot be simulated.

use serde::{Deserialize, Serialize};

use super::load::{Cargo, put};
use super::parameters::VehicleParameters;
use crate::model_file::{Checked, Limit, Range};

/// A point mass on the body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Payload {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Place ahead of the centre of mass of the sprung mass in running order, m.
    #[serde(default)]
    pub x_m: f64,
    /// Place above it, m.
    #[serde(default)]
    pub z_m: f64,
}

impl Checked for Payload {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("mass_kg", Range::FromTo(0.0, 2000.0), "kg", |payload| payload.mass_kg),
        Limit::one("x_m", Range::FromTo(-5.0, 5.0), "m", |payload| payload.x_m),
        Limit::one("z_m", Range::FromTo(-2.0, 3.0), "m", |payload| payload.z_m),
    ];
}

impl Payload {
    /// A loaded vehicle with this mass on it. Its place is counted from the centre of mass of the body of `empty`, the vehicle in running order.
    pub fn on(&self, loaded: &VehicleParameters, empty: &VehicleParameters) -> VehicleParameters {
        let mut carrying = loaded.clone();
        let cargo = Cargo {
            mass_kg: self.mass_kg,
            behind_front_axle_m: empty.body_cg_behind_front_axle_m() - self.x_m,
            above_ground_m: empty.body_cg_height_m() + self.z_m,
            size_m: [0.0; 3],
        };
        put(&mut carrying, &cargo);
        carrying
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The centre of mass of two points and the inertia about it, by hand.
    #[test]
    fn two_masses_have_their_common_centre() {
        let empty = VehicleParameters::defender110();
        let payload = Payload {
            mass_kg: 400.0,
            x_m: -1.0,
            z_m: 0.5,
        };
        let carrying = payload.on(&empty, &empty);
        assert_eq!(carrying.body.sprung_mass_kg, 2000.0);
        let back_m = carrying.body_cg_behind_front_axle_m() - empty.body_cg_behind_front_axle_m();
        let up_m = carrying.body_cg_height_m() - empty.body_cg_height_m();
        assert!(
            (back_m - 0.2).abs() < 1e-12 && (up_m - 0.1).abs() < 1e-12,
            "{back_m} {up_m}"
        );
        // Both masses about the new centre: 1600 kg at 0.1 m below it, 400 kg at 0.4 m above.
        let added = carrying.body.roll_inertia_kg_m2 - empty.body.roll_inertia_kg_m2;
        assert!((added - (1600.0 * 0.01 + 400.0 * 0.16)).abs() < 1e-9, "{added}");
    }
}
