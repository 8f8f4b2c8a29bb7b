//! One strut: displacement and switching signals in, force and pressures out.
//!
//! A tool gives inputs for the begin of a step, and a strut needs to know where its piston is at the end. The piston moves evenly, from
//! where it is to
//!
//! ```text
//! displacement_m + speed_m_s h
//! ```
//!
//! with the step h. With the speed left at 0 the displacement counts for the end of the step: all outputs are then one step late, as with
//! every input that is held. With the speed of the piston at the begin of the step they are not, to first order.

use oleo_interface::StrutValves;
use oleo_plant_sim::model_file::{Checked, Quantity, Range};
use oleo_plant_sim::strut::{
    Accumulator, COLUMNS, Cylinder, DamperTable, GasCharge, LawPlace, Orifice, Strut, StrutModel, StrutSnapshot,
    TermId, Valve, ValveTiming,
};

use crate::complaint::Complaint;
use crate::definition::Definition;
use crate::model::{Model, is_on};
use crate::numbers::{Numbers, quantity};
use crate::variable::{Role, Variable};

const DISPLACEMENT: usize = 1;
const SPEED: usize = 2;
const FIRST_VALVE: usize = 3;
const FIRST_OUTPUT: usize = 6;
/// Outputs, each with unit and meaning, in the order in which [`Model::outputs`] writes them.
const OUTPUTS: [(&str, &str, &str); 14] = [
    ("force_N", "N", "force of the strut, compression positive"),
    ("p1_Pa", "Pa", "gauge pressure in the main chamber"),
    ("p2_Pa", "Pa", "gauge pressure of the oil at accumulator 1 (0.1 l)"),
    ("p3_Pa", "Pa", "gauge pressure between damper 2 and valve 3"),
    ("p4_Pa", "Pa", "gauge pressure of the oil at accumulator 2 (0.4 l)"),
    ("opening1", "", "opening of valve 1, 0 closed to 1 open"),
    ("opening2", "", "opening of valve 2"),
    ("opening3", "", "opening of valve 3"),
    ("flow1_m3_s", "m3/s", "flow out of the main chamber through path 1"),
    ("flow2_m3_s", "m3/s", "flow out of the main chamber through path 2"),
    ("gas_volume1_m3", "m3", "volume of the gas in accumulator 1"),
    ("gas_volume2_m3", "m3", "volume of the gas in accumulator 2"),
    ("gas_temperature1_K", "K", "temperature of the gas in accumulator 1"),
    ("gas_temperature2_K", "K", "temperature of the gas in accumulator 2"),
];
const FIRST_PARAMETER: usize = FIRST_OUTPUT + OUTPUTS.len();

/// No cylinder is this long, m: what is farther is an error of the tool.
const FARTHEST_M: f64 = 2.0;
/// No piston is this fast, m/s.
const FASTEST_M_S: f64 = 100.0;

/// The definition of the FMU of a strut, and the strut behind it.
///
/// # Errors
/// A model that has faults of instruments, which an FMU has not.
pub fn strut(model: &StrutModel) -> Result<(Definition, StrutUnit), Complaint> {
    refuse_instruments(model)?;
    let (numbers, parameters) = Numbers::of(model, describe)?;
    let mut variables = vec![
        Variable::time(),
        Variable::input(
            COLUMNS[0],
            "m",
            Range::FromTo(-FARTHEST_M, FARTHEST_M),
            "displacement from the static position, compression positive; the strut starts at rest there",
        ),
        Variable::input(
            "speed_m_s",
            "m/s",
            Range::FromTo(-FASTEST_M_S, FASTEST_M_S),
            "speed of the displacement at the begin of a step; 0 where only the displacement is known",
        ),
    ];
    variables.extend([1, 2, 3].map(|number| {
        let what = ["bypass of damper 1", "bypass of damper 2", "accumulator 2"][number - 1];
        let description = format!("switching signal of valve {number} ({what}): true opens");
        Variable::switch(format!("valve{number}"), Role::Input, description)
    }));
    variables.extend(OUTPUTS.map(|(name, unit, description)| Variable::output(name, unit, description)));
    debug_assert_eq!(variables.len(), FIRST_PARAMETER);
    variables.extend(parameters);
    let definition = Definition {
        identifier: "oleo_strut",
        description: format!("Two-stage hydropneumatic strut {}", model.specimen.name),
        variables,
        tick_s: None,
        step_s: 1e-3,
        stop_s: 10.0,
        terminal: None,
    };
    let unit = StrutUnit {
        numbers,
        applied: Vec::new(),
        model: model.clone(),
        strut: None,
    };
    Ok((definition, unit))
}

/// An FMU gives true values: what instruments make of them is for whoever reads them.
pub fn refuse_instruments(model: &StrutModel) -> Result<(), Complaint> {
    let effects = &model.effects;
    let fault = [
        TermId::SensorLag,
        TermId::SensorGain,
        TermId::SensorDrift,
        TermId::SensorSkew,
        TermId::SensorSign,
        TermId::SensorOffset,
    ];
    let law = (effects.unlisted.iter()).any(|law| {
        use LawPlace as P;
        matches!(
            law.place,
            P::InstrumentDisplacement
                | P::InstrumentForce
                | P::InstrumentP1
                | P::InstrumentP2
                | P::InstrumentP3
                | P::InstrumentP4
        )
    });
    let found = (fault.into_iter().find(|id| effects.has(*id))).map(TermId::key);
    match found.or(law.then_some("unlisted, at a sensor,")) {
        None => Ok(()),
        Some(key) => Err(Complaint::new(format!(
            "[effects] {key} is a fault of instruments: an FMU gives true values; take it out of the model file"
        ))),
    }
}

/// Range, unit and role of a number of a strut's model file.
pub fn describe(keys: &[&str], entry: Option<usize>) -> Option<(Quantity, Role)> {
    let (table, role) = match keys {
        // What a strut is filled with, and how large it is, is settled when it is built.
        ["cylinder", _] => (Cylinder::quantities(), Role::Fixed),
        ["gas", _] => (GasCharge::quantities(), Role::Fixed),
        ["accumulator", _] => (Accumulator::quantities(), Role::Fixed),
        ["effects", "gas_charge_error", _] => (TermId::GasChargeError.quantities(), Role::Fixed),
        ["valve", _] => (Valve::quantities(), Role::Tunable),
        ["damper", _] => (DamperTable::quantities(), Role::Tunable),
        ["orifice", _] => (Orifice::quantities(), Role::Tunable),
        ["valve_timing", _] => (ValveTiming::quantities(), Role::Tunable),
        ["effects", term, _] => (term.parse::<TermId>().ok()?.quantities(), Role::Tunable),
        _ => return None,
    };
    let mut found = quantity(keys.last()?, table)?;
    if found.key == "response_polynomial_s" {
        found.unit = ["s", "s/MPa", "s/MPa2"].get(entry.unwrap_or(0))?;
    }
    Some((found, role))
}

/// A strut behind a table of values.
pub struct StrutUnit {
    numbers: Numbers,
    /// The parameters of which `model` is made; none before the start.
    applied: Vec<f64>,
    model: StrutModel,
    strut: Option<Strut>,
}

impl StrutUnit {
    /// Takes the parameters of a table. Returns whether there are new ones.
    fn apply(&mut self, values: &[f64]) -> Result<bool, Complaint> {
        let parameters = &values[FIRST_PARAMETER..];
        if parameters == self.applied {
            return Ok(false);
        }
        let model: StrutModel = self.numbers.model(parameters.iter().copied())?;
        model.check().map_err(Complaint::new)?;
        self.applied = parameters.to_vec();
        self.model = model;
        Ok(true)
    }
}

fn signals(values: &[f64]) -> StrutValves<bool> {
    StrutValves::from_array([0, 1, 2].map(|valve| is_on(values[FIRST_VALVE + valve])))
}

impl Model for StrutUnit {
    fn begin(&mut self, values: &[f64]) -> Result<(), Complaint> {
        self.apply(values)?;
        let strut = Strut::at_rest_at(&self.model, signals(values), values[DISPLACEMENT]);
        self.strut = Some(strut.map_err(Complaint::new)?);
        Ok(())
    }

    fn step(&mut self, values: &[f64], duration_s: f64) -> Result<(), Complaint> {
        let is_new = self.apply(values)?;
        let Some(strut) = &mut self.strut else {
            return Err(not_begun());
        };
        if is_new {
            *strut = strut.remodelled(&self.model).map_err(Complaint::new)?;
        }
        let to_m = values[DISPLACEMENT] + values[SPEED] * duration_s;
        strut.advance(to_m, duration_s, signals(values));
        Ok(())
    }

    fn outputs(&self, values: &mut [f64]) {
        let Some(strut) = &self.strut else { return };
        let (output, gas) = (strut.output(), strut.gas());
        let [p1, p2, p3, p4] = output.pressure_pa;
        let [opening1, opening2, opening3] = strut.openings().into_array();
        let [flow1, flow2] = strut.flow_m3_s();
        let [volume1, volume2] = gas.map(|gas| gas.volume_m3);
        let [temperature1, temperature2] = gas.map(|gas| gas.temperature_k);
        let outputs: [f64; OUTPUTS.len()] = [
            output.force_n,
            p1,
            p2,
            p3,
            p4,
            opening1,
            opening2,
            opening3,
            flow1,
            flow2,
            volume1,
            volume2,
            temperature1,
            temperature2,
        ];
        values[FIRST_OUTPUT..FIRST_PARAMETER].copy_from_slice(&outputs);
    }

    fn save(&self) -> Result<Vec<u8>, Complaint> {
        let strut = self.strut.as_ref().ok_or_else(not_begun)?;
        postcard::to_allocvec(&strut.snapshot()).map_err(Complaint::new)
    }

    fn load(&mut self, values: &[f64], bytes: &[u8]) -> Result<(), Complaint> {
        let kept: StrutSnapshot = postcard::from_bytes(bytes).map_err(Complaint::new)?;
        self.apply(values)?;
        let mut strut = Strut::at_rest(&self.model, StrutValves::default()).map_err(Complaint::new)?;
        strut.restore(&kept);
        self.strut = Some(strut);
        Ok(())
    }
}

fn not_begun() -> Complaint {
    Complaint::new("the model has not begun: call the functions of the initialization mode first")
}
