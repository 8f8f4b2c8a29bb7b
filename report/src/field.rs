//! A quantity over two others: the contours of a design study, a map of a deviation over speed and pressure. Missing
//! values (NaN) are gaps, as where a vehicle rolled over.

use plotly::common::{ColorBar, ColorScale, ColorScalePalette, Line, Marker, MarkerSymbol, Mode, Title};
use plotly::contour::Contours;
use plotly::{Contour, HeatMap, Scatter, Trace};
use serde_json::json;

use crate::axis::{Axis, escape_plotly};
use crate::decimate::rounded;
use crate::figure::{Drawing, Figure, colour};

/// Height of a field.
const HEIGHT_PX: usize = 460;

/// How a field is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldStyle {
    /// Coloured cells: shows every value as it is.
    HeatMap,
    /// Filled contours with labels.
    Contour,
}

/// A field `z` over a grid of `x` (columns) and `y` (rows).
#[derive(Clone)]
pub struct Field {
    title: String,
    caption: String,
    axes: [Axis; 3],
    style: FieldStyle,
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<Vec<f64>>,
    paths: Vec<Path>,
}

#[derive(Clone)]
struct Path {
    name: String,
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Field {
    /// `z[row][column]` is the value at `y[row]`, `x[column]`; a short row is a gap.
    pub fn new(title: &str, style: FieldStyle, axes: [Axis; 3], x: &[f64], y: &[f64], z: &[Vec<f64>]) -> Self {
        let z = z.iter().map(|row| rounded(row)).collect();
        Self {
            title: title.into(),
            caption: String::new(),
            axes,
            style,
            x: rounded(x),
            y: rounded(y),
            z,
            paths: Vec::new(),
        }
    }

    /// Words under the figure: what to see in it.
    pub fn caption(&mut self, caption: &str) -> &mut Self {
        self.caption = caption.into();
        self
    }

    /// Draws points joined in their order upon the field: the path of an optimiser, or a single chosen point.
    pub fn path(&mut self, name: &str, x: &[f64], y: &[f64]) -> &mut Self {
        self.paths.push(Path {
            name: name.into(),
            x: rounded(x),
            y: rounded(y),
        });
        self
    }

    fn into_figure(self) -> Figure {
        let [x_axis, y_axis, z_axis] = &self.axes;
        // A long title would squeeze the field or be cut off beside it.
        let bar = ColorBar::new()
            .title(Title::with_text(escape_plotly(z_axis.unit())))
            .thickness(14)
            .outline_width(0);
        let scale = ColorScale::Palette(ColorScalePalette::Viridis);
        let (x, y, z) = (self.x, self.y, self.z);
        let field: Box<dyn Trace> = match self.style {
            FieldStyle::HeatMap => HeatMap::new(x, y, z).color_bar(bar).color_scale(scale),
            FieldStyle::Contour => Contour::new(x, y, z)
                .color_bar(bar)
                .color_scale(scale)
                .connect_gaps(false)
                .contours(Contours::new().show_labels(true)),
        };
        let mut traces = vec![field];
        for (index, path) in self.paths.into_iter().enumerate() {
            traces.push(path.into_trace(colour(index + 1)));
        }
        let layout = json!({ "xaxis": x_axis.to_json(), "yaxis": y_axis.to_json(), "legend": { "orientation": "h", "y": -0.2 } });
        Figure {
            title: self.title,
            caption: [format!("Colour: {}.", z_axis.label()), self.caption]
                .join(" ")
                .trim_end()
                .to_owned(),
            height_px: HEIGHT_PX,
            link: None,
            drawing: Drawing { traces, layout },
        }
    }
}

impl Path {
    fn into_trace(self, colour: &'static str) -> Box<dyn Trace> {
        Scatter::new(self.x, self.y)
            .name(escape_plotly(&self.name))
            .mode(Mode::LinesMarkers)
            .marker(Marker::new().size(8).color(colour).symbol(MarkerSymbol::Circle))
            .line(Line::new().color(colour).width(2.0))
    }
}

impl From<Field> for Figure {
    fn from(figure: Field) -> Self {
        figure.into_figure()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    fn drawn(style: FieldStyle) -> Value {
        let axes = [
            Axis::new("Gas volume", "l").logarithmic(),
            Axis::new("Damper factor", ""),
            Axis::new("Roll", "deg"),
        ];
        let z = vec![vec![1.0, f64::NAN], vec![2.0, 3.0], vec![4.0, 5.0]];
        let mut field = Field::new("Roll", style, axes, &[0.1, 1.0], &[0.8, 1.0, 3.0], &z);
        field.path("optimum", &[0.1], &[0.8]);
        serde_json::to_value(field.into_figure().drawing).expect("plain data")
    }

    #[test]
    fn every_style_has_the_grid_the_gap_and_the_path() {
        for (style, kind) in [(FieldStyle::HeatMap, "heatmap"), (FieldStyle::Contour, "contour")] {
            let drawing = drawn(style);
            assert_eq!(drawing["data"][0]["type"], kind);
            assert_eq!(drawing["data"][0]["z"][0][1], Value::Null);
            assert_eq!(drawing["data"][1]["type"], "scatter");
        }
    }

    #[test]
    fn axes_are_named_with_units() {
        assert_eq!(
            drawn(FieldStyle::Contour)["layout"]["xaxis"]["title"]["text"],
            "Gas volume, l"
        );
    }
}
