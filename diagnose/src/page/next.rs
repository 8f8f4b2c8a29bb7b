//! The section "What to record next": in words, as a command that is drawn and can be saved, and what was not tested at all.

use oleo_report::{Axis, Cell, Column, Curves, Page, Style, Table};

use super::improvement;
use crate::campaign::Campaign;
use crate::diagnosis::Diagnosis;
use crate::experiment::{self, Asked, Trace};
use crate::json;

pub(super) fn section(page: &mut Page, campaign: &Campaign, diagnosis: &Diagnosis) {
    page.section("What to record next");
    page.text(&diagnosis.next_experiment.clone().unwrap_or_else(|| {
        format!(
            "No further recording is needed to separate effects from each other. {}",
            improvement::residuals_in_words(diagnosis)
        )
    }));
    for asked in experiment::asked(&*campaign.specimen, &diagnosis.selection, &diagnosis.locations) {
        command(page, &asked);
    }
    let missing = json::not_tested(&*campaign.specimen);
    if missing.is_empty() {
        page.text("Every effect of the vocabulary was tested. If one were present, these recordings would show it.");
        return;
    }
    let mut table = Table::new([
        Column::text("Effect that was not tested"),
        Column::text("Place"),
        Column::text("Reason, and what to record"),
    ]);
    for m in &missing {
        table.row([text(&m["id"]), text(&m["place"]), text(&m["why"])]);
    }
    page.text("These recordings cannot show the following effects, so it is unknown whether they are present.")
        .table(table);
}

fn text(value: &serde_json::Value) -> Cell {
    Cell::from(value.as_str().unwrap_or_default())
}

/// The command of an experiment over time.
fn command(page: &mut Page, asked: &Asked) {
    let trace = Trace::of(&asked.parts);
    let mut curves = Curves::new(
        &format!("The command that shows {}", asked.purpose),
        Axis::new("Time", "s"),
    );
    curves.caption(if trace.valves.is_empty() {
        "Displacement from the static position, jounce positive. The valves are as the text says."
    } else {
        "Displacement from the static position, jounce positive, and the switching signals. The command is straight between the rows of the file."
    });
    let mm: Vec<f64> = trace.displacement_m.iter().map(|x| 1e3 * x).collect();
    curves
        .panel(Axis::new("Displacement", "mm"))
        .line("displacement", &trace.time_s, &mm);
    if !trace.valves.is_empty() {
        curves.panel(
            Axis::new("Open", "")
                .ticks([(0.0, "valve 1"), (1.5, "valve 2"), (3.0, "valve 3")])
                .range(-0.3, 4.3),
        );
        for valve in 0..3 {
            let label = 1.5 * valve as f64;
            let open: Vec<f64> = trace
                .valves
                .iter()
                .map(|open| label + f64::from(u8::from(open[valve])))
                .collect();
            curves.series(Style::Step, &format!("valve {}", valve + 1), &trace.time_s, &open);
        }
    }
    page.figure(curves).download(
        &format!("Save this command as {}.csv", asked.name),
        &format!("{}.csv", asked.name),
        &trace.csv(),
    );
}
