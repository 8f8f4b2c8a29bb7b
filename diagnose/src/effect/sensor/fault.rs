//! What the faults of instruments have in common: where they can be, how they are put, concealed and searched for.

use oleo_plant_sim::specimen::{CylinderModel, GasSpringModel, MechanismEffects};
use oleo_plant_sim::strut::{COLUMNS, Equation, SensorEffect, StrutModel, TermId};

use crate::correction::Corrections;
use crate::effect::candidate::Candidate;
use crate::effect::contract::{
    ActsOn, CoSimulation, Concealed, Cylinder, Effect, Experiment, GasSpring, Mechanism, Strut, StrutEffect,
};
use crate::effect::drawn::{Drawn, TrueNumber};
use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::{Column, EffectId, Site};

/// The only instrument of a gas spring: the pressure, absolute.
pub const PRESSURE_OF_GAS_SPRING: Column = Column::known("p_Pa");
/// Shortest sampling interval that starts and ranges are made from, s.
const LEAST_INTERVAL_S: f64 = 1e-4;
/// Size of an instrument that shows the wrong sign, which has nothing to fit.
const REVERSED: f64 = -1.0;

/// A fault of an instrument.
pub struct Fault {
    /// Id of the fault in the vocabulary.
    pub id: EffectId,
    /// Term of plant-sim that computes the fault.
    pub term: TermId,
    /// What it is called in a sentence.
    pub name: &'static str,
    /// The meaning of its equation.
    pub meaning: &'static str,
    /// Keys and symbols of what is reported.
    pub symbols: &'static [(&'static str, &'static str)],
    /// The number to fit; `None` for a fault that is there or not.
    pub parameter: Option<fn(&Reading) -> Parameter>,
    /// The number to fit where corners of the motion tell of the clocks of a gas spring; `None` where they say nothing.
    pub limited_by_clocks: fn(&excitation::GasSpring) -> Option<Parameter>,
    /// The instruments of a cylinder that may have it.
    pub of_cylinder: OfCylinder,
    /// Smallest and largest amount to conceal in a column of this size; `None` for a fault that is there or not.
    pub amounts: fn(f64) -> Option<(f64, f64)>,
    /// True if the amount may have either sign.
    pub signed: bool,
    /// What to record of a strut.
    pub with_valves: Experiment,
    /// What to record of a specimen without valves.
    pub without_valves: Experiment,
}

/// The instruments of a cylinder that may have a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OfCylinder {
    /// The fault may be in the load cell and in every pressure sensor.
    All,
    /// The load cell only: what the fault does to an input cannot be undone without amplifying its noise.
    LoadCell,
}

/// What an instrument shows over the recordings.
pub struct Reading {
    /// Column that the sensor records.
    pub column: Column,
    /// Drift that would move it by its largest departure from rest over the longest recording, the column's unit per second.
    pub drift_per_s: f64,
    /// Sampling interval of the recordings, s.
    pub interval_s: f64,
}

impl Reading {
    /// `size` is the column's largest departure from rest, in its unit; times are in s.
    fn new(column: Column, size: f64, duration_s: f64, interval_s: f64) -> Self {
        Self {
            column,
            drift_per_s: size.max(1e-12) / duration_s.max(1e-9),
            interval_s: interval_s.max(LEAST_INTERVAL_S),
        }
    }
}

impl Fault {
    fn candidate(&self, reading: &Reading) -> Candidate {
        let parameter = self.parameter.map(|parameter| parameter(reading).on_instrument());
        Candidate::new(
            self.id,
            Site::Sensor(reading.column.clone()),
            parameter.into_iter().collect(),
        )
    }

    /// Enters a fault in the table of its kind.
    fn enter(&self, table: Option<&mut Option<SensorEffect>>, candidate: &Candidate, values: &[f64]) {
        if let (Some(table), Some(column)) = (table, candidate.place.sensor()) {
            let size = values.first().copied().unwrap_or(REVERSED);
            table.get_or_insert_default().insert(column.to_string(), size);
        }
    }

    /// Key of the number that is reported for a column.
    fn key(&self, column: &Column) -> String {
        let any = Reading::new(column.clone(), 1.0, 1.0, 1.0);
        self.parameter.map_or_else(String::new, |parameter| parameter(&any).key)
    }
}

impl Effect for Fault {
    fn id(&self) -> EffectId {
        self.id
    }

    fn name(&self) -> &'static str {
        self.name
    }

    fn meaning(&self) -> &'static str {
        self.meaning
    }

    fn symbols(&self) -> &'static [(&'static str, &'static str)] {
        self.symbols
    }

    fn in_strut(&self) -> Option<&dyn StrutEffect> {
        Some(self)
    }

    fn in_gas_spring(&self) -> Option<&dyn ActsOn<GasSpring>> {
        self.parameter.is_some().then_some(self)
    }

    fn in_cylinder(&self) -> Option<&dyn ActsOn<Cylinder>> {
        Some(self)
    }

    fn in_mechanism(&self) -> Option<&dyn ActsOn<Mechanism>> {
        Some(self)
    }

    fn in_co_simulation(&self) -> Option<&dyn ActsOn<CoSimulation>> {
        Some(self)
    }
}

/// Every compared column, and every input that is not switched. What a fault does to an input is undone before the model is simulated, except a lag, of which only noise would
/// be left.
impl ActsOn<CoSimulation> for Fault {
    fn equation(&self) -> Equation {
        self.term.equation()
    }

    fn candidates(&self, _model: &Corrections, excitation: &excitation::CoSimulation) -> Vec<Candidate> {
        let of = |reading: &excitation::Reading| {
            self.candidate(&Reading::new(
                reading.column.clone(),
                reading.spread,
                excitation.duration_s,
                excitation.interval_s,
            ))
        };
        let inputs = (excitation.inputs.iter())
            .filter(|_| self.id != EffectId::SensorLag)
            .map(of)
            .map(|mut candidate| {
                (candidate.parameters.iter_mut()).for_each(|p| p.instrument_only = false);
                candidate
            });
        excitation.outputs.iter().map(of).chain(inputs).collect()
    }

    fn put(&self, model: &mut Corrections, candidate: &Candidate, values: &[f64]) {
        self.enter(model.sensor_fault_mut(self.term), candidate, values);
    }

    fn experiment(&self) -> Experiment {
        self.without_valves
    }
}

impl ActsOn<Strut> for Fault {
    fn equation(&self) -> Equation {
        self.term.equation()
    }

    fn candidates(&self, _model: &StrutModel, excitation: &excitation::Strut) -> Vec<Candidate> {
        let (low, high) = excitation.displacement_m;
        let of = |(k, name): (usize, &&'static str)| {
            let size = match k.checked_sub(1) {
                None => (high - low).max(1e-6),
                Some(channel) => excitation.departure[channel],
            };
            let column = Column::known(name);
            let reading = Reading::new(column, size, excitation.duration_s, excitation.interval_s);
            let mut candidate = self.candidate(&reading);
            // A fault of the displacement sensor changes the motion that is simulated.
            (candidate.parameters.iter_mut()).for_each(|p| p.instrument_only = k > 0);
            candidate
        };
        COLUMNS.iter().enumerate().map(of).collect()
    }

    fn put(&self, model: &mut StrutModel, candidate: &Candidate, values: &[f64]) {
        self.enter(model.effects.sensor_fault_mut(self.term), candidate, values);
    }

    fn experiment(&self) -> Experiment {
        self.with_valves
    }
}

impl ActsOn<GasSpring> for Fault {
    fn equation(&self) -> Equation {
        self.term.equation()
    }

    fn candidates(&self, _model: &GasSpringModel, excitation: &excitation::GasSpring) -> Vec<Candidate> {
        let extent = &excitation.extent;
        let reading = Reading::new(
            PRESSURE_OF_GAS_SPRING,
            extent.spread(1),
            extent.duration_s,
            extent.interval_s,
        );
        let mut candidate = self.candidate(&reading);
        if let Some(parameter) = (self.limited_by_clocks)(excitation) {
            candidate.parameters = vec![parameter.on_instrument()];
        }
        vec![candidate]
    }

    fn put(&self, model: &mut GasSpringModel, candidate: &Candidate, values: &[f64]) {
        self.enter(model.effects.sensor_fault_mut(self.term), candidate, values);
    }

    fn experiment(&self) -> Experiment {
        self.without_valves
    }
}

impl ActsOn<Cylinder> for Fault {
    fn equation(&self) -> Equation {
        self.term.equation()
    }

    fn candidates(&self, model: &CylinderModel, excitation: &excitation::Cylinder) -> Vec<Candidate> {
        let extent = &excitation.extent;
        let pressures = model.chamber.iter().map(|c| Column::named(c.column.clone()));
        let count = match self.of_cylinder {
            OfCylinder::All => usize::MAX,
            OfCylinder::LoadCell => 1,
        };
        let columns = std::iter::once(Column::FORCE).chain(pressures).take(count);
        let of = |(k, column): (usize, Column)| {
            let reading = Reading::new(column, extent.spread(1 + k), extent.duration_s, extent.interval_s);
            let mut candidate = self.candidate(&reading);
            // The pressures are inputs of the model; the load cell is simulated with them.
            (candidate.parameters.iter_mut()).for_each(|p| p.instrument_only = false);
            candidate
        };
        columns.enumerate().map(of).collect()
    }

    fn put(&self, model: &mut CylinderModel, candidate: &Candidate, values: &[f64]) {
        self.enter(model.effects.sensor_fault_mut(self.term), candidate, values);
    }

    fn experiment(&self) -> Experiment {
        self.without_valves
    }
}

/// Only the compared column is tried: what a fault of the other column does can as well be done by one of this column and by
/// the values of the model.
impl ActsOn<Mechanism> for Fault {
    fn equation(&self) -> Equation {
        self.term.equation()
    }

    fn candidates(&self, _model: &MechanismEffects, excitation: &excitation::Mechanism) -> Vec<Candidate> {
        let extent = &excitation.extent;
        let reading = Reading::new(
            excitation.compared.clone(),
            extent.spread(1),
            extent.duration_s,
            extent.interval_s,
        );
        let mut candidate = self.candidate(&reading);
        (candidate.parameters.iter_mut()).for_each(|p| p.instrument_only = !excitation.begins_with_instrument);
        vec![candidate]
    }

    fn put(&self, model: &mut MechanismEffects, candidate: &Candidate, values: &[f64]) {
        self.enter(model.sensor_fault_mut(self.term), candidate, values);
    }

    fn experiment(&self) -> Experiment {
        self.without_valves
    }
}

impl Concealed for Fault {
    fn variants(&self) -> usize {
        COLUMNS.len()
    }

    fn amounts(&self, variant: usize) -> Option<(f64, f64)> {
        // About the range of the displacement, m, and of force and pressures, N and Pa.
        (self.amounts)(if variant == 0 { 0.05 } else { 5e6 })
    }

    fn faulty_column(&self, variant: usize) -> Option<&'static str> {
        COLUMNS.get(variant).copied()
    }

    fn put_true(&self, model: &mut StrutModel, drawn: &Drawn, amount: f64) -> Vec<TrueNumber> {
        let column = Column::known(COLUMNS[drawn.variant]);
        let size = match (self.parameter.is_some(), self.signed) {
            (false, _) => REVERSED,
            (true, true) => drawn.sign * amount,
            (true, false) => amount,
        };
        let key = self.key(&column);
        let candidate = Candidate::new(self.id, Site::Sensor(column.clone()), vec![]);
        self.enter(model.effects.sensor_fault_mut(self.term), &candidate, &[size]);
        vec![TrueNumber::new(Site::Sensor(column), key, size)]
    }
}
