//! Bar charts of named quantities.

use plotly::common::Marker;
use plotly::{Bar, Trace};
use serde_json::json;

use crate::axis::{Axis, escape_plotly};
use crate::decimate::rounded;
use crate::figure::{Drawing, Figure, colour};

/// Bars by category, one group of bars per series.
#[derive(Clone)]
pub struct Bars {
    title: String,
    caption: String,
    categories: Vec<String>,
    y_axis: Axis,
    traces: Vec<Box<dyn Trace>>,
}

impl Bars {
    /// A figure without series.
    pub fn new<'a>(title: &str, categories: impl IntoIterator<Item = &'a str>, y_axis: Axis) -> Self {
        let categories = categories.into_iter().map(escape_plotly).collect();
        Self {
            title: title.into(),
            caption: String::new(),
            categories,
            y_axis,
            traces: Vec::new(),
        }
    }

    /// Words under the figure: what to see in it.
    pub fn caption(&mut self, caption: &str) -> &mut Self {
        self.caption = caption.into();
        self
    }

    /// One value per category; NaN leaves a gap.
    pub fn series(&mut self, name: &str, values: &[f64]) -> &mut Self {
        let bar = Bar::new(self.categories.clone(), rounded(values))
            .name(escape_plotly(name))
            .marker(Marker::new().color(colour(self.traces.len())));
        self.traces.push(bar);
        self
    }

    fn into_figure(self) -> Figure {
        let layout = json!({
            "xaxis": { "automargin": true, "type": "category" }, "yaxis": self.y_axis.to_json(),
            "barmode": "group", "showlegend": self.traces.len() > 1, "hovermode": "x unified",
        });
        Figure {
            title: self.title,
            caption: self.caption,
            height_px: 380,
            link: None,
            drawing: Drawing {
                traces: self.traces,
                layout,
            },
        }
    }
}

impl From<Bars> for Figure {
    fn from(figure: Bars) -> Self {
        figure.into_figure()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_series_is_a_group_of_bars_in_a_colour_of_its_own() {
        let mut bars = Bars::new("Noise", ["friction", "leak"], Axis::new("Noise ratio", ""));
        bars.series("without", &[9.0, 4.0]).series("with", &[2.0, f64::NAN]);
        let drawing = serde_json::to_value(bars.into_figure().drawing).expect("plain data");
        assert_eq!(drawing["layout"]["barmode"], "group");
        let [without, with] = [&drawing["data"][0], &drawing["data"][1]];
        assert_eq!((&without["type"], &without["y"]), (&json!("bar"), &json!([9.0, 4.0])));
        assert_eq!(with["y"], json!([2.0, null]));
        assert_ne!(without["marker"]["color"], with["marker"]["color"]);
    }
}
