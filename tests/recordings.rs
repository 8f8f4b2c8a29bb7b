//! Tests whether the strut model with the known answers reproduces the labelled recordings.
//!
//! For each campaign the concealed terms are put into its model as `answer.json` states them, the rest is calibrated within
//! `[tolerance]` on the campaign's ten recordings (the calibration of `oleo diagnose`, no candidate added), and the model is
//! written. Then `oleo predict` is run with it on those recordings and on the five of `labelled-answers`, which no fit has
//! seen: on every channel the RMS of recording minus prediction is held to 1.5 x the stated noise.
//!
//! What remains above 1 is shown to be the displacement's own noise: the smoothed motion is taken for true, white noise of the
//! stated size is put on it, smoothed again and simulated, and the change of p1 and force is compared with what the
//! recordings show beyond their sensors' noise.
//!
//! `OLEO_KEEP_MODELS=FOLDER` leaves the calibrated models in an existing folder.

mod support;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use oleo_diagnose::estimation::covariance::deviations;
use oleo_diagnose::estimation::{LeastSquares, Point, fit};
use oleo_diagnose::recording::{GapPolicy, read};
use oleo_diagnose::specimen::Specimen;
use oleo_diagnose::specimen::strut::{CHANNELS, TwoStageStrut, columns};
use oleo_plant_sim::rig::RecordedStrut;
use oleo_plant_sim::strut::{
    DamperLeakage, Effects, GasChargeError, GasHeatTransfer, LineResistance, OilCompressibility, OilCount,
    SealFriction, StrutModel, TransitionShape, Valve3Leakage, ValveTransition, replay, smooth_displacement,
};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde_json::Value;

/// What is asked: RMS of recording minus prediction over the stated noise.
const MOST: f64 = 1.5;

/// Presliding stiffness of the seal, N/m, which the answers do not repeat (recordings README).
const PRESLIDING_N_M: f64 = 2e6;

/// Interval at which the recordings' simulator filters a lagging sensor, s. Its filter is `y += (1 - exp(-h/tau)) (x - y)`,
/// which leads the continuous lag by `h/2`. The answers do not say so; the recordings do: of intervals tried, this one
/// alone meets p2 of labelled-11 at every sampling rate to within its noise (docs/physics.md).
const LOG_INTERVAL_S: f64 = 1e-3;

/// Puts the concealed terms into a model's effects.
fn insert(effects: &mut Effects, truth: &Value) {
    for (id, parameters) in truth.as_object().expect("a table of effects") {
        let number = |key: &str| parameters[key].as_f64().unwrap_or(0.0);
        match id.as_str() {
            "oil_compressibility" => {
                effects.oil_compressibility = Some(OilCompressibility {
                    bulk_modulus_pa: number("bulk_modulus_Pa"),
                    counted_at: OilCount::Chamber,
                });
            }
            "gas_heat_transfer" => {
                effects.gas_heat_transfer = Some(GasHeatTransfer {
                    time_constant_1_s: number("tau1"),
                    time_constant_2_s: number("tau2"),
                });
            }
            "valve_transition" => {
                effects.valve_transition = Some(ValveTransition {
                    shape: TransitionShape::Linear,
                });
            }
            "seal_friction" => {
                effects.seal_friction = Some(SealFriction {
                    coulomb_force_n: number("seal_fc"),
                    breakaway_force_n: number("seal_fs"),
                    stribeck_speed_m_s: number("seal_vs"),
                    presliding_stiffness_n_m: PRESLIDING_N_M,
                });
            }
            "damper_leakage" => {
                effects.damper_leakage = Some(DamperLeakage {
                    flow_coefficient_1: number("leak1"),
                    flow_coefficient_2: number("leak2"),
                });
            }
            "valve3_leakage" => {
                effects.valve3_leakage = Some(Valve3Leakage {
                    flow_coefficient: number("leak3"),
                });
            }
            "gas_charge_error" => {
                effects.gas_charge_error = Some(GasChargeError {
                    relative_error_1: number("charge1"),
                    relative_error_2: number("charge2"),
                });
            }
            "line_resistance" => {
                effects.line_resistance = Some(LineResistance {
                    resistance_1_pa_s_m3: number("rvisc1"),
                    resistance_2_pa_s_m3: number("rvisc2"),
                });
            }
            "sensor_lag" => {
                let column = parameters["_lag"][0].as_str().expect("a column");
                let tau = parameters["_lag"][1].as_f64().expect("a time constant");
                effects
                    .sensor_lag
                    .get_or_insert_default()
                    .insert(column.to_owned(), tau);
                effects
                    .sensor_skew
                    .get_or_insert_default()
                    .insert(column.to_owned(), -0.5 * LOG_INTERVAL_S);
            }
            other => panic!("{other}: no term of this name is known here"),
        }
    }
}

fn csv_files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "csv"))
        .collect();
    files.sort();
    files
}

/// A labelled campaign: its recordings and, in another folder, its answer with recordings that no fit has seen.
struct Campaign {
    name: &'static str,
    model: StrutModel,
    truth: Value,
    fitted: Vec<PathBuf>,
    unseen: Vec<PathBuf>,
}

impl Campaign {
    /// `None`, with the reason printed, where the recordings are not beside this checkout.
    fn open(name: &'static str) -> Option<Self> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/recordings");
        let (recordings, answers) = (
            folder.join("labelled").join(name),
            folder.join("labelled-answers").join(name),
        );
        if !recordings.is_dir() || !answers.is_dir() {
            println!("SKIPPED: ../shared/recordings is not beside this checkout");
            return None;
        }
        println!("{name}");
        let text = fs::read_to_string(recordings.join("model.toml")).expect("a model");
        let answer = fs::read_to_string(answers.join("answer.json")).expect("an answer");
        let answer: Value = serde_json::from_str(&answer).expect("JSON");
        Some(Self {
            name,
            model: StrutModel::from_toml(&text, "model.toml").expect("a model"),
            truth: answer["truth"].clone(),
            fitted: csv_files(&recordings),
            unseen: csv_files(&answers),
        })
    }

    /// The strut of a model with the campaign's own recordings, for fitting.
    fn strut(&self, model: StrutModel) -> TwoStageStrut {
        let files = self.fitted.par_iter();
        let recordings = files.map(|path| read(path, &columns(), GapPolicy::Cut).expect("a recording"));
        TwoStageStrut::new(model, recordings.collect()).expect("a strut")
    }

    /// A model calibrated within tolerance on the campaign's own recordings.
    fn calibrate(&self, model: StrutModel) -> StrutModel {
        let strut = self.strut(model);
        let stop = AtomicBool::new(false);
        let problem = LeastSquares::new(&strut, &stop);
        let fitted = fit(&problem, Point::nominal(&strut), problem.criteria.fitting.converged).expect("a fit");
        let deviations = deviations(&fitted);
        println!("    calibration               value        in standard deviations of its prior (half its tolerance)");
        for ((p, z), d) in (strut.calibration().iter().zip(&fitted.point.z)).zip(deviations.iter()) {
            println!("    {:24} {:11.4e}  {z:6.2} +- {d:.2}", p.key, p.value(*z));
        }
        strut.applied(&fitted.point.hypothesis(&strut))
    }

    /// Runs `oleo predict` with a model on all recordings, prints the table of noise ratios and returns what is above 1.5.
    fn judge(&self, model: &StrutModel) -> Vec<String> {
        let work = tempfile::tempdir().expect("a folder");
        let model_file = work.path().join("model.toml");
        fs::write(&model_file, model.to_toml()).expect("written");
        if let Some(keep) = std::env::var_os("OLEO_KEEP_MODELS") {
            fs::copy(&model_file, Path::new(&keep).join(format!("{}.toml", self.name))).expect("kept");
        }
        let rows: Vec<Row> = (self.fitted.par_iter().map(|f| (f, "")))
            .chain(self.unseen.par_iter().map(|f| (f, "not fitted")))
            .map(|(file, remark)| Row::of(model, &model_file, file, remark, work.path()))
            .collect();
        Row::print(&rows);
        let (seen, deviation, explained) = Row::p1_beyond_its_sensor(&rows);
        println!(
            "    p1 beyond its sensor's noise, mean square over that of the noise, all recordings: {seen:.3} +- {deviation:.3}; \
             displacement noise makes {explained:.3}"
        );
        let mut above = Vec::new();
        for row in &rows {
            for (channel, ratio) in CHANNELS.iter().zip(row.ratio).filter(|(_, r)| r.is_nan() || *r > MOST) {
                above.push(format!("{} {} {channel} {ratio:.2}", self.name, row.name));
            }
        }
        if seen > 1.5 * explained + 3.0 * deviation {
            above.push(format!(
                "{} p1: {seen:.3} is more than displacement noise makes ({explained:.3})",
                self.name
            ));
        }
        above
    }
}

/// One recording predicted.
struct Row {
    name: String,
    remark: &'static str,
    /// RMS of recording minus prediction over the stated noise, by channel.
    ratio: [f64; 5],
    /// Mean square of what the displacement's noise makes of the prediction, over that of the sensor noise.
    from_displacement: [f64; 5],
    samples: usize,
}

impl Row {
    fn of(model: &StrutModel, model_file: &Path, file: &Path, remark: &'static str, work: &Path) -> Self {
        let name = file.file_stem().expect("a name").to_string_lossy().into_owned();
        let out = work.join(format!("{name}.csv"));
        let arguments = ["predict", "--model", text(model_file), text(file), "--out", text(&out)];
        let run = support::run(&arguments);
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        let recording = open(file);
        let (measured, predicted) = (channels(&recording), channels(&open(&out)));
        let ratio = std::array::from_fn(|c| mean_square(&measured[c], &predicted[c]).sqrt() / model.noise[CHANNELS[c]]);
        Self {
            name,
            remark,
            ratio,
            from_displacement: from_displacement(model, &recording),
            samples: recording.time_s.len(),
        }
    }

    /// Mean square beyond the sensor's own noise, and the standard deviation of that figure for white noise.
    fn excess(&self, channel: usize) -> (f64, f64) {
        (
            self.ratio[channel] * self.ratio[channel] - 1.0,
            (2.0 / self.samples as f64).sqrt(),
        )
    }

    /// Mean square of p1 beyond its sensor's noise, its standard deviation, and what the displacement's noise makes of p1; all
    /// over the square of the sensor's noise, mean of the recordings.
    fn p1_beyond_its_sensor(rows: &[Self]) -> (f64, f64, f64) {
        const P1: usize = 1;
        let mean = |of: &dyn Fn(&Self) -> f64| rows.iter().map(of).sum::<f64>() / rows.len() as f64;
        let variance = mean(&|r| r.excess(P1).1 * r.excess(P1).1) / rows.len() as f64;
        (
            mean(&|r| r.excess(P1).0),
            variance.sqrt(),
            mean(&|r| r.from_displacement[P1]),
        )
    }

    fn print(rows: &[Self]) {
        println!(
            "    recording         {}   excess of p1: seen, from displacement noise; of force: ditto",
            CHANNELS.map(|c| format!("{c:>8}")).join("")
        );
        for row in rows {
            let ratios = row.ratio.map(|r| format!("{r:8.2}")).join("");
            let [force, p1] = [0, 1].map(|c| format!("{:6.2} {:6.2}", row.excess(c).0, row.from_displacement[c]));
            println!("    {:17} {ratios}   {p1}  {force}  {}", row.name, row.remark);
        }
        let worst = rows.iter().flat_map(|r| r.ratio).fold(0.0, f64::max);
        println!("    worst {worst:.2}");
    }
}

/// What white noise of the stated size on the displacement makes of a prediction: mean square over that of the sensor's noise,
/// by channel. The smoothed motion of the recording stands for the true one.
fn from_displacement(model: &StrutModel, recording: &RecordedStrut) -> [f64; 5] {
    let noise_m = model.noise["displacement_m"];
    let mut inputs = recording.inputs(noise_m);
    let still = replay(model, &inputs).expect("a prediction");
    let samples: Vec<f64> = std::iter::once(inputs.motion.start_m)
        .chain(inputs.motion.segments.iter().map(|s| s.to_m))
        .collect();
    let interval = (recording.time_s[samples.len() - 1] - recording.time_s[0]) / (samples.len() - 1) as f64;
    let mut sum = [0.0; 5];
    for seed in 0..SEEDS {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let noisy: Vec<f64> = samples.iter().map(|x| x + noise_m * normal(&mut rng)).collect();
        inputs.motion = smooth_displacement(&noisy, interval, noise_m);
        let shaken = replay(model, &inputs).expect("a prediction");
        sum[0] += mean_square(&still.force_n, &shaken.force_n);
        for (to, (a, b)) in sum[1..]
            .iter_mut()
            .zip(still.pressure_pa.iter().zip(&shaken.pressure_pa))
        {
            *to += mean_square(a, b);
        }
    }
    std::array::from_fn(|c| sum[c] / SEEDS as f64 / (model.noise[CHANNELS[c]] * model.noise[CHANNELS[c]]))
}

/// Draws of displacement noise that are averaged.
const SEEDS: u64 = 4;

/// Standard normal by the sum of twelve uniform numbers: tails beyond six do not matter to a mean square. `rand_distr` would
/// draw others, and the published figures were made with these.
fn normal(rng: &mut ChaCha8Rng) -> f64 {
    (0..12)
        .map(|_| f64::from(rng.next_u32()) / 4_294_967_296.0)
        .sum::<f64>()
        - 6.0
}

fn mean_square(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / a.len() as f64
}

fn open(file: &Path) -> RecordedStrut {
    RecordedStrut::read(fs::File::open(file).expect("a file"), text(file)).expect("a recording")
}

/// Force and the four pressures.
fn channels(recording: &RecordedStrut) -> [Vec<f64>; 5] {
    let [p1, p2, p3, p4] = recording.pressure_pa.clone();
    [recording.force_n.clone(), p1, p2, p3, p4].map(|c| c.expect("recorded"))
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

fn reproduces(name: &'static str) {
    let Some(campaign) = Campaign::open(name) else { return };
    let mut model = campaign.model.clone();
    insert(&mut model.effects, &campaign.truth);
    let model = campaign.calibrate(model);
    let above = campaign.judge(&model);
    assert!(above.is_empty(), "above {MOST} x noise: {}", above.join(", "));
}

macro_rules! campaigns {
    ($($test:ident = $name:literal),* $(,)?) => { $(
        #[test]
        #[cfg_attr(debug_assertions, ignore = "seconds without optimisation; the recordings step of ./test runs it")]
        fn $test() {
            reproduces($name);
        }
    )* };
}

campaigns! {
    labelled_01 = "labelled-01", labelled_02 = "labelled-02", labelled_03 = "labelled-03", labelled_04 = "labelled-04",
    labelled_05 = "labelled-05", labelled_06 = "labelled-06", labelled_07 = "labelled-07", labelled_08 = "labelled-08",
    labelled_09 = "labelled-09", labelled_10 = "labelled-10", labelled_11 = "labelled-11", labelled_12 = "labelled-12",
}

/// The instruments of these campaigns are as their models state: nothing is said of them, and no reading is changed.
#[test]
#[cfg_attr(
    debug_assertions,
    ignore = "seconds without optimisation; the recordings step of ./test runs it"
)]
fn instruments_that_are_as_stated_are_left_alone() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/recordings");
    let mut campaigns = Vec::new();
    for kind in ["labelled", "blind"] {
        let Ok(entries) = fs::read_dir(folder.join(kind)) else {
            continue;
        };
        campaigns.extend(
            entries
                .map(|entry| entry.expect("an entry").path())
                .filter(|path| path.is_dir()),
        );
    }
    if campaigns.is_empty() {
        println!("SKIPPED: ../shared/recordings is not beside this checkout");
    }
    campaigns.sort();
    let said: Vec<String> = (campaigns.iter())
        .flat_map(|folder| {
            let campaign = oleo_diagnose::Campaign::open(folder).expect("a campaign");
            let name = folder.file_name().expect("a name").to_string_lossy().into_owned();
            let findings = campaign.specimen.instruments().iter();
            findings.map(|f| format!("{name}: {}", f.text())).collect::<Vec<_>>()
        })
        .collect();
    assert!(said.is_empty(), "{}", said.join("\n"));
}
