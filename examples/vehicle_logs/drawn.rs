//! Cases in which everything is drawn: effects, corners, sizes, roads, speeds, strategies, and when commands act.

use oleo_controller::Strategy;
use oleo_diagnose::effect::of;
use oleo_diagnose::selftest::Draw;
use oleo_diagnose::vocabulary::EffectId;
use oleo_hil::Scenario;
use oleo_interface::Corner;
use oleo_interface::tick::TICK_S;
use oleo_plant_sim::course::ManoeuvreKind;

use crate::vehicle_campaign::{Case, Concealed, drives};

/// Effects that pressures and displacement can show.
const VISIBLE: [EffectId; 17] = [
    EffectId::OilCompressibility,
    EffectId::EntrainedAir,
    EffectId::GasHeatTransfer,
    EffectId::RealGas,
    EffectId::GasChargeError,
    EffectId::AccumulatorPistonFriction,
    EffectId::DamperLeakage,
    EffectId::LineResistance,
    EffectId::LineInertance,
    EffectId::ValveDelay,
    EffectId::ValveTransition,
    EffectId::Valve3Leakage,
    EffectId::DampingFade,
    EffectId::SensorLag,
    EffectId::SensorGain,
    EffectId::SensorDrift,
    EffectId::SensorSkew,
];
/// Part of the largest amount from which amounts are drawn, evenly in their logarithm.
const SMALLEST_PART: f64 = 3e-3;
/// Roads that are drawn from.
const ROADS: [&str; 4] = ["iso-c", "iso-d", "iso-e", "belgian"];
/// Shortest and longest drive, s.
const DURATION_S: (f64, f64) = (18.0, 40.0);
/// Slowest and fastest drive, m/s.
const SPEED_M_S: (f64, f64) = (8.0, 20.0);

/// The case of a seed.
pub fn case(seed: u64) -> Case {
    let mut draw = Draw::named(&format!("drawn vehicle {seed}"));
    let number = match draw.uniform() {
        u if u < 0.1 => 0,
        u if u < 0.6 => 1,
        _ => 2,
    };
    let mut concealed: Vec<Concealed> = Vec::new();
    while concealed.len() < number {
        let drawn = effect(&mut draw);
        let column = |c: &Concealed| of(c.id).in_strut().and_then(|e| e.faulty_column(c.variant));
        let clash = |other: &Concealed| {
            other.corners.iter().any(|corner| drawn.corners.contains(corner))
                && (other.id == drawn.id || (column(other).is_some() && column(other) == column(&drawn)))
        };
        if !concealed.iter().any(clash) {
            concealed.push(drawn);
        }
    }
    let drives = (drives(seed, DURATION_S.0).into_iter())
        .map(|(name, scenario)| (name, varied(scenario, &mut draw)))
        .collect();
    Case {
        seed,
        concealed,
        drives,
        first_edition: draw.uniform() < 0.5,
        command_acts_late: draw.uniform() < 0.25,
    }
}

fn effect(draw: &mut Draw) -> Concealed {
    let id = VISIBLE[draw.index(VISIBLE.len())];
    let effect = of(id).in_strut().expect("an effect of struts");
    // The displacement's own instrument shows only through what it does to the pressures.
    let variant = draw.index(effect.variants());
    let amount = effect.amounts(variant).map_or(1.0, |(low, high)| {
        let low = low.max(SMALLEST_PART * high);
        low * libm::pow(high / low, draw.uniform())
    });
    let shared = matches!(
        id,
        EffectId::OilCompressibility | EffectId::EntrainedAir | EffectId::GasHeatTransfer | EffectId::RealGas
    );
    let corners = if shared && draw.uniform() < 0.6 {
        Corner::ALL.to_vec()
    } else {
        vec![Corner::ALL[draw.index(4)]]
    };
    Concealed {
        id,
        variant,
        amount,
        sign: if draw.uniform() < 0.5 { -1.0 } else { 1.0 },
        shape: std::array::from_fn(|_| draw.uniform()),
        corners,
    }
}

/// The drive with another duration, and with another road and speed where it goes straight ahead.
fn varied(scenario: Scenario, draw: &mut Draw) -> Scenario {
    let ticks = (draw.between(DURATION_S.0, DURATION_S.1) / TICK_S) as u32;
    let (road, speed_m_s) = (ROADS[draw.index(ROADS.len())], draw.between(SPEED_M_S.0, SPEED_M_S.1));
    let strategies = [Strategy::RideHandling, Strategy::default()];
    let strategy = strategies[draw.index(strategies.len())];
    let straight = (scenario.course.as_ref()).is_none_or(|course| course.kind == ManoeuvreKind::Straight);
    if straight {
        Scenario {
            ticks,
            road: road.into(),
            speed_m_s,
            strategy,
            ..scenario
        }
    } else {
        Scenario { ticks, ..scenario }
    }
}
