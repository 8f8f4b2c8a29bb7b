//! The section "Where": the drawing of the specimen, the table of locations, the relation that does not hold, and the
//! residual over time and state with the region of the misfit marked.

use oleo_report::{Axis, Bars, Column, Curves, Page, Style, Table, extrema_by_bucket, significant};

use super::shown::{brief, scaled, title};
use super::{explained, words};
use crate::campaign::Campaign;
use crate::diagnosis::Diagnosis;
use crate::locate::Location;
use crate::specimen::Specimen;
use crate::vocabulary::{Place, Site};

/// Number of buckets into which a line over time is reduced; more cannot be seen on a page.
const BUCKETS: usize = 260;
/// Largest number of locations that get figures.
const DRAWN: usize = 6;
/// Largest number of relations in the bar chart.
const RELATIONS: usize = 8;

pub fn section(page: &mut Page, campaign: &Campaign, diagnosis: &Diagnosis) {
    let specimen = &*campaign.specimen;
    page.section("Where");
    let places: Vec<&Place> = diagnosis.locations.iter().map(|l| &l.place).collect();
    let marked = places.iter().any(|p| p.site != Site::Unknown);
    if let Some(svg) = specimen.drawing(&places) {
        page.drawing(
            &svg,
            if marked {
                "The specimen. The marked places are those where the model and the recordings disagree. Click one to see only what is \
                 about it."
            } else {
                "The specimen. No place is marked, because no place was found where the model and the recordings disagree."
            },
        );
    }
    if diagnosis.locations.is_empty() {
        page.text(
            "No place is listed, because no misfit beyond the noise is left after recalibration within the tolerances.",
        );
    } else {
        page.text(
            "The share of the excess is the part of the misfit beyond noise that returns when this effect alone is removed from \
             the improved model and all other parameters are fitted again. The shares can add up to more than 100 % if \
             effects partly compensate each other.",
        )
        .table(locations(specimen, &diagnosis.locations));
    }
    relations(page, diagnosis);
    for location in diagnosis.locations.iter().take(DRAWN) {
        page.topic(Some(&words::topic(&location.place)));
        over_time(page, specimen, diagnosis, location);
        explained::over_state(page, specimen, diagnosis, location);
    }
    page.topic(None);
}

fn locations(specimen: &dyn Specimen, locations: &[Location]) -> Table {
    let mut table = Table::new([
        Column::text("Place"),
        Column::number("Share of the excess"),
        Column::text("Largest in"),
        Column::text("Time, s"),
        Column::text("Condition, over all recordings"),
    ]);
    for l in locations {
        table.row([
            l.place.to_string(),
            format!("{:.0} %", 100.0 * l.share_of_excess),
            format!(
                "{} of {}",
                specimen.channels()[l.channel].column,
                specimen.recording_name(l.recording)
            ),
            format!("{:.2} to {:.2}", l.t_s[0], l.t_s[1]),
            l.condition.text.clone(),
        ]);
    }
    table
}

fn relations(page: &mut Page, diagnosis: &Diagnosis) {
    let changed = &diagnosis.changed_relations;
    if !changed.is_empty() {
        let shown = &changed[..changed.len().min(RELATIONS)];
        let mut bars = Bars::new(
            "Which relation of the model does not hold",
            shown.iter().map(|r| r.relation.as_str()),
            Axis::new("Excess misfit explained", "%").range(0.0, 100.0),
        );
        bars.caption(
            "Each bar is the part of the held-out misfit beyond noise that disappears when only this relation of the \
             recalibrated model may change, with the best candidate for it. If several relations are wrong, no single bar \
             reaches 100 %.",
        );
        bars.series(
            "only this relation changed",
            &shown.iter().map(|r| 100.0 * r.share_of_excess).collect::<Vec<_>>(),
        );
        page.figure(bars);
    }
    if diagnosis.relations.iter().any(|r| r.noise_ratio.is_some()) {
        let mut table = Table::new([
            Column::text("Relation between neighbouring sensors, from the recordings alone"),
            Column::number("Noise ratio"),
            Column::number("Samples"),
            Column::text("Result"),
        ]);
        for r in &diagnosis.relations {
            let reading = match r.noise_ratio {
                None => "the recordings do not excite it",
                Some(v) if v < 1.2 => "holds",
                Some(v) if v < 2.0 => "holds approximately",
                Some(_) => "does not hold: an effect acts between these sensors, or one of them is wrong",
            };
            table.row([
                r.name.to_owned(),
                r.noise_ratio.map_or("-".into(), |v| format!("{v:.2}")),
                r.samples.to_string(),
                reading.to_owned(),
            ]);
        }
        page.table(table);
    }
}

fn over_time(page: &mut Page, specimen: &dyn Specimen, diagnosis: &Diagnosis, location: &Location) {
    let (r, c) = (location.recording, location.channel);
    let time = specimen.time_s(r);
    let channel = &specimen.channels()[c];
    let measured = specimen.measured(r, c);
    let with = &diagnosis.residuals.improved[r][c];
    let without = &location.without[r][c];
    let (quantity, unit) = (channel.column.quantity(), channel.column.unit());
    let (scale, unit) = scaled(unit);
    let nothing_found = location.candidate.is_none();
    let mut curves = Curves::new(
        &format!(
            "{}: {} in {}",
            title(specimen.kind(), diagnosis, location),
            channel.column,
            specimen.recording_name(r)
        ),
        Axis::new("Time", "s"),
    );
    curves.caption(&format!(
        "The upper panel shows recording less prediction, and what the effect adds to the prediction; the sensor noise is {} {}. The \
         lower panel shows the recording. The misfit is found in the shaded interval, {:.2} to {:.2} s. The condition over all \
         recordings is: {}.{}",
        significant(channel.noise * scale, 2),
        unit,
        location.t_s[0],
        location.t_s[1],
        location.condition.text,
        together(specimen, diagnosis, location)
    ));
    curves.height(560);
    let mut draw = |axis: Axis, series: &[(Style, &str, Vec<f64>)]| {
        curves.panel(axis);
        for (style, name, values) in series {
            let (x, y) = extrema_by_bucket(time, values, BUCKETS);
            curves.series(*style, name, &brief(&x), &brief(&y));
        }
        curves.region(location.t_s[0], location.t_s[1], "found here");
    };
    let in_units = |residual: &[f64]| -> Vec<f64> {
        let values = specimen.in_units(r, location.channel, residual).into_iter();
        values.map(|e| scale * e).collect()
    };
    let left = (Style::Line, "left by the improved model", in_units(with));
    let residuals = if nothing_found {
        vec![left]
    } else {
        let adds: Vec<f64> = without.iter().zip(with).map(|(without, with)| without - with).collect();
        vec![
            (Style::Line, "recording less model without it", in_units(without)),
            left,
            (Style::Dashed, "what the effect adds", in_units(&adds)),
        ]
    };
    draw(Axis::new("Residual", unit), &residuals);
    let recorded: Vec<f64> = measured.iter().map(|m| scale * m).collect();
    draw(Axis::new(quantity, unit), &[(Style::Line, "recording", recorded)]);
    page.figure(curves);
}

/// What "without the effect" means, where it is more than the place of this figure.
fn together(specimen: &dyn Specimen, diagnosis: &Diagnosis, location: &Location) -> String {
    let Some(candidate) = location.candidate else {
        return String::new();
    };
    let place = &specimen.candidates()[candidate].place;
    let mut text = String::new();
    if place.site.parts().len() > 1 {
        let sites: Vec<String> = place.site.parts().iter().map(ToString::to_string).collect();
        text += &format!(
            " The effect is one for {}, and was removed from all of them together.",
            sites.join(" and ")
        );
    }
    if diagnosis.effects.iter().filter(|e| e.selected.is_some()).count() > 1 {
        text += " The other effects stay in the model, and all other parameters were fitted again without this one.";
    }
    text
}
