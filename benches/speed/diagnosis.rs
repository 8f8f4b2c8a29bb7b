//! What a diagnosis does thousands of times: simulates a campaign at other values, and takes the derivatives of a fit.

use std::f64::consts::TAU;
use std::sync::atomic::AtomicBool;

use divan::Bencher;
use oleo_diagnose::estimation::{Evaluation, Point};
use oleo_diagnose::recording::Recording;
use oleo_diagnose::specimen::strut::TwoStageStrut;
use oleo_interface::StrutValves;
use oleo_plant_sim::strut::{Inputs, StrutModel, replay};

/// Never asks to stop.
static RUN: AtomicBool = AtomicBool::new(false);

/// A campaign of two recordings of 10 s at 200 Hz: sines of 20 mm at 0.5 and 2 Hz, valve 3 switched every second. What was
/// recorded is what the preset predicts.
fn campaign() -> TwoStageStrut {
    let mut model = StrutModel::defender110(8000.0);
    let tolerances = [
        ("static_gas_volume", 0.02),
        ("flow_coefficient", 0.03),
        ("pressure_offset_Pa", 1e4),
    ];
    model
        .tolerance
        .extend(tolerances.map(|(what, size)| (what.to_owned(), size)));
    let time_s: Vec<f64> = (0..2000).map(|k| 0.005 * f64::from(k)).collect();
    let recordings = [0.5, 2.0].map(|hz| {
        let displacement_m: Vec<f64> = time_s.iter().map(|t| 0.02 * libm::sin(TAU * hz * t)).collect();
        let open: Vec<bool> = time_s.iter().map(|t| (*t as u64).is_multiple_of(2)).collect();
        let signals: Vec<StrutValves<bool>> = open.iter().map(|open| StrutValves::new(false, false, *open)).collect();
        let out = replay(
            &model,
            &Inputs::from_recording(&time_s, &displacement_m, &signals, 5e-6),
        )
        .expect("a prediction");
        let signal = |valve: usize| {
            open.iter()
                .map(|open| f64::from(u8::from(*open && valve == 3)))
                .collect()
        };
        let mut columns = vec![displacement_m, out.force_n];
        columns.extend(out.pressure_pa);
        columns.extend([1, 2, 3].map(signal));
        Recording {
            name: format!("sine of {hz} Hz"),
            time_s: time_s.clone(),
            columns,
            notes: vec![],
        }
    });
    TwoStageStrut::new(model, recordings.into()).expect("a strut")
}

/// Residuals of both recordings at one point.
#[divan::bench(sample_count = 20)]
fn evaluation(bencher: Bencher) {
    let strut = campaign();
    let (evaluation, point) = (Evaluation::new(&strut, &RUN), Point::nominal(&strut));
    bencher.bench_local(|| evaluation.residuals_at(&point).map(|r| r.len()));
}

/// Residuals and their derivatives with respect to everything that is calibrated.
#[divan::bench(sample_count = 10)]
fn derivatives(bencher: Bencher) {
    let strut = campaign();
    let (evaluation, point) = (Evaluation::new(&strut, &RUN), Point::nominal(&strut));
    let all: Vec<usize> = (0..point.z.len()).collect();
    bencher.bench_local(|| evaluation.sensitivities(&point, &all, None).map(|s| s.len()));
}
