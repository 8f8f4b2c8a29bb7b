//! What is concealed: every effect of the vocabulary at a drawn place, with an amount that can be scaled, so that power can
//! be asked for over the size of the effect; and laws that no vocabulary names.

use oleo_interface::Valve;
use oleo_plant_sim::strut::{
    AccumulatorPistonFriction, BumpStop, COLUMNS, DamperLeakage, DampingFade, EntrainedAir, GasChargeError,
    GasEquation, GasHeatTransfer, LawArgument, LawPlace, LineInertance, LineResistance, MountCompliance,
    OilCompressibility, OilCount, RealGas, SealFriction, SideLoadFriction, StrutModel, TransitionShape, UnlistedLaw,
    Valve3Leakage, ValveDelay, ValveTransition,
};
use serde::{Deserialize, Serialize};

use super::draw::Draw;
pub use crate::specimen::strut::TERMS;
use crate::vocabulary::{Branch, Column, EffectId, Place, Site};

/// A number of the truth, as the report would give it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// Id of the vocabulary.
    pub id: EffectId,
    /// Where it acts.
    pub place: Place,
    /// Key with unit, empty for an effect without numbers.
    pub key: String,
    /// Value.
    pub value: f64,
}

/// A concealed effect whose amount is still open.
#[derive(Debug, Clone)]
pub struct Hidden {
    /// Id of the vocabulary.
    pub id: EffectId,
    /// Smallest and largest amount; `None` for what is there or not.
    pub range: Option<(f64, f64)>,
    /// Which of several places, and the sign where both are possible.
    which: usize,
    sign: f64,
    /// Uniform numbers that shape the rest.
    shape: [f64; 4],
    /// Valve response of the complete model, s, s/MPa, s/MPa2.
    response: [f64; 3],
}

impl Hidden {
    /// Draws place and shape of an effect of a strut whose complete nominal model is given.
    #[must_use]
    pub fn draw(id: EffectId, complete: &StrutModel, draw: &mut Draw) -> Self {
        let c = &complete.valve_timing.response_polynomial_s;
        let places = match id {
            EffectId::GasChargeError
            | EffectId::AccumulatorPistonFriction
            | EffectId::DamperLeakage
            | EffectId::LineResistance => 2,
            EffectId::DampingFade | EffectId::BumpStop => 3,
            EffectId::Unlisted => LAWS.len(),
            id if id.is_instrument_fault() => COLUMNS.len(),
            _ => 1,
        };
        let which = draw.index(places);
        let column = if which == 0 { 0.05 } else { 5e6 };
        let range = match id {
            EffectId::RealGas | EffectId::ValveTransition | EffectId::SensorSign => None,
            EffectId::OilCompressibility => Some((1e-13, 1.0 / 0.8e9)),
            EffectId::EntrainedAir => Some((1e-6, 0.04)),
            // Faster gas is isothermal for all that a strut does (plant-sim: 0.5 to 20 s).
            EffectId::GasHeatTransfer => Some((0.5, 12.0)),
            EffectId::GasChargeError => Some((1e-4, 0.3)),
            EffectId::SealFriction => Some((0.3, 600.0)),
            EffectId::SideLoadFriction => Some((1e-5, 0.08)),
            EffectId::AccumulatorPistonFriction => Some((100.0, 5e5)),
            EffectId::DamperLeakage => Some((1e-11, 6e-7)),
            EffectId::LineResistance => Some((1e4, 3e9)),
            EffectId::LineInertance => Some((1e3, 2e7)),
            EffectId::ValveDelay => Some((1e-3, 4.0)),
            EffectId::Valve3Leakage => Some((1e-13, 5e-8)),
            EffectId::BumpStop => Some((100.0, 5e5)),
            EffectId::MountCompliance => Some((1e-10, 1e-6)),
            EffectId::DampingFade => Some((1e-8, 3e-4)),
            EffectId::SensorLag => Some((1e-6, 0.03)),
            EffectId::SensorSkew => Some((1e-6, 0.03)),
            EffectId::SensorGain => Some((1e-5, 0.2)),
            EffectId::SensorDrift => Some((1e-6 * column, 0.02 * column)),
            _ => Some((1e-5, 1.0)),
        };
        Self {
            id,
            range,
            which,
            sign: if draw.uniform() < 0.5 { -1.0 } else { 1.0 },
            shape: std::array::from_fn(|_| draw.uniform()),
            response: std::array::from_fn(|k| c.get(k).copied().unwrap_or(0.0)),
        }
    }

    /// Column of a faulty instrument.
    #[must_use]
    pub fn column(&self) -> Option<&'static str> {
        self.id.is_instrument_fault().then(|| COLUMNS[self.which])
    }

    /// Takes the effect out of what is believed, where the complete model has it.
    pub fn conceal(&self, given: &mut StrutModel) {
        match self.id {
            EffectId::OilCompressibility => given.effects.oil_compressibility = None,
            EffectId::GasHeatTransfer => given.effects.gas_heat_transfer = None,
            EffectId::ValveTransition => given.effects.valve_transition = None,
            EffectId::ValveDelay => given.valve_timing.response_polynomial_s.truncate(1),
            _ => {}
        }
    }

    /// Puts the effect into the true model and says the numbers that should be found; the first is its size.
    pub fn put(&self, model: &mut StrutModel, amount: f64) -> Vec<Truth> {
        let effects = &mut model.effects;
        let shape = |k: usize, low: f64, high: f64| low + (high - low) * self.shape[k];
        let number = |site: Site, key: &str, value: f64| Truth {
            id: self.id,
            place: site.into(),
            key: key.into(),
            value,
        };
        let i = self.which;
        let pick = |k: usize| if i == k { amount } else { 0.0 };
        let branch = if i == 0 { Branch::First } else { Branch::Second };
        let (accumulator, path) = (Site::Accumulator(branch), Site::Path(branch));
        match self.id {
            EffectId::OilCompressibility => {
                effects.oil_compressibility = Some(OilCompressibility {
                    bulk_modulus_pa: 1.0 / amount,
                    counted_at: OilCount::Chamber,
                });
                vec![number(Site::MainChamber, "bulk_modulus_Pa", 1.0 / amount)]
            }
            EffectId::EntrainedAir => {
                let exponent = shape(0, 1.0, 1.4);
                effects.entrained_air = Some(EntrainedAir {
                    volume_fraction: amount,
                    polytropic_exponent: exponent,
                });
                vec![
                    number(Site::MainChamber, "volume_fraction", amount),
                    number(Site::MainChamber, "polytropic_exponent", exponent),
                ]
            }
            EffectId::GasHeatTransfer => {
                let second = amount * shape(0, 1.4, 2.5);
                effects.gas_heat_transfer = Some(GasHeatTransfer {
                    time_constant_1_s: amount,
                    time_constant_2_s: second,
                });
                vec![
                    number(Site::Accumulator(Branch::First), "time_constant_1_s", amount),
                    number(Site::Accumulator(Branch::Second), "time_constant_2_s", second),
                ]
            }
            EffectId::RealGas => {
                effects.real_gas = Some(RealGas {
                    equation: GasEquation::Reference,
                });
                vec![number(Site::Accumulators, "", 0.0)]
            }
            EffectId::GasChargeError => {
                let error = self.sign * amount;
                effects.gas_charge_error = Some(GasChargeError {
                    relative_error_1: self.sign * pick(0),
                    relative_error_2: self.sign * pick(1),
                });
                vec![number(accumulator, &format!("relative_error_{}", i + 1), error)]
            }
            EffectId::SealFriction => {
                let (ratio, speed) = (shape(0, 1.0, 1.5), shape(1, 0.01, 0.05));
                effects.seal_friction = Some(SealFriction {
                    coulomb_force_n: amount,
                    breakaway_force_n: amount * ratio,
                    stribeck_speed_m_s: speed,
                    presliding_stiffness_n_m: 2e6,
                });
                vec![
                    number(Site::MainSeal, "coulomb_force_N", amount),
                    number(Site::MainSeal, "breakaway_over_coulomb", ratio),
                    number(Site::MainSeal, "stribeck_speed_m_s", speed),
                ]
            }
            EffectId::SideLoadFriction => {
                effects.side_load_friction = Some(SideLoadFriction {
                    coefficient: amount,
                    overlap_growth_1_m: 0.0,
                });
                vec![number(Site::MainSeal, "coefficient", amount)]
            }
            EffectId::AccumulatorPistonFriction => {
                let volume = libm::exp(shape(0, libm::log(1e-7), libm::log(2e-6)));
                effects.accumulator_piston_friction = Some(AccumulatorPistonFriction {
                    pressure_1_pa: pick(0),
                    pressure_2_pa: pick(1),
                    presliding_volume_m3: volume,
                });
                vec![
                    number(accumulator.clone(), &format!("pressure_{}_Pa", i + 1), amount),
                    number(accumulator, "presliding_volume_m3", volume),
                ]
            }
            EffectId::DamperLeakage => {
                effects.damper_leakage = Some(DamperLeakage {
                    flow_coefficient_1: pick(0),
                    flow_coefficient_2: pick(1),
                });
                vec![number(path, &format!("flow_coefficient_{}", i + 1), amount)]
            }
            EffectId::LineResistance => {
                effects.line_resistance = Some(LineResistance {
                    resistance_1_pa_s_m3: pick(0),
                    resistance_2_pa_s_m3: pick(1),
                });
                vec![number(path, &format!("resistance_{}_Pa_s_m3", i + 1), amount)]
            }
            EffectId::LineInertance => {
                effects.line_inertance = Some(LineInertance {
                    inertance_2_kg_m4: amount,
                });
                vec![number(Site::Path(Branch::Second), "inertance_2_kg_m4", amount)]
            }
            EffectId::ValveDelay => {
                let [constant, linear, square] = self.response;
                let polynomial = [constant, amount * linear, amount * square];
                effects.valve_delay = Some(ValveDelay {
                    response_polynomial_s: polynomial,
                });
                vec![
                    number(Site::Valves, "c1_s_MPa", polynomial[1]),
                    number(Site::Valves, "c0_s", polynomial[0]),
                    number(Site::Valves, "c2_s_MPa2", polynomial[2]),
                ]
            }
            EffectId::ValveTransition => {
                effects.valve_transition = Some(ValveTransition {
                    shape: TransitionShape::Linear,
                });
                vec![number(Site::Valves, "", 0.0)]
            }
            EffectId::Valve3Leakage => {
                effects.valve3_leakage = Some(Valve3Leakage {
                    flow_coefficient: amount,
                });
                vec![number(Site::Valve(Valve::Spring), "flow_coefficient", amount)]
            }
            EffectId::BumpStop => {
                // At the jounce end, at the rebound end, or both; all within the travel of the moves.
                let far = 1.0;
                let bump = if i == 1 { far } else { shape(0, 0.05, 0.075) };
                let rebound = if i == 0 { far } else { shape(1, 0.05, 0.075) };
                let progression = amount * shape(2, 0.0, 4e3);
                effects.bump_stop = Some(BumpStop {
                    bump_clearance_m: bump,
                    rebound_clearance_m: rebound,
                    stiffness_n_m: amount,
                    progression_n_m3: progression,
                });
                let mut all = vec![number(Site::EndStop, "stiffness_N_m", amount)];
                if i != 1 {
                    all.push(number(Site::EndStop, "bump_clearance_m", bump));
                }
                if i != 0 {
                    all.push(number(Site::EndStop, "rebound_clearance_m", rebound));
                }
                all.push(number(Site::EndStop, "progression_N_m3", progression));
                all
            }
            EffectId::MountCompliance => {
                effects.mount_compliance = Some(MountCompliance {
                    stiffness_n_m: 1.0 / amount,
                });
                vec![number(Site::Mount, "stiffness_N_m", 1.0 / amount)]
            }
            EffectId::DampingFade => {
                let first = if i == 1 { 0.0 } else { amount };
                let second = if i == 0 {
                    0.0
                } else {
                    amount * if i == 2 { shape(0, 0.7, 1.4) } else { 1.0 }
                };
                let cooling = shape(1, 30.0, 200.0);
                effects.damping_fade = Some(DampingFade {
                    fade_1_per_j: first,
                    fade_2_per_j: second,
                    cooling_time_s: cooling,
                });
                let mut all = Vec::new();
                if i != 1 {
                    all.push(number(Site::Path(Branch::First), "fade_1_per_J", first));
                }
                if i != 0 {
                    all.push(number(Site::Path(Branch::Second), "fade_2_per_J", second));
                }
                all.push(number(
                    if i == 1 {
                        Site::Path(Branch::Second)
                    } else {
                        Site::Path(Branch::First)
                    },
                    "cooling_time_s",
                    cooling,
                ));
                all
            }
            EffectId::Unlisted => {
                let (site, law) = unlisted(i, self.sign, amount, &self.shape);
                effects.unlisted.push(law);
                vec![number(site, "", 0.0)]
            }
            _ => {
                let column = Column::known(COLUMNS[i]);
                let (map, key, value) = match self.id {
                    EffectId::SensorLag => (&mut effects.sensor_lag, "time_constant_s".to_owned(), amount),
                    EffectId::SensorSkew => (&mut effects.sensor_skew, "delay_s".to_owned(), self.sign * amount),
                    EffectId::SensorGain => (
                        &mut effects.sensor_gain,
                        "relative_error".to_owned(),
                        self.sign * amount,
                    ),
                    EffectId::SensorDrift => (
                        &mut effects.sensor_drift,
                        format!("drift_{}_s", column.unit()),
                        self.sign * amount,
                    ),
                    _ => (&mut effects.sensor_sign, String::new(), -1.0),
                };
                map.get_or_insert_default().insert(column.to_string(), value);
                vec![number(Site::Sensor(column), &key, value)]
            }
        }
    }
}

/// Laws of textbook form that the vocabulary does not hold: place, what the table is over, and its form.
const LAWS: [&str; 7] = [
    "turbulent line 1",
    "turbulent line 2",
    "viscous seal",
    "air spring of a sealed dust boot",
    "groove beside damper 1",
    "groove beside damper 2",
    "valves whose flow saturates",
];

/// A law in a table of many points, not those that the search uses.
fn unlisted(which: usize, sign: f64, amount: f64, shape: &[f64; 4]) -> (Site, UnlistedLaw) {
    const POINTS: usize = 61;
    let (site, at, over, end): (_, _, _, f64) = match which {
        0 => (Site::Path(Branch::First), LawPlace::Path1, LawArgument::Flow, 2e-3),
        1 => (Site::Path(Branch::Second), LawPlace::Path2, LawArgument::Flow, 2e-3),
        2 => (Site::MainSeal, LawPlace::MainSeal, LawArgument::Speed, 1.2),
        4 => (
            Site::Path(Branch::First),
            LawPlace::BesidePack1,
            LawArgument::Displacement,
            0.11,
        ),
        5 => (
            Site::Path(Branch::Second),
            LawPlace::BesidePack2,
            LawArgument::Displacement,
            0.11,
        ),
        6 => (Site::Valves, LawPlace::Valves, LawArgument::PressureDrop, 1.3e7),
        _ => (Site::MainSeal, LawPlace::MainSeal, LawArgument::Displacement, 0.11),
    };
    let argument: Vec<f64> = (0..POINTS)
        .map(|k| end * (2.0 * k as f64 / (POINTS - 1) as f64 - 1.0))
        .collect();
    let value = |a: &f64| match which {
        // Drop over flow squared: 3 MPa at 2 l/s at most.
        0 | 1 => amount * 3e6 * (a / end) * (a / end).abs(),
        // Force over speed: 1.5 kN at 1.2 m/s at most, with a drawn curvature.
        2 => amount * 1.5e3 * (a / end) * libm::pow((a / end).abs(), 0.6 * shape[0]),
        // Opening over displacement: a groove of drawn place and width with ends that run out linearly; 2e-6 at most.
        4 | 5 => {
            let (at, half) = (0.03 * (2.0 * shape[0] - 1.0), 0.012 + 0.02 * shape[1]);
            amount * 2e-6 * (1.5 - (a - at).abs() / half).clamp(0.0, 1.0)
        }
        // What is left of a flow over the root of the drop that approaches a constant one.
        6 => 1.0 / (1.0 + 30.0 * amount * a.abs() / end).sqrt(),
        // Force over displacement.
        _ => sign * amount * 1e3 * (0.5 * a / end + (a / end) * (a / end) * (a / end)),
    };
    let value = argument.iter().map(value).collect();
    let law = UnlistedLaw {
        place: at,
        depends_on: over,
        argument,
        value,
    };
    (site, law)
}
