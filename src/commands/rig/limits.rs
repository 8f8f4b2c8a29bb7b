//! `oleo rig limits`: checks the design specifications of the report's section 3.3.

use std::process::ExitCode;

use oleo_plant_sim::rig::check_limits;
use oleo_report::{Cell, Column, Table, Verdict, significant};
use serde_json::json;

use super::sheet::Specimen;
use crate::failure::Failure;

/// Check the strut against the report's design specifications i to vii; the exit status is 1 if one is not met.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  oleo rig limits --strut model.toml --out limits")]
pub struct Args {
    #[command(flatten)]
    specimen: Specimen,
}

/// Runs the check.
pub fn run(args: &Args) -> Result<ExitCode, Failure> {
    let model = args.specimen.model()?;
    let mut sheet = args
        .specimen
        .sheet("limits", "Rig: design specifications", &model, None)?;
    let limits = check_limits(&model)?;
    let mut table = Table::new([
        Column::text("No"),
        Column::text("Specification"),
        Column::number("Found"),
        Column::text("Unit"),
        Column::text("Met"),
    ]);
    let mut notes = Table::new([Column::text("No"), Column::text("How it was found")]);
    for limit in &limits {
        let found = significant(limit.found, 3);
        table.row([
            Cell::from(limit.number),
            limit.specification.into(),
            found.into(),
            limit.unit.into(),
            Cell::check(limit.met),
        ]);
        notes.row([limit.number, &limit.note]);
    }
    let met = limits.iter().filter(|limit| limit.met).count();
    let all = met == limits.len();
    let verdict = if all { Verdict::Pass } else { Verdict::Fail };
    sheet.page.verdict(
        verdict,
        &format!("{met} of {} design specifications are met.", limits.len()),
    );
    sheet.page.outcome(table.clone());
    sheet.page.section("How it was found").table(notes);
    // As lines of text: sentences do not fit into the columns of a terminal.
    let explanations: String = limits
        .iter()
        .map(|limit| format!("{:<5}{}\n", limit.number, limit.note))
        .collect();
    let limits: Vec<_> = limits
        .iter()
        .map(|limit| {
            json!({ "number": limit.number, "specification": limit.specification, "found": limit.found,
                    "unit": limit.unit, "met": limit.met, "note": limit.note })
        })
        .collect();
    sheet.summarise("limits", limits);
    sheet.publish(&format!("{table}{explanations}"))?;
    Ok(if all { ExitCode::SUCCESS } else { ExitCode::from(1) })
}
