//! "How much better": noise ratios on what was held out, and whether what is left is noise.

use oleo_report::{Axis, Bars, Cell, Column, Curves, Page, Style, Table, significant};

use crate::campaign::Campaign;
use crate::diagnosis::Diagnosis;
use crate::whiteness::{CHI_SQUARE_99, LAGS};

pub fn section(page: &mut Page, campaign: &Campaign, diagnosis: &Diagnosis) {
    page.section("How much better");
    channels(page, diagnosis);
    recordings(page, campaign, diagnosis);
    left(page, diagnosis);
}

fn channels(page: &mut Page, diagnosis: &Diagnosis) {
    let channels = &diagnosis.channels;
    let names: Vec<&str> = channels.iter().map(|c| c.column.as_str()).collect();
    let column = |f: fn(&crate::diagnosis::ChannelFigures) -> f64| channels.iter().map(f).collect::<Vec<_>>();
    let mut bars = Bars::new(
        "Noise ratio a channel",
        names,
        Axis::new("RMS residual", "sensor noise").logarithmic(),
    );
    bars.caption(
        "As given: the model as believed. Held out: every stretch simulated with parameters that were fitted without it. 1 is perfect.",
    );
    bars.series("as given", &column(|c| c.before))
        .series("recalibrated only, held out", &column(|c| c.held_out_before))
        .series("improved, held out", &column(|c| c.held_out_after));
    page.figure(bars);
    let mut table = Table::new([
        Column::text("Channel, noise ratio"),
        Column::number("As given"),
        Column::number("Recalibrated, held out"),
        Column::number("Improved, fitted"),
        Column::number("Improved, held out"),
    ]);
    for c in channels {
        table.row([
            c.column.to_string(),
            format!("{:.2}", c.before),
            format!("{:.2}", c.held_out_before),
            format!("{:.2}", c.after),
            format!("{:.2}", c.held_out_after),
        ]);
    }
    page.table(table);
}

fn recordings(page: &mut Page, campaign: &Campaign, diagnosis: &Diagnosis) {
    let specimen = &*campaign.specimen;
    if specimen.recordings().len() < 2 {
        return;
    }
    let mut columns = vec![
        Column::text("Recording, held-out noise ratio"),
        Column::number("Recalibrated"),
    ];
    columns.extend(
        specimen
            .channels()
            .iter()
            .map(|c| Column::number(&format!("Improved: {}", c.column))),
    );
    let mut table = Table::new(columns);
    let ratio = |s: &[f64]| (s.iter().map(|v| v * v).sum::<f64>() / s.len() as f64).sqrt();
    for r in 0..specimen.recordings().len() {
        let before: Vec<f64> = diagnosis.held_out.calibrated[r].iter().map(|c| ratio(c)).collect();
        let before = (before.iter().map(|v| v * v).sum::<f64>() / before.len() as f64).sqrt();
        let mut row: Vec<Cell> = vec![specimen.recording_name(r).into(), format!("{before:.2}").into()];
        row.extend(diagnosis.held_out.improved[r].iter().map(|c| {
            let ratio = ratio(c);
            let text = format!("{ratio:.2}");
            if ratio > 1.5 {
                Cell::warning(text)
            } else {
                Cell::from(text)
            }
        }));
        table.row(row);
    }
    page.details("Recording by recording", table);
}

fn left(page: &mut Page, diagnosis: &Diagnosis) {
    page.text(&format!(
        "Is what is left noise? White: no sample tells of the next; the Ljung-Box statistic over {LAGS} lags stays below \
         {CHI_SQUARE_99} 99 times of 100. Independent: no sample tells of displacement or speed up to {LAGS} samples before. With \
         many samples either test sees what is too small to matter, so the part of the variance stands beside it.",
    ));
    let mut table = Table::new([
        Column::text("Channel"),
        Column::number("Ljung-Box"),
        Column::text("White"),
        Column::text("Strongest input"),
        Column::number("Correlation"),
        Column::number("99 % bound"),
        Column::text("Independent"),
        Column::number("Variance with it, %"),
    ]);
    for (channel, w) in diagnosis.channels.iter().zip(&diagnosis.whiteness) {
        let (input, r) = (w.input).map_or(("", 0.0), |(state, r)| (state.quantity_and_unit().0, r));
        let check = |met: bool| if met { Cell::good("yes") } else { Cell::warning("no") };
        table.row([
            channel.column.to_string().into(),
            significant(w.ljung_box, 3).into(),
            check(w.ljung_box < CHI_SQUARE_99),
            input.into(),
            format!("{r:.4}").into(),
            format!("{:.4}", w.bound).into(),
            check(r.abs() < w.bound),
            significant(100.0 * r * r, 2).into(),
        ]);
    }
    page.table(table);
    let lags: Vec<f64> = (1..=LAGS as u32).map(f64::from).collect();
    let mut curves = Curves::new("Autocorrelation of what is left", Axis::new("Lag", "samples"));
    curves.caption("Held-out residuals of the improved model. White noise stays within the bound at 99 of 100 lags.");
    curves.panel(Axis::new("Correlation", ""));
    for (channel, w) in diagnosis.channels.iter().zip(&diagnosis.whiteness) {
        curves.series(Style::LineAndPoints, channel.column.as_str(), &lags, &w.autocorrelation);
    }
    if let Some(w) = diagnosis.whiteness.first() {
        // The bound of a single lag; that of the table is for all lags together.
        let bound = w.bound * 2.576 / 3.49;
        curves.horizontal(bound, "99 % bound").horizontal(-bound, "");
    }
    page.figure(curves);
}
