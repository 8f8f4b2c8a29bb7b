//! Cases in which everything is drawn: effects or wrong numbers, corners, sizes, roads, speeds, strategies, and when commands act.

use oleo_controller::Strategy;
use oleo_diagnose::effect::unlisted::variants_of_believed_numbers;
use oleo_diagnose::effect::{StrutEffect, of};
use oleo_diagnose::selftest::Draw;
use oleo_diagnose::vocabulary::EffectId;
use oleo_hil::Scenario;
use oleo_interface::Corner;
use oleo_interface::tick::TICK_S;
use oleo_plant_sim::course::ManoeuvreKind;
use oleo_plant_sim::strut::StrutModel;

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
/// Roads that are drawn from, each with the fastest drive on it, m/s.
const ROADS: [(&str, f64); 4] = [("iso-c", 20.0), ("iso-d", 16.0), ("iso-e", 9.0), ("belgian", 14.0)];
/// Shortest and longest log, s.
const DURATION_S: (f64, f64) = (18.0, 40.0);
/// Slowest drive, m/s.
const SLOWEST_M_S: f64 = 6.0;

/// Times after the start at which a log may begin that does not begin at rest, s.
const MOTION_S: (f64, f64) = (2.0, 60.0);

/// Numbers that are not made wrong: the friction of the seal acts on the force alone, and the simulated vehicle charges its struts for the load that they carry,
/// so that a wrong static pressure is none and with a wrong bore both are.
const NOT_MADE_WRONG: [&str; 3] = ["coulomb_force_N", "static_pressure_Pa", "bore_m"];
/// Smallest amount of a wrong number; at the largest, 1, it is 1.6 times, or 1/1.6 of, what is believed.
const LEAST_WRONG: f64 = 0.03;

/// The case of a seed, whose logs begin in motion or at rest.
pub fn case(seed: u64, in_motion: bool) -> Case {
    let mut draw = Draw::named(&format!("drawn vehicle {seed}"));
    let concealed = effects(&mut draw);
    driven(seed, concealed, in_motion, &mut draw)
}

/// The case of a seed in which one number of one strut's model is another than believed.
pub fn wrong_number(seed: u64, in_motion: bool) -> Case {
    let mut draw = Draw::named(&format!("wrong number of a vehicle {seed}"));
    let variants = variants_of_believed_numbers();
    let concealed = loop {
        let concealed = Concealed {
            id: EffectId::Unlisted,
            variant: variants.start + draw.index(variants.len()),
            amount: libm::pow(LEAST_WRONG, draw.uniform()),
            sign: sign(&mut draw),
            shape: [0.5; 4],
            corners: vec![Corner::ALL[draw.index(4)]],
        };
        let truth = concealed.put(&mut StrutModel::defender110(8000.0));
        if truth
            .iter()
            .all(|number| !NOT_MADE_WRONG.contains(&number.key.as_str()))
        {
            break concealed;
        }
    };
    driven(seed, vec![concealed], in_motion, &mut draw)
}

/// None, one or two effects.
fn effects(draw: &mut Draw) -> Vec<Concealed> {
    let number = match draw.uniform() {
        u if u < 0.1 => 0,
        u if u < 0.6 => 1,
        _ => 2,
    };
    let mut concealed: Vec<Concealed> = Vec::new();
    while concealed.len() < number {
        let drawn = effect(draw);
        let column = |c: &Concealed| of(c.id).in_strut().and_then(|e| e.faulty_column(c.variant));
        let clash = |other: &Concealed| {
            other.corners.iter().any(|corner| drawn.corners.contains(corner))
                && (other.id == drawn.id || (column(other).is_some() && column(other) == column(&drawn)))
        };
        if !concealed.iter().any(clash) {
            concealed.push(drawn);
        }
    }
    concealed
}

fn driven(seed: u64, concealed: Vec<Concealed>, in_motion: bool, draw: &mut Draw) -> Case {
    let begins_s = if in_motion {
        draw.between(MOTION_S.0, MOTION_S.1)
    } else {
        0.0
    };
    let drives = (drives(seed, DURATION_S.0).into_iter())
        .map(|(name, scenario)| (name, varied(scenario, begins_s, draw)))
        .collect();
    Case {
        seed,
        concealed,
        drives,
        first_edition: draw.uniform() < 0.5,
        command_acts_late: draw.uniform() < 0.25,
        keeps_oil: !seed.is_multiple_of(2),
        begins_s,
        without_noise: false,
    }
}

fn effect(draw: &mut Draw) -> Concealed {
    let id = VISIBLE[draw.index(VISIBLE.len())];
    let effect = of(id).in_strut().expect("an effect of struts");
    let variant = recorded_variant(effect, draw);
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
        sign: sign(draw),
        shape: std::array::from_fn(|_| draw.uniform()),
        corners,
    }
}

fn sign(draw: &mut Draw) -> f64 {
    if draw.uniform() < 0.5 { -1.0 } else { 1.0 }
}

/// A variant that is not of the load cell, which no vehicle has.
fn recorded_variant(effect: &dyn StrutEffect, draw: &mut Draw) -> usize {
    loop {
        let variant = draw.index(effect.variants());
        if effect.faulty_column(variant) != Some("force_N") {
            return variant;
        }
    }
}

/// The drive with another duration, so long that its log may begin in motion, and with another road and speed where it goes straight ahead.
fn varied(scenario: Scenario, begins_s: f64, draw: &mut Draw) -> Scenario {
    let ticks = ((begins_s + draw.between(DURATION_S.0, DURATION_S.1)) / TICK_S) as u32;
    let (road, fastest_m_s) = ROADS[draw.index(ROADS.len())];
    let speed_m_s = draw.between(SLOWEST_M_S, fastest_m_s);
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
