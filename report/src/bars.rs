//! Bar charts of named quantities, with intervals if the values are estimates.

use plotly::common::{ErrorData, ErrorType, Marker};
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
        let bar = self.bar(name, values);
        self.traces.push(bar);
        self
    }

    /// One value per category with its interval; `low` and `high` are values, not distances.
    pub fn series_with_interval(&mut self, name: &str, values: &[f64], low: &[f64], high: &[f64]) -> &mut Self {
        let above = values.iter().zip(high).map(|(value, high)| high - value).collect();
        let below = values.iter().zip(low).map(|(value, low)| value - low).collect();
        let interval = ErrorData::new(ErrorType::Data)
            .symmetric(false)
            .array(above)
            .array_minus(below);
        let bar = self.bar(name, values).error_y(interval);
        self.traces.push(bar);
        self
    }

    fn bar(&self, name: &str, values: &[f64]) -> Box<Bar<String, f64>> {
        Bar::new(self.categories.clone(), rounded(values))
            .name(escape_plotly(name))
            .marker(Marker::new().color(colour(self.traces.len())))
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
    fn intervals_are_distances_to_plotly() {
        let mut bars = Bars::new("Confidence", ["friction", "leak"], Axis::new("Noise ratio", ""));
        bars.series_with_interval("with", &[2.0, 4.0], &[1.5, 3.0], &[2.25, 6.0]);
        let drawing = serde_json::to_value(bars.into_figure().drawing).expect("plain data");
        assert_eq!(drawing["data"][0]["error_y"]["array"], json!([0.25, 2.0]));
        assert_eq!(drawing["data"][0]["error_y"]["arrayminus"], json!([0.5, 1.0]));
        assert_eq!(drawing["data"][0]["type"], "bar");
    }
}
