//! Loads of a vehicle: variants of one vehicle for the same drive.
//!
//! A load is a box on the body. Masses and moments add; inertias by the parallel-axis theorem. With struts the vehicle stands at
//! its ride height whatever it carries, because each strut is charged for its load; on coil springs it sinks, which brings the
//! centre of mass down and the bump stops nearer.

use oleo_interface::{Axle, Axles};
use strum::{EnumString, IntoStaticStr, VariantArray};

use super::parameters::VehicleParameters;

/// What is put on the vehicle. Masses and places of the cargo are for a Defender 110.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, IntoStaticStr, EnumString, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum Load {
    /// Nothing: the vehicle as its parameters describe it.
    #[default]
    AsSold,
    /// 900 kg in the load bay, which makes the preset's 2,050 kg the gross vehicle mass of 2,950 kg.
    Laden,
    /// 150 kg on a roof rack, the most that such racks are sold for.
    Roof,
    /// The gross vehicle mass of 2,950 kg, 150 kg of it on the roof rack.
    LadenRoof,
}

/// A box of even density. Places are assumed: no drawing of the load bay could be reached.
pub(crate) struct Cargo {
    pub(crate) mass_kg: f64,
    pub(crate) behind_front_axle_m: f64,
    pub(crate) above_ground_m: f64,
    /// Length, width, height, m.
    pub(crate) size_m: [f64; 3],
}

/// In the load bay and on the rear seats, near the rear axle: the rear axle then carries its permitted 1,850 kg.
const fn bay(mass_kg: f64) -> Cargo {
    Cargo {
        mass_kg,
        behind_front_axle_m: 2.55,
        above_ground_m: 1.05,
        size_m: [1.6, 1.3, 0.6],
    }
}

const ROOF: Cargo = Cargo {
    mass_kg: 150.0,
    behind_front_axle_m: 1.80,
    above_ground_m: 2.20,
    size_m: [2.0, 1.3, 0.3],
};

impl Load {
    /// Name in files and on the command line: `as-sold`, `laden`, `roof` or `laden-roof`.
    pub fn key(self) -> &'static str {
        self.into()
    }

    fn cargo(self) -> &'static [Cargo] {
        match self {
            Self::AsSold => &[],
            Self::Laden => const { &[bay(900.0)] },
            Self::Roof => const { &[ROOF] },
            Self::LadenRoof => const { &[bay(750.0), ROOF] },
        }
    }

    /// The vehicle with this load at its ride height: on struts that are charged for it.
    pub fn at_ride_height(self, vehicle: &VehicleParameters) -> VehicleParameters {
        let mut loaded = vehicle.clone();
        for cargo in self.cargo() {
            put(&mut loaded, cargo);
        }
        if self != Self::AsSold {
            loaded.name = format!("{}, {}", vehicle.name, self.key());
        }
        loaded
    }

    /// The vehicle with this load on its coil springs, which it compresses further. Axles, tyres and roll centres keep their
    /// heights.
    pub fn on_coil_springs(self, vehicle: &VehicleParameters) -> VehicleParameters {
        let loaded = self.at_ride_height(vehicle);
        let (before, now) = (vehicle.static_strut_load_n(), loaded.static_strut_load_n());
        let sinks_m = |axle: Axle| {
            let ([now_n, _], [before_n, _]) = (now.of_axle(axle), before.of_axle(axle));
            (now_n - before_n) / vehicle.baseline(axle).coil_stiffness_n_m
        };
        let (front_m, rear_m) = (sinks_m(Axle::Front), sinks_m(Axle::Rear));
        let mut loaded = loaded.raised(Axles::new(-front_m, -rear_m));
        for (baseline, sinks_m) in [
            (&mut loaded.front_baseline, front_m),
            (&mut loaded.rear_baseline, rear_m),
        ] {
            // A coil that is compressed to its stop carries the rest on it.
            baseline.bump_clearance_m = (baseline.bump_clearance_m - sinks_m).max(0.0);
            baseline.rebound_clearance_m += sinks_m;
        }
        loaded
    }
}

/// Adds a box to the body; a negative mass takes it away. The product of inertia that a load off the centre makes is left out:
/// the model's principal axes lie along and across the body.
pub(crate) fn put(vehicle: &mut VehicleParameters, cargo: &Cargo) {
    let wheelbase_m = vehicle.layout.wheelbase_m;
    let total_kg = vehicle.total_mass_kg();
    let body = &vehicle.body;
    let m = cargo.mass_kg;
    let ahead_m = cargo.behind_front_axle_m - vehicle.body_cg_behind_front_axle_m();
    let up_m = cargo.above_ground_m - vehicle.body_cg_height_m();
    let reduced_kg = body.sprung_mass_kg * m / (body.sprung_mass_kg + m);
    let [length, width, height] = cargo.size_m.map(|side| side * side * m / 12.0);
    let vehicle_cg_height_m = (total_kg * body.vehicle_cg_height_m + m * cargo.above_ground_m) / (total_kg + m);
    let behind_m =
        (total_kg * wheelbase_m * (1.0 - body.front_mass_share) + m * cargo.behind_front_axle_m) / (total_kg + m);
    let body = &mut vehicle.body;
    body.sprung_mass_kg += m;
    body.roll_inertia_kg_m2 += reduced_kg * up_m * up_m + width + height;
    body.pitch_inertia_kg_m2 += reduced_kg * (ahead_m * ahead_m + up_m * up_m) + length + height;
    body.yaw_inertia_kg_m2 += reduced_kg * ahead_m * ahead_m + length + width;
    body.vehicle_cg_height_m = vehicle_cg_height_m;
    body.front_mass_share = 1.0 - behind_m / wheelbase_m;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicle::GRAVITY_M_S2;

    /// Weight on an axle at rest, N.
    fn axle_load_n(vehicle: &VehicleParameters, axle: Axle) -> f64 {
        let load = vehicle.static_wheel_load_n();
        load.of_axle(axle).into_iter().sum()
    }

    #[test]
    fn names_are_read_back() {
        for load in Load::VARIANTS {
            assert_eq!(load.key().parse::<Load>(), Ok(*load));
        }
    }

    /// Masses and moments about the front axle and the ground, summed here one by one.
    #[test]
    fn masses_and_moments_add() {
        let empty = VehicleParameters::defender110();
        let laden = Load::LadenRoof.at_ride_height(&empty);
        assert!((laden.total_mass_kg() - 2950.0).abs() < 1e-9);
        let rear_n = axle_load_n(&empty, Axle::Rear) + GRAVITY_M_S2 * (750.0 * 2.55 + 150.0 * 1.80) / 2.794;
        assert!((axle_load_n(&laden, Axle::Rear) - rear_n).abs() < 1e-6);
        let height = (2050.0 * 0.75 + 750.0 * 1.05 + 150.0 * 2.20) / 2950.0;
        assert!((laden.body.vehicle_cg_height_m - height).abs() < 1e-12);
        let rear_kg = axle_load_n(&Load::Laden.at_ride_height(&empty), Axle::Rear) / GRAVITY_M_S2;
        assert!(
            (1800.0..1900.0).contains(&rear_kg),
            "permitted rear axle load is 1,850 kg, here {rear_kg}"
        );
    }

    /// Inertia about a fixed point, the foot of the front axle, is a sum that needs no parallel axis of the whole.
    #[test]
    fn inertias_add_about_a_fixed_point() {
        let empty = VehicleParameters::defender110();
        let about = |v: &VehicleParameters| {
            let (m, x, z) = (
                v.body.sprung_mass_kg,
                v.body_cg_behind_front_axle_m(),
                v.body_cg_height_m(),
            );
            [
                v.body.roll_inertia_kg_m2 + m * z * z,
                v.body.pitch_inertia_kg_m2 + m * (x * x + z * z),
                v.body.yaw_inertia_kg_m2 + m * x * x,
            ]
        };
        let loaded = about(&Load::Roof.at_ride_height(&empty));
        let (m, x, z): (f64, f64, f64) = (150.0, 1.80, 2.20);
        let box_of = |a: f64, b: f64| m * (a * a + b * b) / 12.0;
        let expected = [
            m * z * z + box_of(1.3, 0.3),
            m * (x * x + z * z) + box_of(2.0, 0.3),
            m * x * x + box_of(2.0, 1.3),
        ];
        for ((loaded, empty), expected) in loaded.iter().zip(about(&empty)).zip(expected) {
            assert!((loaded - empty - expected).abs() < 1e-6, "{loaded} {empty} {expected}");
        }
    }

    #[test]
    fn a_load_on_coils_sinks_by_its_weight_over_their_rate() {
        let empty = VehicleParameters::defender110();
        let (level, sunk) = (Load::Laden.at_ride_height(&empty), Load::Laden.on_coil_springs(&empty));
        let added_n = axle_load_n(&level, Axle::Rear) - axle_load_n(&empty, Axle::Rear);
        let sinks_m = empty.rear_baseline.bump_clearance_m - sunk.rear_baseline.bump_clearance_m;
        assert!((sinks_m - 0.5 * added_n / 55_000.0).abs() < 1e-12 && sinks_m > 0.05);
        assert!(sunk.body_cg_height_m() < level.body_cg_height_m());
        assert_eq!(Load::AsSold.on_coil_springs(&empty), empty);
    }
}
