//! How fast and how well a strut model replays a campaign.
//!
//! `cargo run --release -p oleo-plant-sim --example campaign -- FOLDER [--model MODEL.toml] [--repeat N] [--remove-offsets]
//! [--every-term]` prints, for each recording, RMS of recording minus simulation over the sensor noise for each channel, and the time
//! for the simulations of all recordings (inputs already read and smoothed), on one core. `--every-term` switches every term
//! of the vocabulary on, for the time only: the recordings' specimens are not like that.

use std::path::Path;
use std::time::Instant;

use oleo_interface::StrutValves;
use oleo_plant_sim::strut::{Beginning, Inputs, Replay, StrutModel, replay, replay_all};

/// Every term of the vocabulary, with ordinary figures.
const EVERY_TERM: &str = r#"
oil_compressibility = { bulk_modulus_Pa = 1.4e9 }
entrained_air = { volume_fraction = 0.005, polytropic_exponent = 1.2 }
gas_heat_transfer = { time_constant_1_s = 2.6, time_constant_2_s = 6.5 }
real_gas = { equation = "reference" }
gas_charge_error = { relative_error_1 = 0.02, relative_error_2 = -0.01 }
seal_friction = { coulomb_force_N = 300.0, breakaway_force_N = 400.0, stribeck_speed_m_s = 0.02, presliding_stiffness_N_m = 2e6 }
side_load_friction = { coefficient = 0.01 }
accumulator_piston_friction = { pressure_1_Pa = 3e4, pressure_2_Pa = 2e4 }
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
sensor_skew = { p4_Pa = 0.002, displacement_m = 0.001 }
sensor_sign = { force_N = -1.0 }
sensor_offset = { p1_Pa = 1000.0 }
"#;

const CHANNELS: [&str; 5] = ["force_N", "p1_Pa", "p2_Pa", "p3_Pa", "p4_Pa"];

struct Recording {
    name: String,
    inputs: Inputs,
    measured: [Vec<f64>; 5],
}

fn read(path: &Path, noise_m: f64) -> Result<Recording, Box<dyn std::error::Error>> {
    let mut reader = csv::Reader::from_path(path)?;
    let header = reader.headers()?.clone();
    let column = |name: &str| {
        header
            .iter()
            .position(|h| h == name)
            .ok_or(format!("{}: no column {name}", path.display()))
    };
    let rows: Vec<Vec<f64>> = reader
        .records()
        .map(|r| Ok(r?.iter().map(str::parse).collect::<Result<_, _>>()?))
        .collect::<Result<_, Box<dyn std::error::Error>>>()?;
    let take = |name: &str| -> Result<Vec<f64>, Box<dyn std::error::Error>> {
        let i = column(name)?;
        Ok(rows.iter().map(|r| r[i]).collect())
    };
    let valves = [take("valve1")?, take("valve2")?, take("valve3")?];
    let signals: Vec<StrutValves<bool>> = (0..rows.len())
        .map(|i| StrutValves::from_fn(|valve| valves[valve.index()][i] > 0.5))
        .collect();
    let inputs = Inputs::from_recording(&take("time_s")?, &take("displacement_m")?, &signals, noise_m);
    let mut measured: [Vec<f64>; 5] = Default::default();
    for (to, name) in measured.iter_mut().zip(CHANNELS) {
        *to = take(name)?;
    }
    Ok(Recording {
        name: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        inputs,
        measured,
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments
        .next()
        .ok_or("usage: campaign FOLDER [--model MODEL.toml] [--repeat N] [--remove-offsets] [--every-term]")?;
    let (mut model_path, mut repeat) = (format!("{folder}/model.toml"), 1);
    let (mut offsets_removed, mut every_term) = (false, false);
    while let Some(option) = arguments.next() {
        if option == "--remove-offsets" {
            offsets_removed = true;
            continue;
        }
        if option == "--every-term" {
            every_term = true;
            continue;
        }
        let value = arguments.next().ok_or(format!("{option}: value missing"))?;
        match option.as_str() {
            "--model" => model_path = value,
            "--repeat" => repeat = value.parse()?,
            _ => return Err(format!("unknown option {option}").into()),
        }
    }
    let mut model = StrutModel::from_toml(&std::fs::read_to_string(&model_path)?, &model_path)?;
    if every_term {
        model.effects = toml::from_str(EVERY_TERM)?;
    }
    let noise_m = model.noise.get("displacement_m").copied().unwrap_or(0.0);
    let mut paths: Vec<_> = std::fs::read_dir(&folder)?
        .map(|e| e.map(|e| e.path()))
        .collect::<Result<_, _>>()?;
    paths.retain(|p| p.extension().is_some_and(|e| e == "csv"));
    paths.sort();
    let begin = Instant::now();
    let recordings: Vec<_> = paths.iter().map(|p| read(p, noise_m)).collect::<Result<_, _>>()?;
    let read_s = begin.elapsed().as_secs_f64();
    let wanted: Vec<_> = (recordings.iter())
        .map(|r| Replay {
            model: &model,
            inputs: &r.inputs,
            begins: Beginning::AtRest,
            with_course: false,
        })
        .collect();
    let mut best = f64::INFINITY;
    for _ in 0..repeat {
        let begin = Instant::now();
        for replayed in std::hint::black_box(replay_all(&wanted)) {
            replayed?;
        }
        best = best.min(begin.elapsed().as_secs_f64());
    }
    for r in &recordings {
        let out = replay(&model, &r.inputs)?;
        let simulated: [&Vec<f64>; 5] = [
            &out.force_n,
            &out.pressure_pa[0],
            &out.pressure_pa[1],
            &out.pressure_pa[2],
            &out.pressure_pa[3],
        ];
        let ratio = |i: usize| {
            let noise = model.noise.get(CHANNELS[i]).copied().unwrap_or(1.0);
            let n = r.measured[i].len() as f64;
            let residual = || r.measured[i].iter().zip(simulated[i]).map(|(a, b)| (a - b) / noise);
            // Offsets are calibration: shown without them on request.
            let mean = if offsets_removed {
                residual().sum::<f64>() / n
            } else {
                0.0
            };
            (residual().map(|r| (r - mean) * (r - mean)).sum::<f64>() / n).sqrt()
        };
        let ratios: Vec<String> = (0..5).map(|i| format!("{} {:7.2}", CHANNELS[i], ratio(i))).collect();
        println!("{:16} {}", r.name, ratios.join("  "));
    }
    let simulated: f64 = recordings.iter().filter_map(|r| r.inputs.time_s.last()).sum();
    println!(
        "{simulated:.0} s in {:.1} ms, {:.0} x real time on one core; reading and smoothing {:.0} ms",
        best * 1e3,
        simulated / best,
        read_s * 1e3
    );
    Ok(())
}
