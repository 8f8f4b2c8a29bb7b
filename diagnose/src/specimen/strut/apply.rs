//! A candidate's numbers into the model file's terms.

use oleo_plant_sim::strut::{
    AccumulatorPistonFriction, BumpStop, DamperLeakage, DampingFade, Effects, EntrainedAir, GasChargeError,
    GasEquation, GasHeatTransfer, LineInertance, LineResistance, MountCompliance, OilCompressibility, OilCount,
    RealGas, SealFriction, SideLoadFriction, TransitionShape, Valve3Leakage, ValveDelay, ValveTransition,
};

use super::laws;
use crate::specimen::candidate::Candidate;
use crate::vocabulary::{Branch, EffectId};

/// Presliding stiffness of the seal, N/m (recordings README).
const PRESLIDING_STIFFNESS_N_M: f64 = 2e6;

/// Puts a candidate with its parameters' values into a model. Values as in `vocabulary`.
pub fn apply(effects: &mut Effects, candidate: &Candidate, v: &[f64]) {
    let column = || candidate.place.sensor().map_or_else(String::new, ToString::to_string);
    let second = candidate.place.branch() == Some(Branch::Second);
    match candidate.id {
        EffectId::OilCompressibility => {
            effects.oil_compressibility = Some(OilCompressibility {
                bulk_modulus_pa: 1.0 / v[0].max(1e-13),
                counted_at: OilCount::default(),
            })
        }
        EffectId::EntrainedAir => {
            effects.entrained_air = Some(EntrainedAir {
                volume_fraction: v[0],
                polytropic_exponent: v[1],
            });
        }
        EffectId::GasHeatTransfer => {
            effects.gas_heat_transfer = Some(GasHeatTransfer {
                time_constant_1_s: v[0],
                time_constant_2_s: v[1],
            });
        }
        EffectId::RealGas => {
            effects.real_gas = Some(RealGas {
                equation: GasEquation::Reference,
            })
        }
        EffectId::GasChargeError => {
            let none = GasChargeError {
                relative_error_1: 0.0,
                relative_error_2: 0.0,
            };
            let term = effects.gas_charge_error.get_or_insert(none);
            *(if second {
                &mut term.relative_error_2
            } else {
                &mut term.relative_error_1
            }) = v[0];
        }
        EffectId::SealFriction => {
            effects.seal_friction = Some(SealFriction {
                coulomb_force_n: v[0],
                breakaway_force_n: v[0] * v[1],
                stribeck_speed_m_s: v[2],
                presliding_stiffness_n_m: PRESLIDING_STIFFNESS_N_M,
            });
        }
        EffectId::SideLoadFriction => {
            effects.side_load_friction = Some(SideLoadFriction {
                coefficient: v[0],
                overlap_growth_1_m: v[1],
            });
        }
        EffectId::AccumulatorPistonFriction => {
            let none = AccumulatorPistonFriction {
                pressure_1_pa: 0.0,
                pressure_2_pa: 0.0,
                presliding_volume_m3: v[1],
            };
            let term = effects.accumulator_piston_friction.get_or_insert(none);
            term.presliding_volume_m3 = v[1];
            *(if second {
                &mut term.pressure_2_pa
            } else {
                &mut term.pressure_1_pa
            }) = v[0];
        }
        EffectId::DamperLeakage => {
            let none = DamperLeakage {
                flow_coefficient_1: 0.0,
                flow_coefficient_2: 0.0,
            };
            let term = effects.damper_leakage.get_or_insert(none);
            *(if second {
                &mut term.flow_coefficient_2
            } else {
                &mut term.flow_coefficient_1
            }) = v[0];
        }
        EffectId::LineResistance => {
            let none = LineResistance {
                resistance_1_pa_s_m3: 0.0,
                resistance_2_pa_s_m3: 0.0,
            };
            let term = effects.line_resistance.get_or_insert(none);
            *(if second {
                &mut term.resistance_2_pa_s_m3
            } else {
                &mut term.resistance_1_pa_s_m3
            }) = v[0];
        }
        EffectId::LineInertance => {
            effects.line_inertance = Some(LineInertance {
                inertance_2_kg_m4: v[0],
            })
        }
        EffectId::ValveDelay => {
            effects.valve_delay = Some(ValveDelay {
                response_polynomial_s: [v[0], v[1], v[2]],
            })
        }
        EffectId::ValveTransition => {
            effects.valve_transition = Some(ValveTransition {
                shape: TransitionShape::Linear,
            })
        }
        EffectId::Valve3Leakage => effects.valve3_leakage = Some(Valve3Leakage { flow_coefficient: v[0] }),
        EffectId::BumpStop => {
            let far = 10.0;
            let none = BumpStop {
                bump_clearance_m: far,
                rebound_clearance_m: far,
                stiffness_n_m: 0.0,
                progression_n_m3: 0.0,
            };
            let term = effects.bump_stop.get_or_insert(none);
            term.bump_clearance_m = v[0];
            term.rebound_clearance_m = v[1];
            term.stiffness_n_m = v[2];
            term.progression_n_m3 = v[3];
        }
        EffectId::MountCompliance => {
            effects.mount_compliance = Some(MountCompliance {
                stiffness_n_m: 1.0 / v[0].max(1e-15),
            })
        }
        EffectId::DampingFade => {
            let (f1, f2, tau) = match candidate.place.branch() {
                Some(Branch::First) => (v[0], 0.0, v[1]),
                Some(Branch::Second) => (0.0, v[0], v[1]),
                None => (v[0], v[1], v[2]),
            };
            effects.damping_fade = Some(DampingFade {
                fade_1_per_j: f1,
                fade_2_per_j: f2,
                cooling_time_s: tau,
            });
        }
        EffectId::SensorLag => _ = effects.sensor_lag.get_or_insert_default().insert(column(), v[0]),
        EffectId::SensorSkew => _ = effects.sensor_skew.get_or_insert_default().insert(column(), v[0]),
        EffectId::SensorGain => _ = effects.sensor_gain.get_or_insert_default().insert(column(), v[0]),
        EffectId::SensorDrift => _ = effects.sensor_drift.get_or_insert_default().insert(column(), v[0]),
        EffectId::SensorSign => _ = effects.sensor_sign.get_or_insert_default().insert(column(), -1.0),
        EffectId::Unlisted => effects.unlisted.extend(laws::law(&candidate.label, v)),
        // What only dampers and drives have is no candidate of a strut.
        EffectId::CoulombFriction
        | EffectId::StribeckFriction
        | EffectId::PreslidingFriction
        | EffectId::SmoothYield
        | EffectId::ForceOffset
        | EffectId::Stiffness
        | EffectId::GasSpring
        | EffectId::Backlash
        | EffectId::Inertia => {}
    }
}
