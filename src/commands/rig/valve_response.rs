//! `oleo rig valve-response`: figures 24 and 25 of the report, the response times of valve 3.

use std::process::ExitCode;

use oleo_plant_sim::rig::{Parabola, ValveResponse, measure_valve_response};
use oleo_report::{Axis, Column, Curves, Progress, Style, Table};
use serde_json::json;

use super::sheet::{Sheet, Specimen};
use super::spring::within;
use crate::failure::Failure;

/// Measure the response time of valve 3, from the 5 % and 95 % points of the pressure difference, and fit a parabola to it.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  oleo rig valve-response --highest-mpa 14 --out valves")]
pub struct Args {
    #[command(flatten)]
    specimen: Specimen,
    /// Highest pressure difference, MPa
    #[arg(long, value_name = "MPA", default_value_t = 14.0)]
    highest_mpa: f64,
    /// Number of pressure differences
    #[arg(long, value_name = "N", default_value_t = 14, value_parser = clap::value_parser!(u32).range(3..=100))]
    points: u32,
}

/// Runs the measurement.
pub fn run(args: &Args) -> Result<ExitCode, Failure> {
    within("--highest-mpa", args.highest_mpa, 1.0, 16.0, "MPa")?;
    let model = args.specimen.model()?;
    let mut sheet = args
        .specimen
        .sheet("valve-response", "Rig: valve response times", &model, None)?;
    let progress = Progress::new("valve response", u64::from(args.points));
    let mut responses = Vec::new();
    for i in 1..=args.points {
        responses.push(measure_valve_response(
            &model,
            1e6 * args.highest_mpa * f64::from(i) / f64::from(args.points),
        )?);
        progress.add(1);
    }
    drop(progress);
    let fit = |time: &dyn Fn(&ValveResponse) -> f64| {
        let points: Vec<(f64, f64)> = responses.iter().map(|r| (1e-6 * r.initial_pa, 1e3 * time(r))).collect();
        Parabola::fit(&points).ok_or_else(|| {
            Failure::new("fewer than three pressure differences were reached, which is too few to fit a parabola; raise --highest-mpa or the strut's gas volume")
        })
    };
    let (total, opening) = (fit(&|r| r.total_s)?, fit(&|r| r.opening_total_s)?);

    let mut table = Table::new([
        Column::number("Pressure difference, MPa"),
        Column::number("Initial delay, ms"),
        Column::number("Response time, ms"),
        Column::number("Total, ms"),
        Column::number("95 % open, ms"),
    ]);
    for r in &responses {
        table.row([
            format!("{:.2}", 1e-6 * r.initial_pa),
            format!("{:.1}", 1e3 * r.initial_delay_s),
            format!("{:.1}", 1e3 * r.response_s()),
            format!("{:.1}", 1e3 * r.total_s),
            format!("{:.1}", 1e3 * r.opening_total_s),
        ]);
    }
    let mut fits = Table::new([
        Column::text("Parabola, ms over MPa"),
        Column::number("c0"),
        Column::number("c1"),
        Column::number("c2"),
        Column::number("RMS residual, ms"),
    ]);
    for (name, parabola) in [("total, from pressure", &total), ("95 % open", &opening)] {
        let [c0, c1, c2] = parabola.coefficients;
        fits.row([
            name.to_owned(),
            format!("{c0:.2}"),
            format!("{c1:.3}"),
            format!("{c2:.4}"),
            format!("{:.2}", parabola.residual),
        ]);
    }
    sheet.page.outcome(table.clone()).table(fits.clone());
    draw(&mut sheet, &responses, &total, &opening);
    write(&mut sheet, &responses, &total, &opening)?;
    sheet.publish(&format!("{table}{fits}"))?;
    Ok(ExitCode::SUCCESS)
}

fn draw(sheet: &mut Sheet, responses: &[ValveResponse], total: &Parabola, opening: &Parabola) {
    let of = |time: &dyn Fn(&ValveResponse) -> f64| responses.iter().map(time).collect::<Vec<f64>>();
    if let Some(r) = responses.get(responses.len() / 2) {
        let change = r.final_pa - r.initial_pa;
        let time: Vec<f64> = r.time_s.iter().map(|t| 1e3 * t).collect();
        let mega: Vec<f64> = r.difference_pa.iter().map(|p| 1e-6 * p).collect();
        let signal: Vec<f64> = r.time_s.iter().map(|&t| f64::from(u8::from(t >= 0.0))).collect();
        let mut figure = Curves::new(
            "Valve response time definitions (report, figure 24)",
            Axis::new("Time from the switching signal", "ms").range(-20.0, 150.0),
        );
        figure
            .panel(Axis::new("Pressure difference across valve 3", "MPa"))
            .line("pressure difference", &time, &mega);
        figure.horizontal(1e-6 * (r.initial_pa + 0.05 * change), "5 % of the change");
        figure.horizontal(1e-6 * (r.initial_pa + 0.95 * change), "95 % of the change");
        figure.region(0.0, 1e3 * r.initial_delay_s, "initial delay");
        figure.region(1e3 * r.initial_delay_s, 1e3 * r.total_s, "response time");
        figure
            .panel(Axis::new("Valve 3", ""))
            .series(Style::Step, "switching signal", &time, &signal);
        figure.line("opening", &time, &r.opening).height(560);
        figure.caption("The total response time is the sum of both. The opening is known to the simulation only.");
        sheet.page.section("Definition").figure(figure);
    }
    let mega = of(&|r| 1e-6 * r.initial_pa);
    let ms = |time: &dyn Fn(&ValveResponse) -> f64| of(&|r| 1e3 * time(r));
    let mut figure = Curves::new(
        "Valve response time over pressure difference (report, figure 25)",
        Axis::new("Pressure difference across the valve", "MPa")
            .range(0.0, 1.05 * mega.iter().copied().fold(0.0, f64::max)),
    );
    figure.panel(Axis::new("Time", "ms"));
    figure.series(Style::Points, "initial delay", &mega, &ms(&|r| r.initial_delay_s));
    figure.series(Style::Points, "response time", &mega, &ms(&|r| r.response_s()));
    figure.series(Style::Points, "total", &mega, &ms(&|r| r.total_s));
    figure.line(
        "parabola fitted to the total",
        &mega,
        &mega.iter().map(|&x| total.at(x)).collect::<Vec<_>>(),
    );
    figure.series(
        Style::Dashed,
        "95 % open",
        &mega,
        &mega.iter().map(|&x| opening.at(x)).collect::<Vec<_>>(),
    );
    figure.caption("The pressures have nearly settled before the valve is fully open: the response time depends on the system, as the report says.");
    sheet.page.section("Response times").figure(figure);
}

fn write(sheet: &mut Sheet, responses: &[ValveResponse], total: &Parabola, opening: &Parabola) -> Result<(), Failure> {
    let of = |value: &dyn Fn(&ValveResponse) -> f64| responses.iter().map(value).collect::<Vec<f64>>();
    sheet.csv(
        "valve_response.csv",
        &[
            ("pressure_difference_Pa", &of(&|r| r.initial_pa)),
            ("initial_delay_s", &of(&|r| r.initial_delay_s)),
            ("response_s", &of(&|r| r.response_s())),
            ("total_s", &of(&|r| r.total_s)),
            ("opening_5_percent_s", &of(&|r| r.opening_delay_s)),
            ("opening_95_percent_s", &of(&|r| r.opening_total_s)),
        ],
    )?;
    for (i, r) in responses.iter().enumerate() {
        sheet.csv(
            &format!("trace_{:02}.csv", i + 1),
            &[
                ("time_s", &r.time_s),
                ("pressure_difference_Pa", &r.difference_pa),
                ("opening", &r.opening),
            ],
        )?;
    }
    let parabola = |fit: &Parabola| json!({ "coefficients_ms_MPa": fit.coefficients, "rms_residual_ms": fit.residual });
    sheet.summarise("total", parabola(total));
    sheet.summarise("opening", parabola(opening));
    let range = |values: Vec<f64>| {
        json!([
            values.iter().copied().fold(f64::INFINITY, f64::min),
            values.iter().copied().fold(0.0, f64::max)
        ])
    };
    sheet.summarise("total_range_s", range(of(&|r| r.total_s)));
    sheet.summarise("opening_range_s", range(of(&|r| r.opening_total_s)));
    Ok(())
}
