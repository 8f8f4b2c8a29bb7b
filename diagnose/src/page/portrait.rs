//! The section with the pictures by which people of the trade judge a specimen: force over speed and over displacement of a
//! damper, position and its error over time of a drive.

use oleo_report::{Axis, Curves, Page, Style, extrema_by_bucket};

use super::shown::{brief, scaled};
use crate::diagnosis::Diagnosis;
use crate::specimen::{Portrait, Series, Specimen};
use crate::vocabulary::State;

/// Buckets of each line; a loop that is passed several times needs more of them than a line over time.
const BUCKETS: usize = 300;
/// Most recordings that are drawn.
const DRAWN: usize = 6;
/// Height of a figure of two panels.
const HEIGHT_PX: usize = 560;

pub fn section(page: &mut Page, specimen: &dyn Specimen, diagnosis: &Diagnosis) {
    let Some(portrait) = specimen.portrait() else { return };
    page.section(match portrait {
        Portrait::Loops(_) => "Loops",
        Portrait::OverTime => "Over time",
    });
    for recording in 0..specimen.recordings().len().min(DRAWN) {
        match portrait {
            Portrait::Loops(states) => {
                for &state in states {
                    loops(page, specimen, diagnosis, recording, state);
                }
            }
            Portrait::OverTime => over_time(page, specimen, diagnosis, recording),
        }
    }
}

/// The output of the first channel as a model has it, from its residuals.
fn predicted(specimen: &dyn Specimen, recording: usize, residuals: &[Series]) -> Vec<f64> {
    let noise = specimen.channels()[0].noise;
    (specimen.measured(recording, 0).iter().zip(&residuals[recording][0]))
        .map(|(measured, residual)| measured - noise * residual)
        .collect()
}

/// How a line is drawn, its name and its values.
type Line = (Style, &'static str, Vec<f64>);

/// Recording, recalibrated and improved model, in the order in which they are drawn.
fn lines(specimen: &dyn Specimen, diagnosis: &Diagnosis, recording: usize) -> [Line; 3] {
    let residuals = &diagnosis.residuals;
    [
        (
            Style::Line,
            "recalibrated model",
            predicted(specimen, recording, &residuals.calibrated),
        ),
        (
            Style::Line,
            "improved model",
            predicted(specimen, recording, &residuals.improved),
        ),
        (Style::Dashed, "recording", specimen.measured(recording, 0).to_vec()),
    ]
}

fn loops(page: &mut Page, specimen: &dyn Specimen, diagnosis: &Diagnosis, recording: usize, state: State) {
    let states = specimen.states(recording);
    let Some(series) = states.iter().find(|s| s.state == state) else {
        return;
    };
    let (quantity, unit) = state.quantity_and_unit();
    let (scale, unit) = scaled(unit);
    let x: Vec<f64> = series.values.iter().map(|v| scale * v).collect();
    let column = &specimen.channels()[0].column;
    let (output_scale, output_unit) = scaled(column.unit());
    let mut curves = Curves::new(
        &format!(
            "{}: {} over {quantity}",
            specimen.recording_name(recording),
            column.quantity()
        ),
        Axis::new(quantity, unit),
    );
    curves.caption(
        "All cycles of the recording, compression positive. The recalibrated model is the given one within its tolerances; the \
         improved model has the effects of this page.",
    );
    curves.panel(Axis::new(column.quantity(), output_unit));
    for (style, name, values) in lines(specimen, diagnosis, recording) {
        let y: Vec<f64> = values.iter().map(|v| output_scale * v).collect();
        let (x, y) = extrema_by_bucket(&x, &y, BUCKETS);
        curves.series(style, name, &brief(&x), &brief(&y));
    }
    page.figure(curves);
}

fn over_time(page: &mut Page, specimen: &dyn Specimen, diagnosis: &Diagnosis, recording: usize) {
    let column = &specimen.channels()[0].column;
    let (scale, unit) = scaled(column.unit());
    let time = specimen.time_s(recording);
    let mut curves = Curves::new(
        &format!(
            "{}: {} and its error over time",
            specimen.recording_name(recording),
            column.quantity()
        ),
        Axis::new("Time", "s"),
    );
    curves.caption(
        "The lower panel shows recording minus prediction. It returns to zero where a window of the free run begins with the \
         measured position and speed.",
    );
    curves.height(HEIGHT_PX);
    let measured = specimen.measured(recording, 0);
    let all = lines(specimen, diagnosis, recording);
    let errors = all[..2].iter().map(|(style, name, values)| {
        let error = measured.iter().zip(values).map(|(m, p)| m - p).collect();
        (*style, *name, error)
    });
    let panels: [(&str, Vec<Line>); 2] = [(column.quantity(), all.to_vec()), ("error", errors.collect())];
    for (quantity, series) in panels {
        curves.panel(Axis::new(quantity, unit));
        for (style, name, values) in series {
            let values: Vec<f64> = values.iter().map(|v| scale * v).collect();
            let (x, y) = extrema_by_bucket(time, &values, BUCKETS);
            curves.series(style, name, &brief(&x), &brief(&y));
        }
    }
    page.figure(curves);
}
