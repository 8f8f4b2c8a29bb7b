//! `oleo rig bulk-modulus`: figure 21 of the report, the compression of a strut full of oil without gas.

use std::process::ExitCode;

use oleo_plant_sim::rig::compress_oil;
use oleo_plant_sim::strut::EntrainedAir;
use oleo_report::{Axis, Column, Curves, Style, Table};

use super::sheet::Specimen;
use super::spring::within;
use crate::failure::Failure;

/// Measure the bulk modulus: compress the oil alone, with both accumulator pistons against their end stops.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  oleo rig bulk-modulus --air 0.005 --out oil")]
pub struct Args {
    #[command(flatten)]
    specimen: Specimen,
    /// Highest pressure, MPa gauge
    #[arg(long, value_name = "MPA", default_value_t = 20.0)]
    pressure_mpa: f64,
    /// Undissolved air in the oil, volume fraction at atmospheric pressure [default: that of the model]
    #[arg(long, value_name = "FRACTION")]
    air: Option<f64>,
}

/// Runs the measurement.
pub fn run(args: &Args) -> Result<ExitCode, Failure> {
    within("--pressure-mpa", args.pressure_mpa, 1.0, 60.0, "MPa")?;
    let mut model = args.specimen.model()?;
    if let Some(air) = args.air {
        within("--air", air, 0.0, 0.1, "as a fraction")?;
        model.effects.entrained_air = Some(EntrainedAir {
            volume_fraction: air,
            polytropic_exponent: 1.0,
        });
    }
    let mut sheet = args
        .specimen
        .sheet("bulk-modulus", "Rig: bulk modulus of the oil", &model, None)?;
    let test = compress_oil(&model, 1e6 * args.pressure_mpa)?;
    let stroke_mm = 1e3 * test.record.displacement_m.iter().copied().fold(0.0, f64::max);

    let mut table = Table::new([Column::text("Quantity"), Column::number("Value"), Column::text("Unit")]);
    table.row([
        "bulk modulus of the model",
        &format!("{:.4}", 1e-9 * test.bulk_modulus_pa),
        "GPa",
    ]);
    table.row([
        "bulk modulus from the upper half of the pressure range",
        &format!("{:.4}", 1e-9 * test.found_pa),
        "GPa",
    ]);
    table.row([
        "largest deviation of the force from the closed form",
        &format!("{:.3}", 100.0 * test.deviation),
        "%",
    ]);
    table.row(["stroke", &format!("{stroke_mm:.2}"), "mm"]);
    sheet.page.outcome(table.clone());

    let scaled = |values: &[f64]| values.iter().map(|value| 1e-3 * value).collect::<Vec<f64>>();
    let x: Vec<f64> = test.record.displacement_m.iter().map(|x| 1e3 * x).collect();
    let mut figure = Curves::new(
        "Oil-only compression (report, figure 21)",
        Axis::new("Displacement (compression positive)", "mm"),
    );
    figure
        .panel(Axis::new("Force above filling", "kN"))
        .line("measured, from pressure", &x, &scaled(&test.force_n));
    figure.series(Style::Dashed, "closed form", &x, &scaled(&test.closed_form_n));
    figure.series(
        Style::Dashed,
        "straight line, beta A^2 / V",
        &x,
        &scaled(&test.straight_n),
    );
    figure.caption("The closed form is p - p0 = beta ln(V / (V - A x)). Undissolved air makes the oil softer at low pressure, which bends the \
         beginning of the measured curve.");
    sheet.page.section("Oil").figure(figure);
    sheet.record(
        "oil.csv",
        &test.record,
        &[
            ("force_above_filling_N", &test.force_n),
            ("closed_form_N", &test.closed_form_n),
            ("straight_line_N", &test.straight_n),
        ],
    )?;
    sheet.summarise("bulk_modulus_Pa", test.bulk_modulus_pa);
    sheet.summarise("bulk_modulus_found_Pa", test.found_pa);
    sheet.summarise("relative_deviation", test.deviation);
    sheet.publish(&table.to_string())?;
    Ok(ExitCode::SUCCESS)
}
