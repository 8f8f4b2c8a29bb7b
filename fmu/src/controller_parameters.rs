//! What a controller is told before it starts, as parameters: its strategy, and what it knows of the vehicle.

use oleo_controller::{Builder, Configuration, Strategy, VehicleDescription};
use oleo_plant_sim::model_file::Range;
use serde::{Deserialize, Serialize};

use crate::complaint::Complaint;
use crate::variable::{Role, Variable, Word};

/// The words of [`Strategy`], in the order of the numbers here.
const STRATEGIES: [Word; 6] = [
    ("always-soft", "all valves open, for comparison"),
    ("always-stiff", "all valves closed, for comparison"),
    ("ride-handling", "ride mode or handling mode by running RMS"),
    (
        "road-and-cornering",
        "stiff on a smooth road and as soon as the vehicle corners; low damping by the road else",
    ),
    (
        "road-and-dampers",
        "as road-and-cornering, but a rule of the literature switches the dampers on a rough road",
    ),
    (
        "predictive",
        "as road-and-cornering, but a forecast sets the rear dampers where the body heaves",
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

/// The parameters of a controller of a vehicle, in the order of their places.
pub fn variables(mut vehicle: VehicleDescription) -> Vec<Variable> {
    let strategy = place_of(Strategy::default());
    let mut variables = vec![Variable::word(
        "strategy",
        "Strategy",
        &STRATEGIES,
        Role::Fixed,
        strategy,
        "how valves are decided",
    )];
    variables.extend(NUMBERS.iter().map(|(name, unit, range, what, place)| {
        let start = f64::from(*place(&mut vehicle));
        Variable::parameter(*name, unit, *what, Role::Fixed, *range, start)
    }));
    variables
}

/// The configuration of the values of the parameters.
///
/// # Errors
/// A controller cannot have these values.
pub fn configuration(values: &[f64]) -> Result<Configuration, Complaint> {
    let missing = || Complaint::new("parameters of the controller are missing: give all of them");
    let mut vehicle = VehicleDescription::default();
    let (strategy, numbers) = values.split_first().ok_or_else(missing)?;
    for ((.., place), number) in NUMBERS.iter().zip(numbers) {
        *place(&mut vehicle) = *number as f32;
    }
    let (name, _) = STRATEGIES.get(*strategy as usize).ok_or_else(missing)?;
    let strategy = name.parse().map_err(Complaint::new)?;
    let builder = Builder {
        vehicle,
        strategy,
        ..Builder::default()
    };
    builder.build().map_err(Complaint::new)
}

/// Place of a strategy in the list of words.
fn place_of(strategy: Strategy) -> usize {
    STRATEGIES
        .iter()
        .position(|(name, _)| *name == strategy.name())
        .unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use strum::VariantArray;

    use super::*;

    /// A strategy that is added to the controller is to be added here.
    #[test]
    fn the_words_are_those_of_the_controller() {
        let words: Vec<&str> = STRATEGIES.iter().map(|word| word.0).collect();
        let strategies: Vec<&str> = Strategy::VARIANTS.iter().map(|strategy| strategy.name()).collect();
        assert_eq!(words, strategies);
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
