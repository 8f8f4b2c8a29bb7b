//! `oleo rig damping`: figure 23 of the report, the damper characteristics.

use std::process::ExitCode;

use oleo_plant_sim::rig::{DampingPoint, DampingState, measure_damping};
use oleo_plant_sim::strut::DamperLeakage;
use oleo_plant_sim::vehicle::VehicleParameters;
use oleo_report::{Axis, Column, Curves, Progress, Style, Table};
use serde_json::json;

use super::sheet::Specimen;
use super::spring::within;
use crate::failure::Failure;

/// Measure the damping characteristics with sines of 25 mm amplitude in three valve states, with and without leaking damper
/// packs.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  oleo rig damping --leak 1.2e-6 --out damping")]
pub struct Args {
    #[command(flatten)]
    specimen: Specimen,
    /// Highest speed at mid-stroke, m/s
    #[arg(long, value_name = "M/S", default_value_t = 1.0)]
    speed_m_s: f64,
    /// Flow coefficient of the leak past each damper pack in the leaking strut, m3/s/sqrt(Pa)
    #[arg(long, value_name = "COEFFICIENT", default_value_t = 1.2e-6)]
    leak: f64,
}

/// Speeds at which the damping is measured, as fractions of the highest.
const PARTS: [f64; 9] = [0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0];

/// Runs the measurement.
pub fn run(args: &Args) -> Result<ExitCode, Failure> {
    within("--speed-m-s", args.speed_m_s, 0.05, 2.0, "m/s")?;
    within("--leak", args.leak, 0.0, 1e-4, "m3/s/sqrt(Pa)")?;
    let model = args.specimen.model()?;
    let mut sheet = args
        .specimen
        .sheet("damping", "Rig: damping characteristics", &model, None)?;
    let mut leaking = model.clone();
    leaking.effects.damper_leakage = Some(DamperLeakage {
        flow_coefficient_1: args.leak,
        flow_coefficient_2: args.leak,
    });
    let speeds = PARTS.map(|part| part * args.speed_m_s);
    let progress = Progress::new("damping", 6);
    let mut measured: Vec<(String, Vec<DampingPoint>)> = Vec::new();
    for (packs, model) in [("", &model), (", leaking packs", &leaking)] {
        for state in DampingState::ALL {
            measured.push((
                format!("{}{packs}", state.name()),
                measure_damping(model, state, &speeds)?,
            ));
            progress.add(1);
        }
    }
    drop(progress);
    let baseline = VehicleParameters::defender110().rear_baseline;
    let reference = |speed: f64| {
        speed
            * if speed > 0.0 {
                baseline.bump_damping_n_s_m
            } else {
                baseline.rebound_damping_n_s_m
            }
    };

    let nearest = |wanted: f64| {
        (0..speeds.len())
            .min_by(|&a, &b| (speeds[a] - wanted).abs().total_cmp(&(speeds[b] - wanted).abs()))
            .unwrap_or(0)
    };
    let (slow, fast) = (nearest(0.1), nearest(0.5));
    let mut table = Table::new([
        Column::text("State"),
        Column::number(&format!("Jounce {:.2} m/s, N", speeds[slow])),
        Column::number("rebound, N"),
        Column::number(&format!("Jounce {:.2} m/s, N", speeds[fast])),
        Column::number("rebound, N"),
    ]);
    for (name, points) in &measured {
        let force = |value: f64| format!("{value:.0}");
        table.row([
            name.clone(),
            force(points[slow].jounce_n),
            force(points[slow].rebound_n),
            force(points[fast].jounce_n),
            force(points[fast].rebound_n),
        ]);
    }
    table.row([
        "baseline damper (vehicle preset)".to_owned(),
        format!("{:.0}", reference(speeds[slow])),
        format!("{:.0}", reference(-speeds[slow])),
        format!("{:.0}", reference(speeds[fast])),
        format!("{:.0}", reference(-speeds[fast])),
    ]);
    sheet.page.outcome(table.clone());

    let mut figure = Curves::new(
        "Damper characteristics (report, figure 23)",
        Axis::new("Speed (jounce positive)", "m/s"),
    );
    figure.panel(Axis::new("Damper force", "kN")).height(560);
    for (index, (name, points)) in measured.iter().enumerate() {
        let (speed, force) = both_directions(points);
        figure.series(
            if index < 3 { Style::LineAndPoints } else { Style::Dashed },
            name,
            &speed,
            &force,
        );
    }
    let ends = [-args.speed_m_s, 0.0, args.speed_m_s];
    figure.series(
        Style::Dashed,
        "baseline damper",
        &ends,
        &ends.map(|speed| 1e-3 * reference(speed)),
    );
    figure.caption(
        "The force at mid-stroke of sines of 25 mm amplitude, computed from the pressures. The valves give three discrete \
         levels. Leaking damper packs lower the two high levels below the baseline damper, as on the prototype.",
    );
    sheet.page.section("Characteristics").figure(figure);

    let column =
        |points: &[DampingPoint], of: &dyn Fn(&DampingPoint) -> f64| points.iter().map(of).collect::<Vec<f64>>();
    let files = [
        "low",
        "high_soft",
        "high_stiff",
        "low_leaking",
        "high_soft_leaking",
        "high_stiff_leaking",
    ];
    for (file, (_, points)) in files.iter().zip(&measured) {
        sheet.csv(
            &format!("damping_{file}.csv"),
            &[
                ("speed_m_s", &column(points, &|p| p.speed_m_s)),
                ("frequency_Hz", &column(points, &|p| p.frequency_hz)),
                ("jounce_N", &column(points, &|p| p.jounce_n)),
                ("rebound_N", &column(points, &|p| p.rebound_n)),
                ("lowest_p1_Pa", &column(points, &|p| p.lowest_p1_pa)),
            ],
        )?;
        let points: Vec<_> = points
            .iter()
            .map(|p| json!({ "speed_m_s": p.speed_m_s, "jounce_N": p.jounce_n, "rebound_N": p.rebound_n }))
            .collect();
        sheet.summarise(file, points);
    }
    sheet.publish(&table.to_string())?;
    Ok(ExitCode::SUCCESS)
}

/// One curve from rebound through zero to jounce, kN over m/s.
fn both_directions(points: &[DampingPoint]) -> (Vec<f64>, Vec<f64>) {
    let rebound = points
        .iter()
        .rev()
        .map(|point| (-point.speed_m_s, 1e-3 * point.rebound_n));
    let jounce = points.iter().map(|point| (point.speed_m_s, 1e-3 * point.jounce_n));
    rebound.chain([(0.0, 0.0)]).chain(jounce).unzip()
}
