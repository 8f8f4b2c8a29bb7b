//! The table `[effects]` of a model: all terms together.

use serde::{Deserialize, Serialize};

use super::accumulator_piston_friction::AccumulatorPistonFriction;
use super::bump_stop::BumpStop;
use super::damper_leakage::DamperLeakage;
use super::damping_fade::DampingFade;
use super::entrained_air::EntrainedAir;
use super::equation::Equation;
use super::gas_charge_error::GasChargeError;
use super::gas_heat_transfer::GasHeatTransfer;
use super::id::TermId;
use super::line_inertance::LineInertance;
use super::line_resistance::LineResistance;
use super::mount_compliance::MountCompliance;
use super::oil_compressibility::OilCompressibility;
use super::real_gas::RealGas;
use super::seal_friction::SealFriction;
use super::sensor::{self, COLUMNS, SensorEffect};
use super::side_load_friction::SideLoadFriction;
use super::unlisted::{self, UnlistedLaw};
use super::valve_delay::ValveDelay;
use super::valve_transition::ValveTransition;
use super::valve3_leakage::Valve3Leakage;
use crate::model_file::{Checked, InvalidValue, Limit, Quantity};

/// The terms of a model: the table `[effects]` of `model.toml`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Effects {
    /// Finite bulk modulus of the oil.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub oil_compressibility: Option<OilCompressibility>,
    /// Undissolved air in the oil.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub entrained_air: Option<EntrainedAir>,
    /// Heat between the gas and the wall of its accumulator.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gas_heat_transfer: Option<GasHeatTransfer>,
    /// Nitrogen departs from the ideal gas law.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub real_gas: Option<RealGas>,
    /// Gas charge outside its tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gas_charge_error: Option<GasChargeError>,
    /// Coulomb and Stribeck friction of the rod seal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seal_friction: Option<SealFriction>,
    /// Friction of the guides that grows with the strut force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub side_load_friction: Option<SideLoadFriction>,
    /// Pressure held back by the seals of the floating pistons.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accumulator_piston_friction: Option<AccumulatorPistonFriction>,
    /// Oil that passes beside a damper pack.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damper_leakage: Option<DamperLeakage>,
    /// Laminar loss in series with a path.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line_resistance: Option<LineResistance>,
    /// Mass of the oil column of a line.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line_inertance: Option<LineInertance>,
    /// Valve response that depends on the pressure difference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub valve_delay: Option<ValveDelay>,
    /// Valves that move gradually.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub valve_transition: Option<ValveTransition>,
    /// Oil that passes the closed valve 3.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub valve3_leakage: Option<Valve3Leakage>,
    /// Buffers at the ends of travel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bump_stop: Option<BumpStop>,
    /// The mount yields elastically under the strut force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mount_compliance: Option<MountCompliance>,
    /// Dampers that weaken as they warm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damping_fade: Option<DampingFade>,
    /// Instruments that lag: time constant of a column, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_lag: Option<SensorEffect>,
    /// Instruments whose scale is wrong: relative error of a column.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_gain: Option<SensorEffect>,
    /// Instruments that drift: the column's unit per second.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_drift: Option<SensorEffect>,
    /// Instruments whose clock is late: time by which a column is late, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_skew: Option<SensorEffect>,
    /// Instruments with the wrong sign: -1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_sign: Option<SensorEffect>,
    /// Instruments with an offset, in the column's unit: calibration, never physics.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_offset: Option<SensorEffect>,
    /// Laws that the vocabulary has no name for.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub unlisted: Vec<UnlistedLaw>,
}

impl Effects {
    /// Whether the model has a term.
    ///
    /// ```
    /// use oleo_plant_sim::strut::{StrutModel, TermId};
    /// let effects = StrutModel::defender110(8000.0).effects;
    /// assert!(effects.has(TermId::RealGas) && !effects.has(TermId::LineInertance));
    /// ```
    #[must_use]
    pub fn has(&self, id: TermId) -> bool {
        match id {
            TermId::OilCompressibility => self.oil_compressibility.is_some(),
            TermId::EntrainedAir => self.entrained_air.is_some(),
            TermId::GasHeatTransfer => self.gas_heat_transfer.is_some(),
            TermId::RealGas => self.real_gas.is_some(),
            TermId::GasChargeError => self.gas_charge_error.is_some(),
            TermId::SealFriction => self.seal_friction.is_some(),
            TermId::SideLoadFriction => self.side_load_friction.is_some(),
            TermId::AccumulatorPistonFriction => self.accumulator_piston_friction.is_some(),
            TermId::DamperLeakage => self.damper_leakage.is_some(),
            TermId::LineResistance => self.line_resistance.is_some(),
            TermId::LineInertance => self.line_inertance.is_some(),
            TermId::ValveDelay => self.valve_delay.is_some(),
            TermId::ValveTransition => self.valve_transition.is_some(),
            TermId::Valve3Leakage => self.valve3_leakage.is_some(),
            TermId::BumpStop => self.bump_stop.is_some(),
            TermId::MountCompliance => self.mount_compliance.is_some(),
            TermId::DampingFade => self.damping_fade.is_some(),
            TermId::SensorLag => self.sensor_lag.is_some(),
            TermId::SensorGain => self.sensor_gain.is_some(),
            TermId::SensorDrift => self.sensor_drift.is_some(),
            TermId::SensorSkew => self.sensor_skew.is_some(),
            TermId::SensorSign => self.sensor_sign.is_some(),
            TermId::SensorOffset => self.sensor_offset.is_some(),
            TermId::Unlisted => !self.unlisted.is_empty(),
        }
    }

    /// The faulty columns of one kind of instrument fault; `None` for an id that is no fault of instruments.
    ///
    /// ```
    /// use oleo_plant_sim::strut::{Effects, TermId};
    /// let mut effects = Effects::default();
    /// let lags = effects.sensor_fault_mut(TermId::SensorLag).unwrap();
    /// lags.get_or_insert_default().insert("p2_Pa".to_owned(), 0.004);
    /// assert_eq!(effects.sensor_lag.unwrap()["p2_Pa"], 0.004);
    /// ```
    pub fn sensor_fault_mut(&mut self, id: TermId) -> Option<&mut Option<SensorEffect>> {
        match id {
            TermId::SensorLag => Some(&mut self.sensor_lag),
            TermId::SensorGain => Some(&mut self.sensor_gain),
            TermId::SensorDrift => Some(&mut self.sensor_drift),
            TermId::SensorSkew => Some(&mut self.sensor_skew),
            TermId::SensorSign => Some(&mut self.sensor_sign),
            TermId::SensorOffset => Some(&mut self.sensor_offset),
            _ => None,
        }
    }

    /// Keeps the faults of those instruments whose column is wanted and takes out all others.
    pub fn retain_sensor_faults(&mut self, wanted: impl Fn(&str) -> bool) {
        for &id in TermId::ALL {
            if let Some(Some(faults)) = self.sensor_fault_mut(id) {
                faults.retain(|column, _| wanted(column));
            }
        }
        self.unlisted.retain(|law| law.place.column().is_none_or(&wanted));
    }

    /// Check the numbers of one term, where the model has it.
    fn check_term(&self, id: TermId) -> Result<(), InvalidValue> {
        fn term(term: Option<&impl Checked>) -> Result<(), InvalidValue> {
            term.map_or(Ok(()), Checked::check)
        }
        let columns = |effect: &Option<SensorEffect>| sensor::check_sizes(id, effect.as_ref(), &COLUMNS);
        match id {
            TermId::OilCompressibility => term(self.oil_compressibility.as_ref()),
            TermId::EntrainedAir => term(self.entrained_air.as_ref()),
            TermId::GasHeatTransfer => term(self.gas_heat_transfer.as_ref()),
            TermId::RealGas => term(self.real_gas.as_ref()),
            TermId::GasChargeError => term(self.gas_charge_error.as_ref()),
            TermId::SealFriction => term(self.seal_friction.as_ref()),
            TermId::SideLoadFriction => term(self.side_load_friction.as_ref()),
            TermId::AccumulatorPistonFriction => term(self.accumulator_piston_friction.as_ref()),
            TermId::DamperLeakage => term(self.damper_leakage.as_ref()),
            TermId::LineResistance => term(self.line_resistance.as_ref()),
            TermId::LineInertance => term(self.line_inertance.as_ref()),
            TermId::ValveDelay => term(self.valve_delay.as_ref()),
            TermId::ValveTransition => term(self.valve_transition.as_ref()),
            TermId::Valve3Leakage => term(self.valve3_leakage.as_ref()),
            TermId::BumpStop => term(self.bump_stop.as_ref()),
            TermId::MountCompliance => term(self.mount_compliance.as_ref()),
            TermId::DampingFade => term(self.damping_fade.as_ref()),
            TermId::SensorLag => columns(&self.sensor_lag),
            TermId::SensorGain => columns(&self.sensor_gain),
            TermId::SensorDrift => columns(&self.sensor_drift),
            TermId::SensorSkew => columns(&self.sensor_skew),
            TermId::SensorSign => columns(&self.sensor_sign),
            TermId::SensorOffset => columns(&self.sensor_offset),
            TermId::Unlisted => unlisted::check_all(&self.unlisted),
        }
    }
}

impl TermId {
    /// The numbers of a term, with their ranges and units, for documentation and schemas. Those of an instrument's fault
    /// stand for each column; an unmodelled law has its tables.
    #[must_use]
    pub fn quantities(self) -> Vec<Quantity> {
        match self {
            Self::OilCompressibility => OilCompressibility::quantities(),
            Self::EntrainedAir => EntrainedAir::quantities(),
            Self::GasHeatTransfer => GasHeatTransfer::quantities(),
            Self::RealGas => RealGas::quantities(),
            Self::GasChargeError => GasChargeError::quantities(),
            Self::SealFriction => SealFriction::quantities(),
            Self::SideLoadFriction => SideLoadFriction::quantities(),
            Self::AccumulatorPistonFriction => AccumulatorPistonFriction::quantities(),
            Self::DamperLeakage => DamperLeakage::quantities(),
            Self::LineResistance => LineResistance::quantities(),
            Self::LineInertance => LineInertance::quantities(),
            Self::ValveDelay => ValveDelay::quantities(),
            Self::ValveTransition => ValveTransition::quantities(),
            Self::Valve3Leakage => Valve3Leakage::quantities(),
            Self::BumpStop => BumpStop::quantities(),
            Self::MountCompliance => MountCompliance::quantities(),
            Self::DampingFade => DampingFade::quantities(),
            Self::SensorLag => vec![sensor::lag::SIZE],
            Self::SensorGain => vec![sensor::gain::SIZE],
            Self::SensorDrift => vec![sensor::drift::SIZE],
            Self::SensorSkew => vec![sensor::skew::SIZE],
            Self::SensorSign => vec![sensor::sign::SIZE],
            Self::SensorOffset => vec![sensor::offset::SIZE],
            Self::Unlisted => UnlistedLaw::quantities(),
        }
    }
}

impl TermId {
    /// The equation of a term as the solver computes it, and its source.
    ///
    /// ```
    /// use oleo_plant_sim::strut::TermId;
    /// assert_eq!(TermId::SideLoadFriction.equation().text, "g = mu |F| / (1 + s x)");
    /// ```
    #[must_use]
    pub const fn equation(self) -> Equation {
        match self {
            Self::OilCompressibility => super::oil_compressibility::EQUATION,
            Self::EntrainedAir => super::entrained_air::EQUATION,
            Self::GasHeatTransfer => super::gas_heat_transfer::EQUATION,
            Self::RealGas => super::real_gas::EQUATION,
            Self::GasChargeError => super::gas_charge_error::EQUATION,
            Self::SealFriction => super::seal_friction::EQUATION,
            Self::SideLoadFriction => super::side_load_friction::EQUATION,
            Self::AccumulatorPistonFriction => super::accumulator_piston_friction::EQUATION,
            Self::DamperLeakage => super::damper_leakage::EQUATION,
            Self::LineResistance => super::line_resistance::EQUATION,
            Self::LineInertance => super::line_inertance::EQUATION,
            Self::ValveDelay => super::valve_delay::EQUATION,
            Self::ValveTransition => super::valve_transition::EQUATION,
            Self::Valve3Leakage => super::valve3_leakage::EQUATION,
            Self::BumpStop => super::bump_stop::EQUATION,
            Self::MountCompliance => super::mount_compliance::EQUATION,
            Self::DampingFade => super::damping_fade::EQUATION,
            Self::SensorLag => sensor::lag::EQUATION,
            Self::SensorGain => sensor::gain::EQUATION,
            Self::SensorDrift => sensor::drift::EQUATION,
            Self::SensorSkew => sensor::skew::EQUATION,
            Self::SensorSign => sensor::sign::EQUATION,
            Self::SensorOffset => sensor::offset::EQUATION,
            Self::Unlisted => unlisted::EQUATION,
        }
    }
}

impl Checked for Effects {
    const LIMITS: &'static [Limit<Self>] = &[];

    fn check_together(&self) -> Result<(), InvalidValue> {
        (TermId::ALL.iter()).try_for_each(|id| self.check_term(*id).map_err(|invalid| invalid.inside(id.key())))
    }
}

#[cfg(test)]
impl Effects {
    /// Every term once, with numbers of ordinary size.
    pub(crate) fn every_term() -> Self {
        toml::from_str(
            r#"
            oil_compressibility = { bulk_modulus_Pa = 1.4e9, counted_at = "static" }
            entrained_air = { volume_fraction = 0.005, polytropic_exponent = 1.2 }
            gas_heat_transfer = { time_constant_1_s = 2.6, time_constant_2_s = 6.5 }
            real_gas = { equation = "bwr" }
            gas_charge_error = { relative_error_1 = 0.02, relative_error_2 = -0.01 }
            seal_friction = { coulomb_force_N = 300.0, breakaway_force_N = 400.0, stribeck_speed_m_s = 0.02, presliding_stiffness_N_m = 2e6 }
            side_load_friction = { coefficient = 0.01, overlap_growth_1_m = 2.0 }
            accumulator_piston_friction = { pressure_1_Pa = 3e4, pressure_2_Pa = 2e4, presliding_volume_m3 = 1e-7 }
            damper_leakage = { flow_coefficient_1 = 8e-8, flow_coefficient_2 = 5e-8 }
            line_resistance = { resistance_1_Pa_s_m3 = 1e8, resistance_2_Pa_s_m3 = 1e8 }
            line_inertance = { inertance_2_kg_m4 = 5e6 }
            valve_delay = { response_polynomial_s = [0.04, 0.002, 0.0001] }
            valve_transition = { shape = "linear" }
            valve3_leakage = { flow_coefficient = 1e-9 }
            bump_stop = { bump_clearance_m = 0.07, rebound_clearance_m = 0.08, stiffness_N_m = 5e4, progression_N_m3 = 1e9 }
            mount_compliance = { stiffness_N_m = 5e6 }
            damping_fade = { fade_1_per_J = 1e-4, fade_2_per_J = 1e-4, cooling_time_s = 60.0 }
            sensor_lag = { p2_Pa = 0.004, displacement_m = 0.001 }
            sensor_gain = { p1_Pa = 0.01 }
            sensor_drift = { p3_Pa = 10.0 }
            sensor_skew = { p4_Pa = 0.002 }
            sensor_sign = { force_N = -1.0 }
            sensor_offset = { p1_Pa = 1000.0 }
            [[unlisted]]
            place = "accumulator-1"
            depends_on = "volume_change"
            argument = [-1.0, 0.0, 1.0]
            value = [1.2, 1.0, 0.8]
            time_constant_s = 3.0
            [[unlisted]]
            place = "main-seal"
            depends_on = "phase"
            argument = [0.0, 0.5, 1.0]
            value = [100.0, -100.0, 100.0]
            frequency_Hz = 0.7
            [[unlisted]]
            place = "accumulator-2-friction"
            depends_on = "relative_volume"
            argument = [0.5, 1.5]
            value = [4e4, 3e4]
            presliding_volume_m3 = 3e-7
            [[unlisted]]
            place = "accumulator-1..2"
            depends_on = "relative_density"
            argument = [0.0, 4.0]
            value = [1.0, 0.95]
            attraction = 0.07
            "#,
        )
        .unwrap()
    }

    /// A law without a name over every quantity at every place of the network, with numbers of ordinary size.
    pub(crate) fn laws_of_the_network() -> Vec<UnlistedLaw> {
        use super::unlisted::LawArgument::{self, *};
        use super::unlisted::LawPlace::*;
        let law = |place, depends_on: LawArgument, argument: [f64; 3], value: [f64; 3]| UnlistedLaw {
            place,
            depends_on,
            argument: argument.to_vec(),
            value: value.to_vec(),
            time_constant_s: depends_on.is_remembered().then_some(3.0),
            frequency_hz: (depends_on == Phase).then_some(1.7),
            presliding_volume_m3: None,
            attraction: None,
        };
        let (factor, turn) = ([1.0, 0.95, 0.8], [0.9, 1.1, 0.9]);
        let (small, large) = ([-0.04, 0.0, 0.04], [-1e6, 0.0, 3e6]);
        let (start, phase) = ([0.0, 1.0, 4.0], [0.0, 0.4, 1.0]);
        vec![
            law(MainChamber, P1, [0.0, 4e6, 9e6], [0.0, 1e-6, 3e-6]),
            law(MainChamberLoss, P1, [0.0, 4e6, 9e6], [0.0, 1e-7, 4e-7]),
            law(MainChamberLoss, Time, start, [0.0, 2e-7, 1e-7]),
            law(MainChamberLoss, Phase, phase, [0.0, 1e-7, 0.0]),
            law(Mount, Force, [-4e3, 0.0, 4e3], [-2e-3, 0.0, 1e-3]),
            law(Path1, Flow, [-1e-3, 0.0, 1e-3], [-2e5, 0.0, 1e5]),
            law(BesidePack1, PressureDrop, large, [-1e-5, 0.0, 2e-5]),
            law(BesidePack2, Displacement, small, [0.0, 1e-7, 2e-7]),
            law(BesidePack2, Time, start, [0.0, 1e-7, 2e-7]),
            law(Pack1, Displacement, small, factor),
            law(Pack1, Time, start, factor),
            law(Pack2, Phase, phase, turn),
            law(Pack2, Energy, [0.0, 100.0, 3e3], factor),
            law(Valves, PressureDrop, large, [0.7, 1.0, 0.6]),
            law(Valves, Phase, phase, turn),
            law(BesideValve3, Displacement, small, [0.0, 0.0, 2e-7]),
            law(BesideValve3, Time, start, [0.0, 1e-7, 0.0]),
            law(Accumulator1, RelativeVolume, [0.5, 1.0, 1.5], [1.1, 1.0, 1.05]),
            law(Accumulator1, Time, start, factor),
            law(Accumulator2, VolumeChange, [-0.5, 0.0, 0.5], [1.1, 1.0, 0.9]),
            law(Accumulator2, RelativeEnergy, [-0.2, 0.0, 0.2], [0.9, 1.0, 1.1]),
            law(Accumulators, RelativeDensity, [0.0, 1.0, 4.0], [1.0, 0.99, 0.95]),
            law(Accumulator2Friction, RelativeVolume, [0.5, 1.0, 1.5], [4e4, 3e4, 2e4]),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model_file::limits::forgotten_keys;

    #[test]
    fn every_id_is_a_key_of_the_table_and_every_key_an_id() {
        let (all, none) = (Effects::every_term(), Effects::default());
        assert!(TermId::ALL.iter().all(|id| all.has(*id) && !none.has(*id)));
        let written = toml::Table::try_from(&all).unwrap();
        let (mut keys, mut ids): (Vec<&str>, Vec<&str>) = (
            written.keys().map(String::as_str).collect(),
            TermId::ALL.iter().map(|id| id.key()).collect(),
        );
        keys.sort_unstable();
        ids.sort_unstable();
        assert_eq!(keys, ids);
        assert_eq!(toml::from_str::<Effects>(&toml::to_string(&all).unwrap()).unwrap(), all);
        assert_eq!(all.check(), Ok(()));
    }

    #[test]
    fn faults_of_other_instruments_are_taken_out_whatever_they_are() {
        let mut effects = Effects::every_term();
        effects.retain_sensor_faults(|column| column == "displacement_m");
        assert_eq!(
            effects.sensor_lag,
            Some(SensorEffect::from([("displacement_m".to_owned(), 0.001)]))
        );
        for id in TermId::ALL.iter().filter(|id| **id != TermId::SensorLag) {
            assert!(
                effects
                    .sensor_fault_mut(*id)
                    .is_none_or(|faults| faults.as_ref().is_some_and(SensorEffect::is_empty))
            );
        }
        assert!(effects.damping_fade.is_some());
    }

    #[test]
    fn the_heading_of_every_file_has_the_equation_that_pages_print() {
        for id in TermId::ALL.iter().filter(|id| **id != TermId::Unlisted) {
            let file = id.key().replace("sensor_", "sensor/");
            let path = format!("{}/src/strut/terms/{file}.rs", env!("CARGO_MANIFEST_DIR"));
            let text = std::fs::read_to_string(path).unwrap();
            let heading: Vec<&str> = text.lines().map_while(|line| line.strip_prefix("//!")).collect();
            let heading = heading.join("");
            for part in id.equation().text.split(", ") {
                assert!(heading.contains(part), "{file}: {part} is not in its heading");
            }
        }
    }

    #[test]
    fn every_number_has_a_limit_and_every_limit_a_number() {
        fn of<T: Checked + Serialize>(term: &Option<T>) -> Vec<String> {
            forgotten_keys(term.as_ref().expect("every term is there"))
        }
        let e = Effects::every_term();
        let forgotten = [
            of(&e.oil_compressibility),
            of(&e.entrained_air),
            of(&e.gas_heat_transfer),
            of(&e.real_gas),
            of(&e.gas_charge_error),
            of(&e.seal_friction),
            of(&e.side_load_friction),
            of(&e.accumulator_piston_friction),
            of(&e.damper_leakage),
            of(&e.line_resistance),
            of(&e.line_inertance),
            of(&e.valve_delay),
            of(&e.valve_transition),
            of(&e.valve3_leakage),
            of(&e.bump_stop),
            of(&e.mount_compliance),
            of(&e.damping_fade),
            // No law has all.
            forgotten_keys(&UnlistedLaw {
                frequency_hz: e.unlisted[1].frequency_hz,
                presliding_volume_m3: e.unlisted[2].presliding_volume_m3,
                attraction: e.unlisted[3].attraction,
                ..e.unlisted[0].clone()
            }),
        ];
        assert!(forgotten.concat().is_empty(), "{forgotten:?}");
    }

    #[test]
    fn an_impossible_number_is_reported_with_its_term() {
        let written = toml::Table::try_from(Effects::every_term()).unwrap();
        for id in TermId::ALL {
            for quantity in id.quantities() {
                // A list is spoilt at its second entry; a fault of instruments has columns in place of its key.
                let mut spoilt = written.clone();
                let table = match &mut spoilt[id.key()] {
                    toml::Value::Array(laws) => {
                        let has_it = laws.iter().position(|law| law.get(quantity.key).is_some());
                        &mut laws[has_it.unwrap()]
                    }
                    table => table,
                };
                let key = match quantity.key.strip_prefix("sensor_") {
                    Some(_) => table.as_table().unwrap().keys().next().unwrap().clone(),
                    None => quantity.key.to_owned(),
                };
                match &mut table[key.as_str()] {
                    toml::Value::Array(list) => list[1] = toml::Value::Float(f64::NAN),
                    number => *number = toml::Value::Float(f64::INFINITY),
                }
                let effects: Effects = spoilt.try_into().unwrap();
                let complaint = effects.check().unwrap_err().to_string();
                assert!(
                    complaint.starts_with(&format!("[{}", id.key())) && complaint.contains(&format!("] {key}")),
                    "{complaint}"
                );
                assert!(complaint.contains(&quantity.range.demand(quantity.unit)), "{complaint}");
            }
        }
    }
}
