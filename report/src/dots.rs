//! Dot plots: a few values of several named quantities along one axis, with a line at the value that is held against them.

use plotly::common::{Marker, Mode};
use plotly::{Scatter, Trace};
use serde_json::{Value, json};

use crate::axis::{Axis, escape_plotly};
use crate::decimate::rounded;
use crate::figure::{Drawing, Figure, colour};

/// Height of a row, and of what is above and below the rows.
const ROW_HEIGHT_PX: usize = 34;
const MARGIN_PX: usize = 110;

/// A row for each quantity, a colour for each series.
#[derive(Clone)]
pub struct Dots {
    title: String,
    caption: String,
    rows: Vec<String>,
    x_axis: Axis,
    traces: Vec<Box<dyn Trace>>,
    shapes: Vec<Value>,
    annotations: Vec<Value>,
}

impl Dots {
    /// A figure without series. The first row is the upper one.
    pub fn new<'a>(title: &str, rows: impl IntoIterator<Item = &'a str>, x_axis: Axis) -> Self {
        Self {
            title: title.into(),
            caption: String::new(),
            rows: rows.into_iter().map(escape_plotly).collect(),
            x_axis,
            traces: Vec::new(),
            shapes: Vec::new(),
            annotations: Vec::new(),
        }
    }

    /// Words under the figure: what to see in it.
    pub fn caption(&mut self, caption: &str) -> &mut Self {
        self.caption = caption.into();
        self
    }

    /// One value for each row; NaN leaves a gap.
    pub fn series(&mut self, name: &str, values: &[f64]) -> &mut Self {
        let trace = Scatter::new(rounded(values), self.rows.clone())
            .name(escape_plotly(name))
            .mode(Mode::Markers)
            .marker(Marker::new().size(11).opacity(0.85).color(colour(self.traces.len())));
        self.traces.push(trace);
        self
    }

    /// A line across all rows at a value in the axis's unit.
    pub fn line(&mut self, at: f64, label: &str) -> &mut Self {
        self.shapes.push(json!({
            "type": "line", "x0": at, "x1": at, "y0": 0, "y1": 1, "yref": "paper",
            "line": { "color": "#888888", "width": 1.5 },
        }));
        self.annotations.push(json!({
            // A note on a logarithmic axis is placed by the exponent, a line by the value.
            "x": if self.x_axis.is_logarithmic() { libm::log10(at) } else { at },
            "y": 0, "yref": "paper", "yanchor": "bottom", "xanchor": "left", "showarrow": false,
            "text": escape_plotly(label), "font": { "size": 11 },
        }));
        self
    }

    fn into_figure(self) -> Figure {
        let layout = json!({
            "xaxis": self.x_axis.to_json(),
            "yaxis": {
                "automargin": true, "type": "category", "categoryorder": "array", "showspikes": false,
                // Room below the last row for the label of the line.
                "range": [-1.0, self.rows.len() as f64 - 0.4],
                "categoryarray": self.rows.iter().rev().collect::<Vec<_>>(),
            },
            "showlegend": self.traces.len() > 1, "hovermode": "closest",
            "shapes": self.shapes, "annotations": self.annotations,
        });
        Figure {
            title: self.title,
            caption: self.caption,
            height_px: MARGIN_PX + ROW_HEIGHT_PX * self.rows.len(),
            link: None,
            drawing: Drawing {
                traces: self.traces,
                layout,
            },
        }
    }
}

impl From<Dots> for Figure {
    fn from(figure: Dots) -> Self {
        figure.into_figure()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_read_from_the_top_and_the_line_is_where_it_says() {
        let mut dots = Dots::new(
            "Noise",
            ["force_N", "p1_Pa"],
            Axis::new("Noise ratio", "").logarithmic(),
        );
        dots.series("as given", &[9.0, 4.0])
            .series("improved", &[1.0, f64::NAN])
            .line(1.0, "only noise");
        let drawing = serde_json::to_value(dots.into_figure().drawing).expect("plain data");
        assert_eq!(drawing["layout"]["yaxis"]["categoryarray"], json!(["p1_Pa", "force_N"]));
        assert_eq!(
            (&drawing["data"][0]["x"], &drawing["data"][0]["y"]),
            (&json!([9.0, 4.0]), &json!(["force_N", "p1_Pa"]))
        );
        assert_eq!(drawing["data"][1]["x"], json!([1.0, null]));
        assert_eq!(drawing["layout"]["shapes"][0]["x0"], 1.0);
        assert_eq!(
            drawing["layout"]["annotations"][0]["x"], 0.0,
            "an exponent on a logarithmic axis"
        );
    }
}
