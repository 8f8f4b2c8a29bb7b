//! The vocabulary of the recordings as candidates: id, place, parameters with ranges, and when recordings cannot show it.
//!
//! A term that the model already has is not a candidate; its numbers are calibration.

use oleo_interface::Valve;
use oleo_plant_sim::strut::{COLUMNS, StrutModel};

use super::channels::CHANNELS;
use super::excitation::Excitation;
use super::laws;
use crate::parameter::Parameter;
use crate::specimen::candidate::{Candidate, ExclusionGroup};
use crate::specimen::instrument;
use crate::vocabulary::{Branch, Column, EffectId, Site};

/// Ids of the vocabulary, and of what has no name in it.
pub const TERMS: [EffectId; 23] = [
    EffectId::OilCompressibility,
    EffectId::EntrainedAir,
    EffectId::GasHeatTransfer,
    EffectId::RealGas,
    EffectId::GasChargeError,
    EffectId::SealFriction,
    EffectId::SideLoadFriction,
    EffectId::AccumulatorPistonFriction,
    EffectId::DamperLeakage,
    EffectId::LineResistance,
    EffectId::LineInertance,
    EffectId::ValveDelay,
    EffectId::ValveTransition,
    EffectId::Valve3Leakage,
    EffectId::BumpStop,
    EffectId::MountCompliance,
    EffectId::DampingFade,
    EffectId::SensorLag,
    EffectId::SensorGain,
    EffectId::SensorDrift,
    EffectId::SensorSkew,
    EffectId::SensorSign,
    EffectId::Unlisted,
];

/// Everything that may be missing from `model`.
#[must_use]
pub fn candidates(model: &StrutModel, excitation: &Excitation) -> Vec<Candidate> {
    let e = &model.effects;
    let mut all = Vec::new();
    let still = (!excitation.moves).then(|| "the strut does not move; record moves of at least 10 mm".to_owned());
    let mut add =
        |id: EffectId, site: Site, parameters: Vec<Parameter>, starts: Vec<Vec<f64>>, cannot: Option<String>| {
            all.push(Candidate {
                id,
                place: site.into(),
                label: String::new(),
                parameters,
                starts,
                group: (id == EffectId::DampingFade).then_some(ExclusionGroup::DampingFade),
                untestable: still.clone().or(cannot),
            });
        };
    if e.oil_compressibility.is_none() {
        add(
            EffectId::OilCompressibility,
            Site::MainChamber,
            vec![Parameter::amount("compressibility_1_Pa", 1e-10, 2e-8).shown_as_inverse("bulk_modulus_Pa")],
            vec![],
            None,
        );
    }
    if e.entrained_air.is_none() {
        let exponent = Parameter::linear("polytropic_exponent", 1.2, 0.1, (1.0, 1.4));
        add(
            EffectId::EntrainedAir,
            Site::MainChamber,
            vec![Parameter::amount("volume_fraction", 1e-3, 0.3), exponent],
            vec![vec![5e-3, 1.2]],
            None,
        );
    }
    if e.gas_heat_transfer.is_none() {
        let tau = |i: usize| Parameter::log(format!("time_constant_{i}_s"), 5.0, (0.02, 300.0));
        let shared = if excitation.valve3_holding_s > 0.0 {
            vec![vec![1.0, 1.5]]
        } else {
            vec![]
        };
        add(
            EffectId::GasHeatTransfer,
            Site::Accumulators,
            vec![tau(1), tau(2)],
            shared,
            None,
        );
    }
    if e.real_gas.is_none() {
        add(EffectId::RealGas, Site::Accumulators, vec![], vec![], None);
    }
    if e.gas_charge_error.is_none() {
        for branch in Branch::ALL {
            let i = branch.number();
            let error = Parameter::linear(format!("relative_error_{i}"), 0.0, 0.02, (-0.7, 2.0));
            add(
                EffectId::GasChargeError,
                Site::Accumulator(branch),
                vec![error],
                vec![],
                None,
            );
        }
    }
    if e.seal_friction.is_none() {
        let parameters = vec![
            Parameter::amount("coulomb_force_N", 20.0, 1e4),
            Parameter::linear("breakaway_over_coulomb", 1.3, 0.2, (1.0, 4.0)),
            Parameter::log("stribeck_speed_m_s", 0.02, (1e-3, 0.5)),
        ];
        add(EffectId::SealFriction, Site::MainSeal, parameters, vec![], None);
    }
    if e.side_load_friction.is_none() {
        add(
            EffectId::SideLoadFriction,
            Site::MainSeal,
            vec![
                Parameter::amount("coefficient", 0.003, 0.5),
                Parameter::linear("overlap_growth_1_m", 0.0, 1.0, (-4.0, 6.0)),
            ],
            vec![],
            None,
        );
    }
    if e.accumulator_piston_friction.is_none() {
        for branch in Branch::ALL {
            let i = branch.number();
            let pressure = Parameter::amount(format!("pressure_{i}_Pa"), 1e4, 3e6);
            add(
                EffectId::AccumulatorPistonFriction,
                Site::Accumulator(branch),
                vec![pressure, Parameter::log("presliding_volume_m3", 3e-7, (1e-8, 2e-5))],
                vec![vec![1e5, 5e-7]],
                None,
            );
        }
    }
    if e.damper_leakage.is_none() {
        for branch in Branch::ALL {
            let i = branch.number();
            let leak = Parameter::amount(format!("flow_coefficient_{i}"), 1e-8, 1e-5);
            add(
                EffectId::DamperLeakage,
                Site::Path(branch),
                vec![leak],
                vec![],
                slow(excitation, i),
            );
        }
    }
    if e.line_resistance.is_none() {
        for branch in Branch::ALL {
            let i = branch.number();
            let resistance = Parameter::amount(format!("resistance_{i}_Pa_s_m3"), 3e7, 1e11);
            add(
                EffectId::LineResistance,
                Site::Path(branch),
                vec![resistance],
                vec![],
                slow(excitation, i),
            );
        }
    }
    if e.line_inertance.is_none() {
        let inertance = Parameter::amount("inertance_2_kg_m4", 1e6, 1e9);
        add(
            EffectId::LineInertance,
            Site::Path(Branch::Second),
            vec![inertance],
            vec![],
            slow(excitation, 2),
        );
    }
    let switched = excitation.edges.iter().any(|&n| n > 0);
    let no_edges = (!switched).then(|| "no valve is switched; record steps at several pressure differences".to_owned());
    let polynomial = &model.valve_timing.response_polynomial_s;
    if e.valve_delay.is_none() && polynomial.iter().skip(1).all(|c| *c == 0.0) {
        let parameters = vec![
            Parameter::linear("c0_s", polynomial[0], 0.005, (0.0, 0.5)),
            Parameter::linear("c1_s_MPa", 0.0, 0.002, (-0.05, 0.05)),
            Parameter::linear("c2_s_MPa2", 0.0, 2e-4, (-0.005, 0.005)),
        ];
        add(EffectId::ValveDelay, Site::Valves, parameters, vec![], no_edges.clone());
    }
    if e.valve_transition.is_none() {
        add(EffectId::ValveTransition, Site::Valves, vec![], vec![], no_edges);
    }
    if e.valve3_leakage.is_none() {
        let cannot = (excitation.valve3_holding_s < 0.5).then(|| {
            "valve 3 is never closed against a pressure difference; close it at 30 mm of jounce and hold 5 s".to_owned()
        });
        add(
            EffectId::Valve3Leakage,
            Site::Valve(Valve::Spring),
            vec![Parameter::amount("flow_coefficient", 1e-10, 1e-6)],
            vec![],
            cannot,
        );
    }
    if e.bump_stop.is_none() {
        let (low, high) = excitation.displacement_m;
        let (low, high) = ((-low).max(1e-3), high.max(1e-3));
        let parameters = vec![
            Parameter::linear("bump_clearance_m", 0.85 * high, 0.05 * high, (0.2 * high, 1.2 * high)),
            Parameter::linear("rebound_clearance_m", 0.85 * low, 0.05 * low, (0.2 * low, 1.2 * low)),
            Parameter::amount("stiffness_N_m", 1e4, 1e8),
            Parameter::amount("progression_N_m3", 1e8, 1e13),
        ];
        let at = |a: f64, b: f64| vec![a * high, b * low, 0.0, 0.0];
        add(
            EffectId::BumpStop,
            Site::EndStop,
            parameters,
            vec![at(0.7, 0.7), at(0.5, 1.1), at(1.1, 0.5), at(0.6, 0.95)],
            None,
        );
    }
    if e.mount_compliance.is_none() {
        add(
            EffectId::MountCompliance,
            Site::Mount,
            vec![Parameter::amount("compliance_m_N", 1e-8, 1e-4).shown_as_inverse("stiffness_N_m")],
            vec![],
            None,
        );
    }
    if e.damping_fade.is_none() {
        let cooling = || Parameter::log("cooling_time_s", 60.0, (1.0, 1e5));
        let fade = |i: usize| Parameter::amount(format!("fade_{i}_per_J"), 1e-5, 1e-2);
        add(
            EffectId::DampingFade,
            Site::Path(Branch::First),
            vec![fade(1), cooling()],
            vec![],
            slow(excitation, 1),
        );
        add(
            EffectId::DampingFade,
            Site::Path(Branch::Second),
            vec![fade(2), cooling()],
            vec![],
            slow(excitation, 2),
        );
        let both = slow(excitation, 1).or(slow(excitation, 2));
        add(
            EffectId::DampingFade,
            Site::Paths,
            vec![fade(1), fade(2), cooling()],
            vec![],
            both,
        );
    }
    for (k, column) in COLUMNS.iter().enumerate() {
        let size = if k == 0 {
            (excitation.displacement_m.1 - excitation.displacement_m.0).max(1e-6)
        } else {
            excitation.departure[k - 1]
        };
        let mut faults = instrument::faults(
            &Column::known(column),
            size,
            excitation.duration_s,
            excitation.interval_s,
        );
        faults.push(Candidate {
            id: EffectId::SensorSign,
            parameters: vec![],
            ..faults[0].clone()
        });
        for mut fault in faults {
            if k == 0 {
                fault.parameters.iter_mut().for_each(|p| p.instrument_only = false);
            }
            fault.untestable.clone_from(&still);
            all.push(fault);
        }
    }
    debug_assert_eq!(CHANNELS[0], COLUMNS[1]);
    all.extend(laws::candidates(&still));
    all
}

/// Flow effects need a pressure drop to be seen.
fn slow(excitation: &Excitation, path: usize) -> Option<String> {
    (excitation.drop_pa[path - 1] < 1e5).then(|| {
        format!(
            "the drop across damper {path} never reaches 0.1 MPa; record sines above 0.2 m/s with valve {path} closed"
        )
    })
}
