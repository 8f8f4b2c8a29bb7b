//! A run as a recording of one strut: what a test rig would have recorded of the strut while the vehicle drove, with the model that
//! the plant has of it. `oleo diagnose` takes both as a campaign.
//!
//! The recording has a row for each integration step of the vehicle, because pressures change within a tick. The displacement and
//! the switching signals are the inputs, force and pressures the readings. Each gets the white noise that the model states for its
//! channel. A second at rest before the start shows the offsets of the sensors.

use oleo_interface::tick::TICK_S;
use oleo_interface::{Corner, PressurePoint, Valve};
use oleo_plant_sim::strut::StrutModel;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use crate::record::StrutStep;
use crate::run::Outcome;
use crate::scenario::Scenario;

/// Time at rest before the run, s.
const REST_S: f64 = 1.0;
/// Random streams of recordings begin here; those of faults are below.
const FIRST_STREAM: u64 = 1 << 40;

/// The recording of one strut, and the model of it.
#[derive(Clone, Debug)]
pub struct StrutRecording {
    /// Columns of the recording in their order, SI, all of one length.
    pub columns: Vec<(String, Vec<f64>)>,
    /// The model that the plant computes the strut with, charged for the load that it carries.
    pub model: StrutModel,
}

impl StrutRecording {
    /// The strut of a corner. The same run gives the same recording.
    pub fn of(scenario: &Scenario, outcome: &Outcome, corner: Corner) -> Self {
        let mut model = outcome.plant.assembly.struts[corner].clone();
        model.specimen.name = format!("{} {}", scenario.name, corner.name());
        let recording = &outcome.plant.recording;
        let (samples, steps) = (&recording.samples, &recording.strut_steps);
        let step_s = recording.step_s;
        let (rest, a_tick) = (
            (REST_S / step_s).round() as usize,
            (TICK_S / step_s).round().max(1.0) as usize,
        );
        // Before the first step the vehicle stands still on its struts.
        let start = samples.first().map(|sample| StrutStep {
            displacement_m: sample.displacement_m,
            strut: sample.strut,
        });
        let at = |row: usize| match row.checked_sub(rest + 1) {
            Some(step) => steps.get(step).copied(),
            None => start,
        };
        // The command of a tick acts from its begin; the state at the end of the last one has none.
        let rows = if steps.is_empty() { 0 } else { rest + steps.len() };
        let mut random = ChaCha8Rng::seed_from_u64(scenario.seed);
        random.set_stream(FIRST_STREAM + corner.index() as u64);
        let mut columns: Vec<(String, Vec<f64>)> =
            vec![("time_s".into(), (0..rows).map(|i| i as f64 * step_s).collect())];
        let mut reading = |name: &str, value: &dyn Fn(&StrutStep) -> f64| {
            let noise = model.noise.get(name).copied().unwrap_or(0.0);
            let values = (0..rows).filter_map(at).map(|sample| {
                let standard: f64 = StandardNormal.sample(&mut random);
                value(&sample) + noise * standard
            });
            columns.push((name.to_owned(), values.collect()));
        };
        reading("displacement_m", &|s| s.displacement_m[corner]);
        reading("force_N", &|s| s.strut[corner].force_n);
        for point in PressurePoint::ALL {
            reading(&format!("{}_Pa", point.key()), &|s| {
                s.strut[corner].pressure_pa[point.index()]
            });
        }
        for valve in Valve::ALL {
            let open = (0..rows).map(|row| {
                // All valves are closed before the first tick.
                let sample = row.checked_sub(rest).and_then(|step| samples.get(step / a_tick));
                f64::from(u8::from(sample.is_some_and(|s| s.energised.is_open(corner, valve))))
            });
            columns.push((format!("valve{}", valve.number()), open.collect()));
        }
        Self { columns, model }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{run, scenario};

    #[test]
    fn a_recording_begins_at_rest_and_has_the_noise_that_its_model_states() {
        let scenario = Scenario {
            ticks: 600,
            ..scenario::named("belgian").unwrap()
        };
        let vehicle = run::vehicle(&scenario).unwrap().recording_struts();
        let outcome = run::both(&scenario, vehicle, 1, &mut |_| true).unwrap();
        let recording = StrutRecording::of(&scenario, &outcome, Corner::RearLeft);
        let column = |name: &str| {
            let found = recording.columns.iter().find(|(other, _)| other == name);
            &found.expect("a column").1
        };
        let (rest, rows) = (1000, 4000);
        assert!(recording.columns.iter().all(|(_, values)| values.len() == rows));
        assert_eq!((column("time_s")[1], column("time_s")[rows - 1]), (0.001, 3.999));
        assert_eq!(recording.columns.len(), 10);
        let still = &column("p1_Pa")[..rest];
        let mean = still.iter().sum::<f64>() / rest as f64;
        let deviation = (still.iter().map(|p| (p - mean) * (p - mean)).sum::<f64>() / rest as f64).sqrt();
        assert!(
            (deviation / recording.model.noise["p1_Pa"] - 1.0).abs() < 0.1,
            "{deviation}"
        );
        // It is charged for the rear's load, and carries it.
        let force_n = column("force_N")[..rest].iter().sum::<f64>() / rest as f64;
        assert!(
            (force_n / (mean * recording.model.piston_area_m2()) - 1.0).abs() < 0.02,
            "{force_n}"
        );
        assert!(column("valve1")[..rest].iter().all(|open| *open == 0.0));
        assert!(
            column("displacement_m")[rest..].iter().any(|x| x.abs() > 0.01),
            "it moves"
        );
        let again = StrutRecording::of(&scenario, &outcome, Corner::RearLeft);
        assert_eq!(again.columns, recording.columns);
    }
}
