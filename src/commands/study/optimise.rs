//! `oleo study optimise`: finds the optimum of the sweep with fewer runs.

use std::process::ExitCode;

use oleo_interface::{Axle, Axles};
use oleo_plant_sim::study::{DAMPER_FACTORS, GAS_VOLUMES_M3, Objective, Optimum, Surface, Visit, Weights, optimise};
use oleo_report::{
    Axis, Column, Curves, Field, FieldStyle, OutputDirectory, Page, Progress, Style, Table, significant,
};
use serde_json::json;

use super::drive::{Drive, ledger};
use crate::failure::Failure;
use crate::results::{ResultsArgs, command_line};
use crate::shard::Kept;

/// Find the gas volume and damper factor that minimise a weighted sum of ride and handling measures
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    drive: Drive,
    /// Weight of the frequency-weighted RMS acceleration, mean of both seats
    #[arg(long, value_name = "W", default_value_t = 1.0, allow_negative_numbers = true)]
    ride: f64,
    /// Weight of the motion sickness dose, mean of both seats
    #[arg(long, value_name = "W", default_value_t = 0.0, allow_negative_numbers = true)]
    sickness: f64,
    /// Weight of the largest roll angle in the lane change
    #[arg(long, value_name = "W", default_value_t = 0.0, allow_negative_numbers = true)]
    roll: f64,
    /// Optimise front and rear axle separately
    #[arg(long)]
    per_axle: bool,
    /// Also run the 70 combinations of the sweep, and draw the objective as contours under the path
    #[arg(long, conflicts_with_all = ["per_axle", "no_out"])]
    map: bool,
    /// Largest number of iterations
    #[arg(long, value_name = "N", default_value_t = 60)]
    iterations: u64,
    #[command(flatten)]
    results: ResultsArgs,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode, Failure> {
    let weights = Weights {
        ride: args.ride,
        sickness: args.sickness,
        roll: args.roll,
    };
    let all = [weights.ride, weights.sickness, weights.roll];
    if !all.iter().all(|w| w.is_finite() && *w >= 0.0) || all.iter().sum::<f64>() <= 0.0 {
        return Err(Failure::new(
            "--ride, --sickness, --roll: no weight may be negative, and at least one must be above 0",
        ));
    }
    let (bench, parameters) = args.drive.bench()?;
    let about = args.drive.about("optimise");
    let (mut out, path) = (args.results).stage_with_ledger(&about.command, &about.name, about.inputs, about.ledger)?;
    let ledger = ledger(path.as_deref().map_or(Kept::Nowhere, Kept::In), &bench)?;
    let objective = Objective {
        weights,
        per_axle: args.per_axle,
        iterations: args.iterations,
    };
    let progress = Progress::new("optimise", args.iterations + 6);
    let done = |_: &Visit| progress.add(1);
    let optimum = args
        .drive
        .on_threads(|| optimise(&bench, &ledger, objective, &done))??;
    drop(progress);
    let surface = match args.map {
        true => Some(args.drive.surface("map", &bench, &ledger)?),
        false => None,
    };

    let table = outcome(&optimum);
    if let Some(out) = &mut out {
        parameters.keep_vehicle(out)?;
        let map = surface.map(|surface| map(&weights, &optimum, &surface));
        write(out, args.drive.seed, &optimum, &table, map)?;
    }
    args.results.publish(out, &table.to_string())?;
    Ok(ExitCode::SUCCESS)
}

fn outcome(optimum: &Optimum) -> Table {
    let mut table = Table::new([Column::text("Optimum"), Column::number("Value"), Column::text("Unit")]);
    let best = &optimum.best;
    let mut row = |name: &str, value: f64, unit: &str| {
        table.row([name.to_owned(), significant(value, 4), unit.to_owned()]);
    };
    for axle in Axle::ALL {
        let name = axle.key();
        row(
            &format!("static gas volume, {name}"),
            1e3 * best.case.gas_volume_m3[axle],
            "l",
        );
        row(&format!("damper factor, {name}"), best.case.damper_factor[axle], "");
    }
    if let Some(ride) = best.ride {
        row("weighted RMS, mean of both seats", ride.mean_rms_m_s2(), "m/s2");
        row(
            "motion sickness dose, mean of both seats",
            ride.mean_msdv_m_s1_5(),
            "m/s^1.5",
        );
    }
    if let Some(handling) = best.handling {
        row("largest body roll", handling.max_roll_rad.to_degrees(), "degrees");
    }
    row(
        "objective (at 0.5 l and factor 1 it equals the sum of the weights)",
        best.objective,
        "",
    );
    row("points evaluated", optimum.path.len() as f64, "");
    row("simulations", optimum.runs as f64, "");
    table
}

/// The objective over the sweep's combinations, under the path of the search.
fn map(weights: &Weights, optimum: &Optimum, surface: &Surface) -> Field {
    let reference = &optimum.path[0];
    let value = |i: usize, j: usize| {
        let (ride, handling) = (surface.ride[i][j], surface.handling[i][j]);
        let ended_well =
            (reference.ride.is_none() || ride.completed) && (reference.handling.is_none() || handling.completed);
        match ended_well {
            true => weights.objective(Some(ride), Some(handling), (reference.ride, reference.handling)),
            false => f64::NAN,
        }
    };
    let litres: Vec<f64> = surface.gas_volumes_m3.iter().map(|volume| 1e3 * volume).collect();
    let rows: Vec<Vec<f64>> = (0..surface.damper_factors.len())
        .map(|j| (0..litres.len()).map(|i| value(i, j)).collect())
        .collect();
    let axes = [
        Axis::new("Static gas volume", "l").logarithmic(),
        Axis::new("Damper factor", ""),
        Axis::new("Objective", ""),
    ];
    let title = "Objective and path of the search";
    let mut field = Field::new(
        title,
        FieldStyle::Contour,
        axes,
        &litres,
        &surface.damper_factors,
        &rows,
    );
    let volume = |visit: &Visit| 1e3 * visit.case.gas_volume_m3.front;
    let factor = |visit: &Visit| visit.case.damper_factor.front;
    let path = |of: &dyn Fn(&Visit) -> f64| optimum.path.iter().map(of).collect::<Vec<f64>>();
    field
        .path("search", &path(&volume), &path(&factor))
        .path("best", &[volume(&optimum.best)], &[factor(&optimum.best)])
        .caption("In a gap the vehicle did not end a drive well.");
    field
}

fn write(
    out: &mut OutputDirectory,
    seed: u64,
    optimum: &Optimum,
    table: &Table,
    map: Option<Field>,
) -> Result<(), Failure> {
    let column = |of: &dyn Fn(&Visit) -> f64| optimum.path.iter().map(of).collect::<Vec<f64>>();
    let volume = Axles::from_fn(|axle| column(&|v| 1e3 * v.case.gas_volume_m3[axle]));
    let factor = Axles::from_fn(|axle| column(&|v| v.case.damper_factor[axle]));
    let objective = column(&|v| v.objective);
    let number: Vec<f64> = (1..=optimum.path.len()).map(|i| i as f64).collect();
    let best: Vec<f64> = objective
        .iter()
        .scan(f64::INFINITY, |best, value| {
            *best = best.min(*value);
            Some(*best)
        })
        .collect();
    let nan = f64::NAN;
    let rms = column(&|v| v.ride.map_or(nan, |ride| ride.mean_rms_m_s2()));
    let dose = column(&|v| v.ride.map_or(nan, |ride| ride.mean_msdv_m_s1_5()));
    let roll = column(&|v| v.handling.map_or(nan, |handling| handling.max_roll_rad.to_degrees()));
    out.csv(
        "path.csv",
        &[
            ("point", &number),
            ("gas_volume_front_l", &volume.front),
            ("gas_volume_rear_l", &volume.rear),
            ("damper_factor_front", &factor.front),
            ("damper_factor_rear", &factor.rear),
            ("objective", &objective),
            ("weighted_rms_m_s2", &rms),
            ("msdv_m_s1_5", &dose),
            ("max_roll_deg", &roll),
        ],
    )?;

    let mut page = Page::new("Design study: optimiser", &command_line());
    page.outcome(table.clone());
    let mut path = Curves::new(
        "Path of the search",
        Axis::new("Static gas volume", "l")
            .logarithmic()
            .range(1e3 * GAS_VOLUMES_M3[0], 1e3 * GAS_VOLUMES_M3[9]),
    );
    path.caption("All points that the search evaluated, in this order. The search begins at the reference case, 0.5 l and factor 1.");
    let panel = path.panel(Axis::new("Damper factor", "").range(DAMPER_FACTORS[0] - 0.1, DAMPER_FACTORS[6] + 0.1));
    panel.series(Style::LineAndPoints, "front", &volume.front, &factor.front);
    if volume.front != volume.rear || factor.front != factor.rear {
        panel.series(Style::LineAndPoints, "rear", &volume.rear, &factor.rear);
    }
    let case = optimum.best.case;
    panel.series(
        Style::Points,
        "best",
        &[1e3 * case.gas_volume_m3.front],
        &[case.damper_factor.front],
    );
    let mut progress = Curves::new("Objective", Axis::new("Point", ""));
    let panel = progress.panel(Axis::new("Objective", ""));
    panel.series(Style::Points, "evaluated", &number, &objective);
    panel.series(Style::Step, "best so far", &number, &best);
    page.section("Path");
    match map {
        Some(map) => page.figure(map),
        None => page.figure(path),
    };
    page.figure(progress);
    out.summary(
        "summary.json",
        Some(seed),
        &json!({
            "gas_volume_l": case.gas_volume_m3.map(|v| 1e3 * v).into_array(),
            "damper_factor": case.damper_factor.into_array(),
            "objective": optimum.best.objective,
            "points": optimum.path.len(),
            "simulations": optimum.runs,
        }),
    )?;
    out.page(&page)?;
    Ok(())
}
