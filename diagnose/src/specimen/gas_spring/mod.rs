//! A gas spring: one chamber, one pressure. The adiabat (or isotherm) is what is believed; what may be missing is heat
//! transfer, and, as rivals that would look like it, a polytropic exponent, a leak and the faults of the instrument.

mod calibration;

use oleo_plant_sim::model_file::InvalidValue;
use oleo_plant_sim::specimen::{GasSpringModel, smooth_motion};

use super::channel::{Channel, StateSeries};
use super::contract::{BelievedModel, Specimen};
use super::drawing::Drawing;
use super::hypothesis::Hypothesis;
use super::single_output::{SingleOutput, SingleOutputSpecimen};
use crate::effect::sensor::{self, PRESSURE_OF_GAS_SPRING as PRESSURE};
use crate::effect::{ALL, Candidate, of};
use crate::error::DiagnoseError;
use crate::excitation::{self, Clock, corners};
use crate::recording::{ColumnKind, ColumnSpec, GapPolicy, Recording};
use crate::vocabulary::SpecimenKind;
use crate::vocabulary::{Column, EffectId, Place, Site, State};

/// Half window over which the motion is smoothed for its speed, in samples.
const SMOOTHING_SAMPLES: f64 = 5.0;

/// What is believed of a gas spring, and what the corners of its motion say about the clocks.
pub struct GasSpring {
    model: GasSpringModel,
    /// One a recording, where it has corners enough.
    clocks: Vec<Option<Clock>>,
}

impl BelievedModel for GasSpringModel {
    fn columns(&self) -> Vec<ColumnSpec> {
        vec![
            ColumnSpec::new("displacement_m", ColumnKind::Input),
            ColumnSpec::new("p_Pa", ColumnKind::Output),
        ]
    }

    fn check_noise(&self) -> Result<(), InvalidValue> {
        self.check_noise_is_complete()
    }

    fn gap_policy(&self) -> GapPolicy {
        GapPolicy::Cut
    }

    fn with_recordings(self: Box<Self>, recordings: Vec<Recording>) -> Result<Box<dyn Specimen>, DiagnoseError> {
        let channel =
            Channel::of(PRESSURE, &self.noise).map_err(|invalid| DiagnoseError::Model(invalid.to_string()))?;
        let clocks: Vec<Option<Clock>> = recordings.iter().map(|r| clock(&self, r, channel.noise)).collect();
        let read: Vec<Clock> = clocks.iter().copied().flatten().collect();
        let excitation = excitation::GasSpring::of(&recordings, channel.noise, read);
        Ok(Box::new(SingleOutputSpecimen {
            calibration: calibration::parameters(&self, &recordings),
            candidates: candidates(&self, &excitation),
            kind: GasSpring { model: *self, clocks },
            recordings,
            channel,
        }))
    }
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

/// What the corners of the motion say about the clocks.
fn remark(recording: &Recording, clock: &Clock) -> String {
    let [low, middle, high] = clock.delay_s;
    let verdict = if clock.is_late(recording.interval_s()) {
        "no gas can cause this, so the clocks of the two columns differ"
    } else {
        "as far as the corners show, the two columns have one clock"
    };
    format!(
        "{}: at {} corners of the motion p_Pa follows displacement_m after {middle:.2} s ({low:.2} to {high:.2} s), \
         with an exponent of {:.2} to {:.2} there; {verdict}",
        recording.name, clock.corners, -clock.slope[1], -clock.slope[0]
    )
}

/// Everything that a gas spring's model may lack: physics, laws without a name, then the instrument.
fn candidates(model: &GasSpringModel, excitation: &excitation::GasSpring) -> Vec<Candidate> {
    let of_effect = |id: EffectId| {
        of(id)
            .in_gas_spring()
            .map_or(vec![], |e| e.candidates(model, excitation))
    };
    let physics = ALL.iter().copied().filter(|id| id.is_physics());
    (physics.chain([EffectId::Unlisted]).chain(sensor::IN_ORDER))
        .flat_map(of_effect)
        .map(|candidate| candidate.testable_unless(excitation.still.clone()))
        .collect()
}

impl SingleOutput for GasSpring {
    type Model = GasSpringModel;

    fn kind(&self) -> SpecimenKind {
        SpecimenKind::GasSpring
    }

    fn inputs_in_words(&self) -> &'static str {
        "displacement and the first pressure"
    }

    fn applied(&self, candidates: &[Candidate], hypothesis: &Hypothesis) -> GasSpringModel {
        let mut model = self.model.clone();
        calibration::calibrate(&mut model, &hypothesis.calibration);
        for (index, values) in &hypothesis.effects {
            let candidate = &candidates[*index];
            if let Some(effect) = of(candidate.id).in_gas_spring() {
                effect.put(&mut model, candidate, values);
            }
        }
        model
    }

    fn output(&self, model: &GasSpringModel, recording: &Recording, _index: usize) -> Result<Vec<f64>, String> {
        let [x, p] = [&recording.columns[0], &recording.columns[1]];
        model.pressure_pa(&recording.time_s, x, p[0])
    }

    fn shown(&self, model: &GasSpringModel, time_s: &[f64], output: Vec<f64>) -> Vec<f64> {
        model.shown(time_s, output)
    }

    fn to_toml(&self, model: &GasSpringModel) -> Result<String, String> {
        model.to_toml()
    }

    fn states(&self, recording: &Recording, _index: usize) -> Vec<StateSeries> {
        let x = &recording.columns[0];
        let motion = smooth_motion(&recording.time_s, x, SMOOTHING_SAMPLES * recording.interval_s());
        vec![
            StateSeries::new(State::Displacement, x.clone()),
            StateSeries::new(State::Speed, motion.speed_m_s),
            StateSeries::new(State::Pressure, recording.columns[1].clone()),
        ]
    }

    fn remarks(&self, recordings: &[Recording]) -> Vec<String> {
        (recordings.iter().zip(&self.clocks))
            .filter_map(|(recording, clock)| clock.as_ref().map(|clock| remark(recording, clock)))
            .collect()
    }

    fn drawing(&self, found: &[&Place]) -> String {
        let mut d = Drawing::new(900, 150, found);
        d.block((60, 55, 90, 40), "rod", false);
        d.line("150,75 330,75", false);
        d.block((330, 30, 40, 90), "pis-|ton", false);
        d.site((370, 30, 300, 90), "gas chamber", Site::Chamber);
        d.sensor((240, 50), "x", Column::DISPLACEMENT);
        d.line("670,75 740,75", false);
        d.sensor((760, 75), "p", PRESSURE);
        d.svg()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_where_something_may_be_missing_is_drawn() {
        let wave = |size: f64| {
            (0..200)
                .map(|k| size * libm::sin(0.1 * f64::from(k)))
                .collect::<Vec<f64>>()
        };
        let recording = Recording {
            name: "strokes".into(),
            time_s: (0..200).map(|k| 0.01 * f64::from(k)).collect(),
            columns: vec![wave(0.1), wave(500.0), wave(1e6)],
            notes: vec![],
        };
        let text = "[specimen]\nname = \"a\"\nkind = \"gas spring\"\n[chamber]\narea_m2 = 0.01\nvolume_at_zero_m3 = 0.05\n\
                    [gas]\nspecies = \"nitrogen\"\nprocess = \"adiabatic\"\ntemperature_K = 293.15\n";
        let model = GasSpringModel::from_toml(text, "model.toml").expect("a model");
        let all = candidates(&model, &excitation::GasSpring::of(&[recording], 690.0, vec![]));
        let spring = GasSpring { model, clocks: vec![] };
        assert!(all.len() > 5 && !spring.drawing(&[]).contains("found\""));
        for candidate in all {
            assert!(
                spring.drawing(&[&candidate.place]).contains("found\""),
                "{}",
                candidate.name()
            );
        }
    }
}
