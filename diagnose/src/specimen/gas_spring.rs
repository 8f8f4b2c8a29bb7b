//! A gas spring: one chamber, one pressure. The adiabat (or isotherm) is the belief; what may be missing is heat
//! transfer, and, as rivals that would look like it, a polytropic exponent, a leak and the faults of the instrument.

use oleo_plant_sim::specimen::{GasHeatTransferTerm, GasSpringModel};

use super::corner::{Clock, corners};
use super::{Candidate, Channel, ExclusionGroup, Hypothesis, Series, Specimen, StateSeries, instrument};
use crate::parameter::Parameter;
use crate::recording::{ColumnKind, ColumnSpec, Recording};
use crate::vocabulary::{Column, EffectId, Site, State};

/// The pressure, absolute.
const PRESSURE: Column = Column::known("p_Pa");
/// Noise assumed where the model file states none: a tenth of a psi, the resolution of common gauges.
const DEFAULT_NOISE_PA: f64 = 690.0;

/// Part of the corners that decides.
const MOSTLY: f64 = 0.8;
/// A piston that has moved this far ...
const MOVED_M: f64 = 0.005;
/// ... within this time of the first sample was not at rest.
const SETTLED_S: f64 = 3.0;
/// Temperature change of an adiabatic stroke by a third of the volume, K.
const STROKE_TEMPERATURE_K: f64 = 50.0;

/// A gas spring with its recordings.
pub struct GasSpring {
    model: GasSpringModel,
    recordings: Vec<Recording>,
    channels: Vec<Channel>,
    calibration: Vec<Parameter>,
    candidates: Vec<Candidate>,
}

/// Columns of a gas spring's recording.
#[must_use]
pub fn columns() -> Vec<ColumnSpec> {
    vec![
        ColumnSpec {
            name: "displacement_m".into(),
            kind: ColumnKind::Input,
        },
        ColumnSpec {
            name: "p_Pa".into(),
            kind: ColumnKind::Output,
        },
    ]
}

/// Standard deviation of the pressure's noise, Pa.
fn noise_pa(model: &GasSpringModel) -> f64 {
    let stated = model.noise.get("p_Pa").copied();
    stated.filter(|n| *n > 0.0).unwrap_or(DEFAULT_NOISE_PA)
}

/// Corners of the motion in one recording: logarithm of the volume against logarithm of the pressure, whose slope there
/// is the exponent of the fast process, about that of the adiabat whatever the gas does afterwards.
fn clock(model: &GasSpringModel, recording: &Recording, noise_pa: f64) -> Option<Clock> {
    let volume = |x: &f64| libm::log((model.chamber.volume_at_zero_m3 - model.chamber.area_m2 * x).max(1e-9));
    let cause: Vec<f64> = recording.columns[0].iter().map(volume).collect();
    let effect: Vec<f64> = recording.columns[1].iter().map(|p| libm::log(p.max(1.0))).collect();
    let mean = recording.columns[1].iter().sum::<f64>() / recording.len() as f64;
    Clock::of(&corners(&recording.time_s, &cause, &effect, noise_pa / mean.max(1.0)))
}

/// What the corners of the motion say about the clocks, one line a recording.
#[must_use]
pub fn corner_remarks(model: &GasSpringModel, recordings: &[Recording]) -> Vec<String> {
    let noise = noise_pa(model);
    (recordings.iter())
        .filter_map(|r| clock(model, r, noise).map(|c| (r, c)))
        .map(|(r, c)| {
            let [low, middle, high] = c.delay_s;
            let verdict = if c.is_late(r.interval_s()) {
                "no gas does that: the clocks of the two columns differ"
            } else {
                "one clock, as far as the corners tell"
            };
            format!(
                "{}: at {} corners of the motion p_Pa follows displacement_m after {middle:.2} s ({low:.2} to {high:.2} s), \
                 with an exponent of {:.2} to {:.2} there; {verdict}",
                r.name, c.corners, -c.slope[1], -c.slope[0]
            )
        })
        .collect()
}

impl GasSpring {
    /// Puts model and recordings together.
    #[must_use]
    pub fn new(model: GasSpringModel, recordings: Vec<Recording>) -> Self {
        let tolerance = |key: &str, otherwise: f64| model.tolerance.get(key).copied().unwrap_or(otherwise);
        // A recording that begins in the middle of a stroke begins with gas that has just been compressed or let out: by
        // how much nobody knows, at most as much as an adiabatic stroke makes of it.
        let moving = recordings.iter().any(|r| {
            let early = r.columns[0]
                .iter()
                .take_while(|x| (*x - r.columns[0][0]).abs() < MOVED_M)
                .count();
            early < r.len() && r.time_s[early] - r.time_s[0] < SETTLED_S
        });
        let initial_temperature = if moving {
            STROKE_TEMPERATURE_K
        } else {
            tolerance("temperature_K", 5.0)
        };
        let mut calibration = vec![
            Parameter::calibration("volume_at_zero", tolerance("volume_at_zero", 0.02)),
            Parameter::calibration("initial_pressure", tolerance("initial_pressure", 0.01)),
            Parameter::calibration("initial_temperature_difference_K", initial_temperature),
        ];
        let spread = |c: usize| {
            recordings
                .iter()
                .map(|r| {
                    let (low, high) = r.columns[c]
                        .iter()
                        .fold((f64::MAX, f64::MIN), |(a, b), &v| (a.min(v), b.max(v)));
                    high - low
                })
                .fold(0.0, f64::max)
        };
        let noise = noise_pa(&model);
        let duration = recordings
            .iter()
            .map(|r| r.time_s[r.len() - 1] - r.time_s[0])
            .fold(0.0, f64::max);
        let interval = recordings.iter().map(Recording::interval_s).fold(0.0, f64::max);
        let still = (spread(1) < 8.0 * noise).then(|| {
            "the pressure moves by less than eight times its noise; record strokes of a tenth of the volume".to_owned()
        });
        let plain = |id, label: &str, parameter, starts| Candidate {
            id,
            place: Site::Chamber.into(),
            label: label.to_owned(),
            parameters: vec![parameter],
            starts,
            group: None,
            untestable: still.clone(),
        };
        let mut candidates = Vec::new();
        match &model.effects.gas_heat_transfer {
            Some(_) => calibration.push(Parameter::calibration(
                "time_constant",
                tolerance("time_constant", 0.08),
            )),
            None => candidates.push(Candidate {
                group: Some(ExclusionGroup::GasProcess),
                ..plain(
                    EffectId::GasHeatTransfer,
                    "",
                    Parameter::log("time_constant_s", 10.0, (0.02, 3000.0)),
                    vec![vec![1.0], vec![60.0]],
                )
            }),
        }
        if model.effects.gas_heat_transfer.is_none() {
            candidates.push(Candidate {
                group: Some(ExclusionGroup::GasProcess),
                ..plain(
                    EffectId::Unlisted,
                    "polytropic exponent",
                    Parameter::linear("polytropic_exponent", 1.2, 0.05, (1.0, 1.67)),
                    vec![],
                )
            });
        }
        if model.effects.gas_leak_rate_1_s.is_none() {
            let rate = 0.1 / duration.max(1.0);
            candidates.push(plain(
                EffectId::Unlisted,
                "gas lost",
                Parameter::linear("rate_1_s", 0.0, 0.1 * rate, (-10.0 * rate, 10.0 * rate)),
                vec![],
            ));
        }
        // A time skew is the great impostor of heat transfer over a whole stroke, but not at its corners: where those
        // are sharp enough to read the delay off, a skew may only be what they show; and what is late but sharp there does
        // not lag.
        let clocks: Vec<Clock> = recordings.iter().filter_map(|r| clock(&model, r, noise)).collect();
        let late_but_sharp = !clocks.is_empty() && clocks.iter().all(|c| c.is_late(interval) && c.sharp > MOSTLY);
        let delays = (clocks.iter())
            .map(|c| c.delay_s)
            .reduce(|a, b| [a[0].min(b[0]), 0.5 * (a[1] + b[1]), a[2].max(b[2])]);
        candidates.extend(
            instrument::faults(&PRESSURE, spread(1), duration, interval)
                .into_iter()
                .map(|mut c| {
                    c.untestable.clone_from(&still);
                    if c.id == EffectId::SensorLag && late_but_sharp {
                        c.parameters =
                            vec![Parameter::amount("time_constant_s", 0.5 * interval, interval).on_instrument()];
                    }
                    if let (EffectId::SensorSkew, Some([low, middle, high])) = (c.id, delays) {
                        let range = (low - 2.0 * interval, high + 2.0 * interval);
                        let start = if middle.abs() > interval { middle } else { 0.0 };
                        c.parameters = vec![Parameter::linear("delay_s", start, interval, range).on_instrument()];
                    }
                    c
                }),
        );
        let channels = vec![Channel {
            column: PRESSURE,
            noise,
        }];
        Self {
            model,
            recordings,
            channels,
            calibration,
            candidates,
        }
    }

    fn applied(&self, hypothesis: &Hypothesis) -> GasSpringModel {
        let mut model = self.model.clone();
        let c = &hypothesis.calibration;
        model.chamber.volume_at_zero_m3 *= 1.0 + c[0];
        model.gas.initial_pressure_error = (1.0 + model.gas.initial_pressure_error) * (1.0 + c[1]) - 1.0;
        model.gas.initial_temperature_difference_k += c[2];
        if let (Some(heat), Some(error)) = (model.effects.gas_heat_transfer.as_mut(), c.get(3)) {
            heat.time_constant_s *= 1.0 + error;
        }
        for (index, values) in &hypothesis.effects {
            let candidate = &self.candidates[*index];
            let value = values[0];
            let column = |effect: &mut Option<oleo_plant_sim::strut::SensorEffect>| {
                effect.get_or_insert_default().insert("p_Pa".into(), value);
            };
            match (candidate.id, candidate.label.as_str()) {
                (EffectId::GasHeatTransfer, _) => {
                    model.effects.gas_heat_transfer = Some(GasHeatTransferTerm { time_constant_s: value });
                }
                (EffectId::Unlisted, "gas lost") => model.effects.gas_leak_rate_1_s = Some(value),
                (EffectId::Unlisted, _) => model.effects.polytropic_exponent = Some(value),
                (EffectId::SensorLag, _) => column(&mut model.effects.sensor_lag),
                (EffectId::SensorSkew, _) => column(&mut model.effects.sensor_skew),
                (EffectId::SensorGain, _) => column(&mut model.effects.sensor_gain),
                _ => column(&mut model.effects.sensor_drift),
            }
        }
        model
    }
}

impl Specimen for GasSpring {
    fn kind(&self) -> &'static str {
        "gas spring"
    }
    fn is_cheap(&self) -> bool {
        true
    }
    fn channels(&self) -> &[Channel] {
        &self.channels
    }
    fn recordings(&self) -> usize {
        self.recordings.len()
    }
    fn recording_name(&self, recording: usize) -> &str {
        &self.recordings[recording].name
    }
    fn time_s(&self, recording: usize) -> &[f64] {
        &self.recordings[recording].time_s
    }
    fn measured(&self, recording: usize, _channel: usize) -> &[f64] {
        &self.recordings[recording].columns[1]
    }
    fn calibration(&self) -> &[Parameter] {
        &self.calibration
    }
    fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }
    fn simulate(&self, hypothesis: &Hypothesis, recording: usize) -> Result<Series, String> {
        let r = &self.recordings[recording];
        Ok(vec![self.applied(hypothesis).pressure_pa(
            &r.time_s,
            &r.columns[0],
            r.columns[1][0],
        )?])
    }
    fn observe(&self, hypothesis: &Hypothesis, recording: usize, truth: &Series) -> Series {
        vec![
            self.applied(hypothesis)
                .shown(&self.recordings[recording].time_s, truth[0].clone()),
        ]
    }
    fn model_toml(&self, hypothesis: &Hypothesis) -> Result<String, String> {
        self.applied(hypothesis).to_toml()
    }
    fn states(&self, recording: usize) -> Vec<StateSeries> {
        let r = &self.recordings[recording];
        let motion = oleo_plant_sim::specimen::smooth_motion(&r.time_s, &r.columns[0], 5.0 * r.interval_s());
        vec![
            StateSeries::new(State::Displacement, r.columns[0].clone()),
            StateSeries::new(State::Speed, motion.speed_m_s),
            StateSeries::new(State::Pressure, r.columns[1].clone()),
        ]
    }
}
