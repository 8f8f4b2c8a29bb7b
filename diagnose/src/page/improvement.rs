//! The section "How much better": held-out noise ratios, and tests whether the residuals are noise.

use oleo_report::{Axis, Cell, Column, Curves, Dots, Page, Style, Table, significant};

use crate::campaign::Campaign;
use crate::diagnosis::Diagnosis;
use crate::vocabulary::State;
use crate::whiteness::{CHI_SQUARE_99, LAGS, Whiteness};

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
    let mut dots = Dots::new(
        "Noise ratio of each channel",
        names,
        Axis::new("RMS residual over sensor noise", "").logarithmic(),
    );
    dots.caption(
        "The first series is the model as it was given. In the held-out series every stretch of the recordings is predicted with \
         parameters that were fitted without it. At the line only sensor noise is left.",
    );
    dots.series("as given", &column(|c| c.before))
        .series("recalibrated only, held out", &column(|c| c.held_out_before))
        .series("improved, held out", &column(|c| c.held_out_after))
        .line(1.0, "only noise");
    page.figure(dots);
    let mut table = Table::new([
        Column::text("Noise ratio of channel"),
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
        Column::text("Held-out noise ratio of recording"),
        Column::number("Recalibrated, all channels"),
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

/// The table of the residual tests as a sentence, made from the same figures.
pub(super) fn residuals_in_words(diagnosis: &Diagnosis) -> String {
    let tested: Vec<(&str, &Whiteness)> = (diagnosis.channels.iter().zip(&diagnosis.whiteness))
        .map(|(channel, w)| (channel.column.as_str(), w))
        .collect();
    in_words(&tested)
}

fn in_words(tested: &[(&str, &Whiteness)]) -> String {
    let failing: Vec<&str> = (tested.iter())
        .filter(|(_, w)| !(w.is_white() && w.is_independent()))
        .map(|(channel, _)| *channel)
        .collect();
    if failing.is_empty() {
        return "The held-out residuals of every channel are white and independent of the inputs.".into();
    }
    let most = (tested.iter().map(|(_, w)| w.explained())).fold(0.0, f64::max);
    let inputs = match tested.iter().any(|(_, w)| is_of_named_inputs(w)) {
        true => "the inputs and their rates",
        false => "displacement and speed",
    };
    format!(
        "The held-out residuals of {} fail at least one of the two tests of residuals; {inputs} explain at most \
         {} % of the variance of any channel.",
        failing.join(", "),
        significant(100.0 * most, 2)
    )
}

/// Whether the inputs are those of somebody else's model.
fn is_of_named_inputs(whiteness: &Whiteness) -> bool {
    matches!(whiteness.input, Some((State::Named(_), _)))
}

fn left(page: &mut Page, diagnosis: &Diagnosis) {
    let inputs = match diagnosis.whiteness.iter().any(is_of_named_inputs) {
        true => "with an input nor with the rate of one",
        false => "with displacement nor with speed",
    };
    page.text(&format!(
        "Two tests check whether the held-out residuals of the improved model are noise. A residual is white if no sample helps \
         to predict the following ones; the Ljung-Box statistic over {LAGS} lags then stays below {CHI_SQUARE_99} in 99 of 100 \
         cases. A residual is independent if it correlates neither {inputs} up to {LAGS} samples \
         earlier. With many samples both tests also detect effects that are too small to matter, so the last column says how \
         much of the residual's variance the input explains. {}",
        residuals_in_words(diagnosis)
    ));
    let mut table = Table::new([
        Column::text("Channel"),
        Column::number("Ljung-Box statistic"),
        Column::text("White"),
        Column::text("Input with the strongest correlation"),
        Column::number("Correlation"),
        Column::number("99 % bound"),
        Column::text("Independent"),
        Column::number("Variance that the input explains, %"),
    ]);
    for (channel, w) in diagnosis.channels.iter().zip(&diagnosis.whiteness) {
        let (input, r) = (w.input).map_or(("", 0.0), |(state, r)| (state.quantity_and_unit().0, r));
        let check = |met: bool| if met { Cell::good("yes") } else { Cell::warning("no") };
        table.row([
            channel.column.to_string().into(),
            significant(w.ljung_box, 3).into(),
            check(w.is_white()),
            input.into(),
            format!("{r:.4}").into(),
            format!("{:.4}", w.bound).into(),
            check(w.is_independent()),
            significant(100.0 * w.explained(), 2).into(),
        ]);
    }
    page.table(table);
    let lags: Vec<f64> = (1..=LAGS as u32).map(f64::from).collect();
    let mut curves = Curves::new("Autocorrelation of the residuals", Axis::new("Lag", "samples"));
    curves.caption(
        "These are the held-out residuals of the improved model. White noise stays within the bound at 99 of 100 lags.",
    );
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

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(ljung_box: f64, correlation: f64) -> Whiteness {
        Whiteness {
            autocorrelation: vec![0.0; LAGS],
            ljung_box,
            input: Some((State::Speed, correlation)),
            bound: 0.01,
        }
    }

    #[test]
    fn the_sentence_names_every_channel_that_the_table_fails() {
        let (noise, coloured, dependent) = (channel(20.0, 0.001), channel(2188.0, 0.001), channel(20.0, -0.06));
        let good = in_words(&[("p1_Pa", &noise)]);
        assert!(good.contains("every channel are white and independent"), "{good}");
        let text = in_words(&[("p1_Pa", &noise), ("force_N", &coloured), ("p2_Pa", &dependent)]);
        assert!(
            text.contains("residuals of force_N, p2_Pa fail") && text.contains("0.36 %"),
            "{text}"
        );
    }
}
