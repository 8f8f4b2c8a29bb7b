//! `oleo rig spring`: figures 18, 19, 20 and 22 of the report, and the corrected stiff spring of figure 21.

use std::process::ExitCode;

use oleo_plant_sim::rig::{Isothermal, SpringCharacteristic, SpringTest, side_loaded, test_spring};
use oleo_plant_sim::strut::StrutModel;
use oleo_plant_sim::strut_first::Spring;
use oleo_report::{Axis, Column, Curves, Progress, Style, Table};
use serde_json::json;

use super::sheet::{Sheet, Specimen};
use crate::failure::Failure;

/// Measure the spring characteristics, soft and stiff, with a slow sawtooth.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  oleo rig spring --out spring")]
pub struct Args {
    #[command(flatten)]
    specimen: Specimen,
    /// Largest compression, mm
    #[arg(long, value_name = "MM", default_value_t = 40.0)]
    bump_mm: f64,
    /// Largest extension, mm
    #[arg(long, value_name = "MM", default_value_t = 100.0)]
    rebound_mm: f64,
    /// Duration of the cycle, s
    #[arg(long, value_name = "S", default_value_t = 300.0)]
    duration_s: f64,
    /// Friction coefficient of the offset mounting: friction force divided by strut force, for the load cell of figure 18
    #[arg(long, value_name = "MU", default_value_t = 0.1)]
    side_load: f64,
}

/// Runs the measurement.
pub fn run(args: &Args) -> Result<ExitCode, Failure> {
    within("--bump-mm", args.bump_mm, 1.0, 45.0, "mm")?;
    within("--rebound-mm", args.rebound_mm, 1.0, 180.0, "mm")?;
    within("--duration-s", args.duration_s, 1.0, 3600.0, "s")?;
    within("--side-load", args.side_load, 0.0, 0.5, "as a ratio")?;
    let model = args.specimen.model()?;
    let mut sheet = args
        .specimen
        .sheet("spring", "Rig: spring characteristics", &model, None)?;
    let test = SpringTest {
        bump_m: 1e-3 * args.bump_mm,
        rebound_m: 1e-3 * args.rebound_mm,
        duration_s: args.duration_s,
    };
    let progress = Progress::new("spring", 3);
    let soft = test_spring(&model, Spring::Soft, test)?;
    progress.add(1);
    let stiff = test_spring(&model, Spring::Stiff, test)?;
    progress.add(1);
    let bent = test_spring(&side_loaded(&model, args.side_load), Spring::Soft, test)?;
    drop(progress);

    let table = outcome(&soft, &stiff, &bent);
    sheet.page.outcome(table.clone());
    draw(&mut sheet, args, &soft, &stiff, &bent);
    for (name, result) in [("soft", &soft), ("stiff", &stiff), ("soft_side_loaded", &bent)] {
        write(&mut sheet, name, result)?;
        sheet.summarise(name, summary(result));
    }
    compare_terms(&mut sheet, &model);
    sheet.publish(&table.to_string())?;
    Ok(ExitCode::SUCCESS)
}

/// Refuses a value outside its range.
pub fn within(name: &str, value: f64, least: f64, most: f64, unit: &str) -> Result<(), Failure> {
    if value.is_finite() && (least..=most).contains(&value) {
        Ok(())
    } else {
        Err(Failure::new(format!("{name} {value}: give {least} to {most} {unit}")))
    }
}

fn outcome(soft: &SpringCharacteristic, stiff: &SpringCharacteristic, bent: &SpringCharacteristic) -> Table {
    let mut table = Table::new([
        Column::text("Quantity"),
        Column::number("Soft"),
        Column::number("Stiff"),
        Column::text("Unit"),
    ]);
    let ends = |spring: &SpringCharacteristic| {
        let mean = spring.mean_n();
        (mean[mean.len() - 1], mean[0])
    };
    let mut pair = |name: &str, unit: &str, value: &dyn Fn(&SpringCharacteristic) -> String| {
        table.row([name.to_owned(), value(soft), value(stiff), unit.to_owned()]);
    };
    pair("force at full compression", "kN", &|s| {
        format!("{:.2}", 1e-3 * ends(s).0)
    });
    pair("force at full extension", "kN", &|s| format!("{:.2}", 1e-3 * ends(s).1));
    for (name, prediction) in predictions() {
        pair(&format!("largest deviation from {name}"), "%", &|s| {
            percent(s.deviation(prediction(s)).0)
        });
    }
    for (name, prediction) in predictions() {
        pair(&format!("RMS deviation from {name}"), "%", &|s| {
            percent(s.deviation(prediction(s)).1)
        });
    }
    pair("hysteresis of the force from pressure", "N", &|s| {
        format!("{:.0}", s.hysteresis_n())
    });
    pair("hysteresis of the load cell", "N", &|s| {
        format!("{:.0}", s.load_cell_hysteresis_n())
    });
    let side_load = [
        "hysteresis of the load cell, offset mounting".to_owned(),
        format!("{:.0}", bent.load_cell_hysteresis_n()),
        "-".to_owned(),
        "N".to_owned(),
    ];
    table.row(side_load);
    table
}

/// A prediction by name, taken from a characteristic.
type Prediction = (&'static str, fn(&SpringCharacteristic) -> &Isothermal);

fn predictions() -> [Prediction; 3] {
    [
        ("isothermal", |s| &s.isothermal),
        ("isothermal with bulk modulus", |s| &s.corrected),
        ("isothermal with bulk modulus and real gas", |s| &s.real),
    ]
}

/// How far the measured mean force is from each prediction, with the figures of the table.
fn agreement(spring: &SpringCharacteristic) -> String {
    let deviations = predictions().map(|(name, prediction)| {
        let (largest, rms) = spring.deviation(prediction(spring));
        format!("{} % at most and {} % RMS ({name})", percent(largest), percent(rms))
    });
    format!(
        "The measured mean force deviates from the predicted force by {}. Heat that flows between the gas and its \
         surroundings opens the loop between compression and extension.",
        deviations.join(", ")
    )
}

fn percent(ratio: f64) -> String {
    format!("{:+.2}", 100.0 * ratio)
}

fn draw(
    sheet: &mut Sheet,
    args: &Args,
    soft: &SpringCharacteristic,
    stiff: &SpringCharacteristic,
    bent: &SpringCharacteristic,
) {
    let page = &mut sheet.page;
    page.fact(
        "Cycle",
        &format!(
            "0, +{} mm, -{} mm, +{} mm, 0 in {} s",
            args.bump_mm, args.rebound_mm, args.bump_mm, args.duration_s
        ),
    );
    let mm = |values: &[f64]| values.iter().map(|x| 1e3 * x).collect::<Vec<f64>>();
    let kn = |values: &[f64]| values.iter().map(|x| 1e-3 * x).collect::<Vec<f64>>();
    let x_axis = || Axis::new("Displacement (compression positive)", "mm");
    let y_axis = || Axis::new("Force", "kN");
    let predicted = |s: &SpringCharacteristic, which: &dyn Fn(f64) -> f64| {
        kn(&s.grid_m.iter().map(|&x| which(x)).collect::<Vec<_>>())
    };

    page.section("Load cell and pressure");
    let mut figure = Curves::new(
        "Measured force and force calculated from pressure (report, figure 18)",
        x_axis(),
    );
    figure.panel(y_axis()).line(
        "load cell, offset mounting",
        &mm(&bent.record.displacement_m),
        &kn(&bent.record.force_n),
    );
    figure.line(
        "from pressure p1",
        &mm(&bent.record.displacement_m),
        &kn(&bent.pressure_force_n),
    );
    figure.caption(&format!(
        "This is the soft spring with a friction of {} times the strut force from the offset mounting. The load cell measures \
         this friction, and the pressure does not contain it.",
        args.side_load
    ));
    page.figure(figure);

    page.section("Springs");
    for (spring, title) in [
        (soft, "Soft spring characteristic (report, figure 19)"),
        (stiff, "Stiff spring characteristic (report, figures 20 and 21)"),
    ] {
        let mut figure = Curves::new(title, x_axis());
        figure.panel(y_axis()).line(
            "measured, from pressure",
            &mm(&spring.record.displacement_m),
            &kn(&spring.pressure_force_n),
        );
        figure.series(
            Style::Dashed,
            "isothermal",
            &mm(&spring.grid_m),
            &predicted(spring, &|x| spring.isothermal.force_n(x)),
        );
        figure.series(
            Style::Dashed,
            "with bulk modulus",
            &mm(&spring.grid_m),
            &predicted(spring, &|x| spring.corrected.force_n(x)),
        );
        figure.series(
            Style::Dashed,
            "with bulk modulus and real gas",
            &mm(&spring.grid_m),
            &predicted(spring, &|x| spring.real.force_n(x)),
        );
        figure.caption(&agreement(spring));
        page.figure(figure);
    }
    let mut both = Curves::new("Soft and stiff spring characteristics (report, figure 22)", x_axis());
    both.panel(y_axis());
    for (spring, name) in [(soft, "soft"), (stiff, "stiff")] {
        both.line(
            &format!("{name}, measured"),
            &mm(&spring.record.displacement_m),
            &kn(&spring.pressure_force_n),
        );
        both.series(
            Style::Dashed,
            &format!("{name}, calculated with bulk modulus"),
            &mm(&spring.grid_m),
            &predicted(spring, &|x| spring.corrected.force_n(x)),
        );
    }
    page.figure(both);
}

fn write(sheet: &mut Sheet, name: &str, result: &SpringCharacteristic) -> Result<(), Failure> {
    sheet.record(
        &format!("recording_{name}.csv"),
        &result.record,
        &[("force_from_pressure_N", &result.pressure_force_n)],
    )?;
    let predicted = |which: &dyn Fn(f64) -> f64| result.grid_m.iter().map(|&x| which(x)).collect::<Vec<f64>>();
    sheet.csv(
        &format!("characteristic_{name}.csv"),
        &[
            ("displacement_m", &result.grid_m),
            ("extending_N", &result.extending_n),
            ("compressing_N", &result.compressing_n),
            ("isothermal_N", &predicted(&|x| result.isothermal.force_n(x))),
            (
                "isothermal_bulk_modulus_N",
                &predicted(&|x| result.corrected.force_n(x)),
            ),
            (
                "isothermal_bulk_modulus_real_gas_N",
                &predicted(&|x| result.real.force_n(x)),
            ),
        ],
    )
}

fn summary(result: &SpringCharacteristic) -> serde_json::Value {
    let deviation = |(largest, rms): (f64, f64)| json!({ "largest": largest, "rms": rms });
    json!({
        "hysteresis_N": result.hysteresis_n(),
        "load_cell_hysteresis_N": result.load_cell_hysteresis_n(),
        "relative_deviation": {
            "isothermal": deviation(result.deviation(&result.isothermal)),
            "bulk_modulus": deviation(result.deviation(&result.corrected)),
            "bulk_modulus_real_gas": deviation(result.deviation(&result.real)),
        },
    })
}

/// Says what the strut's model holds, since it decides what the loops show.
fn compare_terms(sheet: &mut Sheet, model: &StrutModel) {
    let effects = &model.effects;
    let mut terms = Vec::new();
    for (name, present) in [
        ("oil_compressibility", effects.oil_compressibility.is_some()),
        ("gas_heat_transfer", effects.gas_heat_transfer.is_some()),
        ("real_gas", effects.real_gas.is_some()),
        ("seal_friction", effects.seal_friction.is_some()),
        ("side_load_friction", effects.side_load_friction.is_some()),
        (
            "accumulator_piston_friction",
            effects.accumulator_piston_friction.is_some(),
        ),
    ] {
        if present {
            terms.push(name);
        }
    }
    sheet.summarise("effects", terms);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_caption_states_the_figures_of_the_table() {
        let test = SpringTest {
            bump_m: 0.040,
            rebound_m: 0.100,
            duration_s: 60.0,
        };
        let stiff = test_spring(&StrutModel::defender110(8000.0), Spring::Stiff, test).expect("possible");
        let (caption, table) = (agreement(&stiff), outcome(&stiff, &stiff, &stiff).to_string());
        for (_, prediction) in predictions() {
            let (largest, rms) = stiff.deviation(prediction(&stiff));
            for figure in [percent(largest), percent(rms)] {
                assert!(
                    caption.contains(&figure) && table.contains(&figure),
                    "{figure}: {caption}"
                );
            }
        }
    }
}
