//! What of a gas spring's model may be off, and what it may lack.

use oleo_plant_sim::specimen::GasSpringModel;

use super::corner::Clock;
use crate::parameter::Parameter;
use crate::recording::Recording;
use crate::specimen::candidate::{Candidate, ExclusionGroup};
use crate::specimen::extent::Extent;
use crate::specimen::instrument;
use crate::vocabulary::{Column, EffectId, Site};

/// The pressure, absolute.
pub const PRESSURE: Column = Column::known("p_Pa");
/// Label of the law `dm/dt = -k m`.
pub const GAS_LOST: &str = "gas lost";
/// Label of the law `p V^n = constant`.
pub const POLYTROPIC_EXPONENT: &str = "polytropic exponent";

/// Fraction of the corners that must be late but sharp for a lag to be ruled out.
const MOSTLY: f64 = 0.8;
/// A piston that has moved this far ...
const MOVED_M: f64 = 0.005;
/// ... within this time of the first sample was not at rest.
const SETTLED_S: f64 = 3.0;
/// Temperature change of an adiabatic stroke by a third of the volume, K.
const STROKE_TEMPERATURE_K: f64 = 50.0;
/// The pressure must move by this many times its noise before anything can be tested.
const LEAST_MOVE: f64 = 8.0;

/// Parameters of the calibration, in the order of [`calibrate`].
pub fn calibration(model: &GasSpringModel, recordings: &[Recording]) -> Vec<Parameter> {
    let tolerance = |key: &str, otherwise: f64| model.tolerance.get(key).copied().unwrap_or(otherwise);
    // A recording that begins in the middle of a stroke begins with gas that has just been compressed or let out: by how
    // much nobody knows, at most as much as an adiabatic stroke makes of it.
    let initial_temperature = if recordings.iter().any(begins_in_motion) {
        STROKE_TEMPERATURE_K
    } else {
        tolerance("temperature_K", 5.0)
    };
    let mut parameters = vec![
        Parameter::calibration("volume_at_zero", tolerance("volume_at_zero", 0.02)),
        Parameter::calibration("initial_pressure", tolerance("initial_pressure", 0.01)),
        Parameter::calibration("initial_temperature_difference_K", initial_temperature),
    ];
    if model.effects.gas_heat_transfer.is_some() {
        parameters.push(Parameter::calibration(
            "time_constant",
            tolerance("time_constant", 0.08),
        ));
    }
    parameters
}

/// Puts deviations into a model.
pub fn calibrate(model: &mut GasSpringModel, deviations: &[f64]) {
    let gas = &mut model.gas;
    model.chamber.volume_at_zero_m3 *= 1.0 + deviations[0];
    gas.initial_pressure_error = (1.0 + gas.initial_pressure_error) * (1.0 + deviations[1]) - 1.0;
    gas.initial_temperature_difference_k += deviations[2];
    if let (Some(heat), Some(error)) = (&mut model.effects.gas_heat_transfer, deviations.get(3)) {
        heat.time_constant_s *= 1.0 + error;
    }
}

fn begins_in_motion(recording: &Recording) -> bool {
    let x = &recording.columns[0];
    let early = x.iter().take_while(|v| (*v - x[0]).abs() < MOVED_M).count();
    early < recording.len() && recording.time_s[early] - recording.time_s[0] < SETTLED_S
}

/// Everything that the model may lack; `clocks` of the recordings whose motion has corners.
pub fn candidates(model: &GasSpringModel, extent: &Extent, noise_pa: f64, clocks: &[Clock]) -> Vec<Candidate> {
    let still = (extent.spread(1) < LEAST_MOVE * noise_pa).then(|| {
        "the pressure moves by less than eight times its noise; record strokes of a tenth of the volume".to_owned()
    });
    let plain = |id, label: &str, parameter| Candidate {
        id,
        place: Site::Chamber.into(),
        label: label.to_owned(),
        parameters: vec![parameter],
        starts: vec![],
        group: None,
        untestable: still.clone(),
    };
    let process = |candidate: Candidate| Candidate {
        group: Some(ExclusionGroup::GasProcess),
        ..candidate
    };
    let mut all = Vec::new();
    if model.effects.gas_heat_transfer.is_none() {
        let time_constant = Parameter::log("time_constant_s", 10.0, (0.02, 3000.0));
        all.push(Candidate {
            starts: vec![vec![1.0], vec![60.0]],
            ..process(plain(EffectId::GasHeatTransfer, "", time_constant))
        });
        let exponent = Parameter::linear("polytropic_exponent", 1.2, 0.05, (1.0, 1.67));
        all.push(process(plain(EffectId::Unlisted, POLYTROPIC_EXPONENT, exponent)));
    }
    if model.effects.gas_leak_rate_1_s.is_none() {
        let rate = 0.1 / extent.duration_s.max(1.0);
        let lost = Parameter::linear("rate_1_s", 0.0, 0.1 * rate, (-10.0 * rate, 10.0 * rate));
        all.push(plain(EffectId::Unlisted, GAS_LOST, lost));
    }
    let mut faults = instrument::faults(&PRESSURE, extent.spread(1), extent.duration_s, extent.interval_s);
    for fault in &mut faults {
        fault.untestable.clone_from(&still);
        limit_by_clocks(fault, clocks, extent.interval_s);
    }
    all.extend(faults);
    all
}

/// A time skew is the great impostor of heat transfer over a whole stroke, but not at its corners: where those are sharp
/// enough to read the delay off, a skew may only be what they show, and what is late but sharp there does not lag.
fn limit_by_clocks(fault: &mut Candidate, clocks: &[Clock], interval_s: f64) {
    let late_but_sharp = !clocks.is_empty() && clocks.iter().all(|c| c.is_late(interval_s) && c.sharp > MOSTLY);
    let delays = (clocks.iter())
        .map(|c| c.delay_s)
        .reduce(|a, b| [a[0].min(b[0]), 0.5 * (a[1] + b[1]), a[2].max(b[2])]);
    let parameter = match (fault.id, delays) {
        (EffectId::SensorLag, _) if late_but_sharp => {
            Parameter::amount("time_constant_s", 0.5 * interval_s, interval_s)
        }
        (EffectId::SensorSkew, Some([low, middle, high])) => {
            let range = (low - 2.0 * interval_s, high + 2.0 * interval_s);
            let start = if middle.abs() > interval_s { middle } else { 0.0 };
            Parameter::linear("delay_s", start, interval_s, range)
        }
        _ => return,
    };
    fault.parameters = vec![parameter.on_instrument()];
}
