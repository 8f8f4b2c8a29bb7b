//! How fast and how well a strut model replays a campaign.
//!
//! `cargo run --release -p oleo-plant-sim --example campaign -- FOLDER [--model MODEL.toml] [--repeat N] [--remove-offsets]`
//! prints, for each recording, RMS of recording minus simulation over the sensor noise for each channel, and the time
//! for the simulations of all recordings (inputs already read and smoothed), on one core.

use std::path::Path;
use std::time::Instant;

use oleo_plant_sim::strut::{Inputs, StrutModel, replay};

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
    let signals: Vec<[bool; 3]> = (0..rows.len()).map(|i| [0, 1, 2].map(|v| valves[v][i] > 0.5)).collect();
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
        .ok_or("usage: campaign FOLDER [--model MODEL.toml] [--repeat N] [--remove-offsets]")?;
    let (mut model_path, mut repeat) = (format!("{folder}/model.toml"), 1);
    let mut offsets_removed = false;
    while let Some(option) = arguments.next() {
        if option == "--remove-offsets" {
            offsets_removed = true;
            continue;
        }
        let value = arguments.next().ok_or(format!("{option}: value missing"))?;
        match option.as_str() {
            "--model" => model_path = value,
            "--repeat" => repeat = value.parse()?,
            _ => return Err(format!("unknown option {option}").into()),
        }
    }
    let model = StrutModel::from_toml(&std::fs::read_to_string(&model_path)?, &model_path)?;
    let noise_m = model.noise.get("displacement_m").copied().unwrap_or(0.0);
    let mut paths: Vec<_> = std::fs::read_dir(&folder)?
        .map(|e| e.map(|e| e.path()))
        .collect::<Result<_, _>>()?;
    paths.retain(|p| p.extension().is_some_and(|e| e == "csv"));
    paths.sort();
    let begin = Instant::now();
    let recordings: Vec<_> = paths.iter().map(|p| read(p, noise_m)).collect::<Result<_, _>>()?;
    let read_s = begin.elapsed().as_secs_f64();
    let mut best = f64::INFINITY;
    for _ in 0..repeat {
        let begin = Instant::now();
        for r in &recordings {
            std::hint::black_box(replay(&model, &r.inputs)?);
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
