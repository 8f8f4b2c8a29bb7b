//! Cases of one effect each, with a size that is easily seen.

use oleo_diagnose::vocabulary::EffectId;
use oleo_interface::Corner;

use crate::vehicle_campaign::{Case, Concealed, drives};

/// Length of each of the three drives of a campaign, s.
const DURATION_S: f64 = 24.0;

/// Effect, variant and amount, as the effect's own self-test counts them; `None` of a healthy vehicle.
type Altered = Option<(EffectId, usize, f64)>;

/// Name of a case, what it conceals, and whether all four corners have it.
const CASES: [(&str, Altered, bool); 16] = [
    ("healthy", None, false),
    ("gas_heat_transfer", Some((EffectId::GasHeatTransfer, 0, 3.0)), false),
    ("gas_charge_error_1", Some((EffectId::GasChargeError, 0, 0.08)), false),
    ("gas_charge_error_2", Some((EffectId::GasChargeError, 1, 0.08)), false),
    ("valve3_leakage", Some((EffectId::Valve3Leakage, 0, 2e-8)), false),
    ("damper_leakage_1", Some((EffectId::DamperLeakage, 0, 2e-7)), false),
    ("damper_leakage_2", Some((EffectId::DamperLeakage, 1, 2e-7)), false),
    (
        "accumulator_piston_friction_1",
        Some((EffectId::AccumulatorPistonFriction, 0, 4e4)),
        false,
    ),
    (
        "accumulator_piston_friction_2",
        Some((EffectId::AccumulatorPistonFriction, 1, 4e4)),
        false,
    ),
    ("seal_friction", Some((EffectId::SealFriction, 0, 200.0)), false),
    (
        "oil_compressibility_all",
        Some((EffectId::OilCompressibility, 0, 1.0 / 1.4e9)),
        true,
    ),
    ("gas_heat_transfer_all", Some((EffectId::GasHeatTransfer, 0, 3.0)), true),
    ("real_gas_all", Some((EffectId::RealGas, 0, 1.0)), true),
    ("sensor_gain_p2", Some((EffectId::SensorGain, 3, 0.03)), false),
    ("sensor_lag_p1", Some((EffectId::SensorLag, 2, 0.01)), false),
    ("sensor_lag_p4", Some((EffectId::SensorLag, 5, 0.02)), false),
];

/// The cases of a seed with their names; those that are wanted, or all.
pub fn cases(seed: u64, wanted: &[String]) -> Vec<(String, Case)> {
    (CASES.iter().enumerate())
        .filter(|(_, (name, ..))| wanted.is_empty() || wanted.iter().any(|w| w == name))
        .map(|(k, (name, effect, everywhere))| {
            let seed = 1000 * seed + k as u64;
            let corners = if *everywhere {
                Corner::ALL.to_vec()
            } else {
                vec![Corner::ALL[(seed % 4) as usize]]
            };
            let concealed = effect.map(|(id, variant, amount)| Concealed::new(id, variant, amount, corners));
            let case = Case {
                seed,
                concealed: concealed.into_iter().collect(),
                drives: drives(seed, DURATION_S),
                first_edition: seed % 2 == 1,
                command_acts_late: false,
                keeps_oil: false,
                begins_s: 0.0,
                without_noise: false,
            };
            (format!("{name}-{seed}"), case)
        })
        .collect()
}
