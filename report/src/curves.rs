//! Curves over a common horizontal axis, in one panel or several stacked ones that zoom together. Time histories, loops and
//! characteristics are all this figure.

use plotly::Scatter;
use plotly::Trace;
use plotly::common::{DashType, ErrorData, ErrorType, HoverInfo, Line, LineShape, Marker, Mode, Position};
use serde_json::{Value, json};

use crate::axis::{Axis, escape_plotly};
use crate::decimate::{drawn, extrema_by_bucket, rounded};
use crate::figure::{Drawing, Figure, colour};

/// Buckets a line is reduced to: about three per pixel of a wide page are not visible.
const BUCKETS: usize = 700;
/// Height of a single panel, and of each of several.
const SINGLE_HEIGHT_PX: usize = 420;
const STACKED_HEIGHT_PX: usize = 190;

/// How a series is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// A line through the points.
    #[default]
    Line,
    /// Dashed, for a prediction, a reference or a bound.
    Dashed,
    /// Held until the next point, for switching signals.
    Step,
    /// A thin line without decimation, for outlines with gaps.
    Outline,
    /// Markers only, for measurements.
    Points,
    /// Markers joined by a line, for few points in an order (the path of an optimiser).
    LineAndPoints,
    /// Markers with the name of the series at the first one, for few points that must be told apart.
    NamedPoints,
}

/// One or several stacked panels over a shared horizontal axis; see the example in the crate's documentation.
#[derive(Clone)]
pub struct Curves {
    title: String,
    caption: String,
    x_axis: Axis,
    link: Option<String>,
    equal_scales: bool,
    height_px: Option<usize>,
    panels: Vec<Panel>,
}

#[derive(Clone)]
struct Panel {
    y_axis: Axis,
    series: Vec<Series>,
    shapes: Vec<Value>,
    annotations: Vec<Value>,
}

#[derive(Clone)]
struct Series {
    name: String,
    style: Style,
    colour: usize,
    x: Vec<f64>,
    y: Vec<f64>,
    interval: Option<(Vec<f64>, Vec<f64>)>,
}

impl Curves {
    /// A figure without panels; add the first with [`panel`](Self::panel).
    pub fn new(title: &str, x_axis: Axis) -> Self {
        Self {
            title: title.into(),
            caption: String::new(),
            x_axis,
            link: None,
            equal_scales: false,
            height_px: None,
            panels: Vec::new(),
        }
    }

    /// Words under the figure: what to see in it.
    pub fn caption(&mut self, caption: &str) -> &mut Self {
        self.caption = caption.into();
        self
    }

    /// Zooms horizontally together with all figures of the page linked under the same name ("time").
    pub fn link(&mut self, name: &str) -> &mut Self {
        self.link = Some(name.into());
        self
    }

    /// One unit is as long on both axes, for plans and paths.
    pub fn equal_scales(&mut self) -> &mut Self {
        self.equal_scales = true;
        self
    }

    /// Height of the whole figure where the usual does not do.
    pub fn height(&mut self, height_px: usize) -> &mut Self {
        self.height_px = Some(height_px);
        self
    }

    /// Adds a panel below the others; what follows is drawn in it.
    pub fn panel(&mut self, y_axis: Axis) -> &mut Self {
        self.panels.push(Panel {
            y_axis,
            series: Vec::new(),
            shapes: Vec::new(),
            annotations: Vec::new(),
        });
        self
    }

    /// Adds a line. Long ones are reduced to what is visible, peaks kept.
    pub fn line(&mut self, name: &str, x: &[f64], y: &[f64]) -> &mut Self {
        self.series(Style::Line, name, x, y)
    }

    /// Adds a series. The same name in several panels has one colour and one entry in the legend.
    pub fn series(&mut self, style: Style, name: &str, x: &[f64], y: &[f64]) -> &mut Self {
        let colour = self.colour_of(name);
        let (x, y) = match style {
            Style::Outline | Style::Points | Style::LineAndPoints | Style::NamedPoints => (x.into(), y.into()),
            _ => extrema_by_bucket(x, y, BUCKETS),
        };
        let series = Series {
            name: name.into(),
            style,
            colour,
            x: rounded(&x),
            y: drawn(&y),
            interval: None,
        };
        self.last_panel().series.push(series);
        self
    }

    /// Adds markers with intervals: `low` and `high` are values, not distances.
    pub fn points_with_interval(&mut self, name: &str, x: &[f64], y: &[f64], low: &[f64], high: &[f64]) -> &mut Self {
        self.series(Style::Points, name, x, y);
        let above = y.iter().zip(high).map(|(y, high)| high - y).collect();
        let below = y.iter().zip(low).map(|(y, low)| y - low).collect();
        if let Some(series) = self.last_panel().series.last_mut() {
            series.interval = Some((above, below));
        }
        self
    }

    /// Shades the stretch `from..to` of the horizontal axis in the last panel, such as where a deviation was found.
    pub fn region(&mut self, from: f64, to: f64, label: &str) -> &mut Self {
        let panel = self.last_panel();
        panel.shapes.push(json!({
            "type": "rect", "x0": from, "x1": to, "y0": 0, "y1": 1, "yref": "domain", "layer": "below",
            "fillcolor": "rgba(230,159,0,0.22)", "line": { "width": 0 },
        }));
        panel.annotations.push(json!({
            "x": 0.5 * (from + to), "y": 1, "yref": "domain", "yanchor": "top", "showarrow": false,
            "text": escape_plotly(label), "font": { "size": 11 },
        }));
        self
    }

    /// Marks an instant (or another place on the horizontal axis) in the last panel.
    pub fn vertical(&mut self, x: f64, label: &str) -> &mut Self {
        let panel = self.last_panel();
        panel.shapes.push(json!({
            "type": "line", "x0": x, "x1": x, "y0": 0, "y1": 1, "yref": "domain",
            "line": { "color": "#888888", "width": 1, "dash": "dot" },
        }));
        panel.annotations.push(json!({
            "x": x, "y": 1, "yref": "domain", "yanchor": "top", "xanchor": "left", "showarrow": false,
            "text": escape_plotly(label), "font": { "size": 11 },
        }));
        self
    }

    /// Marks a value, such as a limit, across the last panel.
    pub fn horizontal(&mut self, y: f64, label: &str) -> &mut Self {
        let panel = self.last_panel();
        panel.shapes.push(json!({
            "type": "line", "x0": 0, "x1": 1, "xref": "domain", "y0": y, "y1": y,
            "line": { "color": "#888888", "width": 1, "dash": "dot" },
        }));
        panel.annotations.push(json!({
            "x": 1, "xref": "domain", "y": y, "xanchor": "right", "yanchor": "bottom", "showarrow": false,
            "text": escape_plotly(label), "font": { "size": 11 },
        }));
        self
    }

    fn last_panel(&mut self) -> &mut Panel {
        if self.panels.is_empty() {
            self.panel(Axis::new("", ""));
        }
        let last = self.panels.len() - 1;
        &mut self.panels[last]
    }

    fn colour_of(&self, name: &str) -> usize {
        let mut seen: Vec<&str> = Vec::new();
        for series in self.panels.iter().flat_map(|panel| &panel.series) {
            if series.name == name {
                return series.colour;
            }
            if !seen.contains(&series.name.as_str()) {
                seen.push(&series.name);
            }
        }
        seen.len()
    }

    fn into_figure(self) -> Figure {
        let count = self.panels.len().max(1);
        let height_px = self.height_px.unwrap_or(if count == 1 {
            SINGLE_HEIGHT_PX
        } else {
            90 + STACKED_HEIGHT_PX * count
        });
        // Every panel has the same share of the height, less a gap for the eye.
        let gap = 0.24 / (count as f64 * 2.0);
        let share = (1.0 - gap * (count as f64 - 1.0)) / count as f64;

        let mut x_axis = self.x_axis.to_json();
        x_axis["anchor"] = json!(axis_name("y", count - 1));
        if self.equal_scales {
            x_axis["scaleanchor"] = json!("y");
        }
        let mut layout = json!({
            "xaxis": x_axis, "hovermode": "x unified", "hoversubplots": "axis", "showlegend": true,
        });
        if self
            .panels
            .iter()
            .flat_map(|panel| &panel.series)
            .any(|series| turns_back(&series.x))
        {
            // A loop has several values at one place: show the nearest point instead of all of them.
            layout["hovermode"] = json!("closest");
        }
        let (mut shapes, mut annotations) = (Vec::new(), Vec::new());
        let mut traces: Vec<Box<dyn Trace>> = Vec::new();
        let mut named: Vec<String> = Vec::new();
        for (index, panel) in self.panels.into_iter().enumerate() {
            let y_name = axis_name("y", index);
            let top = 1.0 - index as f64 * (share + gap);
            let mut y_axis = panel.y_axis.to_json();
            y_axis["domain"] = json!([(top - share).max(0.0), top]);
            layout[axis_key("yaxis", index)] = y_axis;
            shapes.extend(panel.shapes.into_iter().map(|shape| in_panel(shape, &y_name)));
            annotations.extend(panel.annotations.into_iter().map(|note| in_panel(note, &y_name)));
            let positions = name_positions(&panel.series);
            for (series, position) in panel.series.into_iter().zip(positions) {
                let first = !named.contains(&series.name);
                traces.push(series.into_trace(&y_name, first, position, &mut named));
            }
        }
        layout["shapes"] = json!(shapes);
        layout["annotations"] = json!(annotations);
        layout["showlegend"] = json!(named.len() > 1);
        Figure {
            title: self.title,
            caption: self.caption,
            height_px,
            link: self.link,
            drawing: Drawing { traces, layout },
        }
    }
}

impl Series {
    /// `position` is where its name stands if it is one of points with names.
    fn into_trace(self, y_axis: &str, in_legend: bool, position: Position, named: &mut Vec<String>) -> Box<dyn Trace> {
        let colour = colour(self.colour);
        let line = match self.style {
            Style::Dashed => Line::new().dash(DashType::Dash),
            Style::Step => Line::new().shape(LineShape::Hv),
            _ => Line::new(),
        };
        let mode = match self.style {
            Style::Points => Mode::Markers,
            Style::LineAndPoints => Mode::LinesMarkers,
            Style::NamedPoints => Mode::MarkersText,
            _ => Mode::Lines,
        };
        let name = escape_plotly(&self.name);
        let mut trace = Scatter::new(self.x, self.y)
            .name(&name)
            .legend_group(&name)
            .show_legend(in_legend)
            .mode(mode)
            .line(
                line.width(if self.style == Style::Outline { 0.8 } else { 1.5 })
                    .color(colour),
            )
            .marker(Marker::new().size(6).color(colour))
            .y_axis(y_axis);
        if self.style == Style::Outline {
            trace = trace.hover_info(HoverInfo::Skip);
        }
        if self.style == Style::NamedPoints {
            trace = trace
                .text_array(vec![in_lines(&self.name)])
                .text_position(position)
                .clip_on_axis(false);
        }
        if let Some((above, below)) = self.interval {
            trace = trace.error_y(
                ErrorData::new(ErrorType::Data)
                    .symmetric(false)
                    .array(above)
                    .array_minus(below),
            );
        }
        if in_legend {
            named.push(self.name);
        }
        trace
    }
}

/// Longest line of a name at a point, characters.
const LINE: usize = 18;

/// A name in lines that have room on a narrow page, as plotly.js shows it.
fn in_lines(name: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    for word in name.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= LINE => *line += &format!(" {word}"),
            _ => lines.push(word.to_owned()),
        }
    }
    let lines: Vec<String> = lines.iter().map(|line| escape_plotly(line)).collect();
    lines.join("<br>")
}

/// "y", "y2", "y3": how traces name an axis.
fn axis_name(letter: &str, index: usize) -> String {
    if index == 0 {
        letter.to_owned()
    } else {
        format!("{letter}{}", index + 1)
    }
}

/// "yaxis", "yaxis2": how the layout names it.
fn axis_key(prefix: &str, index: usize) -> String {
    axis_name(prefix, index)
}

/// Ties a shape or note to its panel; a reference to the whole "domain" becomes that of the panel.
fn in_panel(mut item: Value, y_name: &str) -> Value {
    item["yref"] = if item["yref"] == "domain" {
        json!(format!("{y_name} domain"))
    } else {
        json!(y_name)
    };
    item["xref"] = if item["xref"] == "domain" {
        json!("x domain")
    } else {
        json!("x")
    };
    item
}

/// How close above a point another one must be for its name to be in the way, as parts of the panel's width and height.
const IN_THE_WAY: [f64; 2] = [0.2, 0.15];

/// Where the names of points stand: on the side where there is more room, and below their point where another point with a name is close above.
fn name_positions(series: &[Series]) -> Vec<Position> {
    let range = |of: fn(&Series) -> &Vec<f64>| {
        let all = || series.iter().flat_map(move |series| of(series).iter().copied());
        let (least, most) = (
            all().fold(f64::INFINITY, f64::min),
            all().fold(f64::NEG_INFINITY, f64::max),
        );
        (0.5 * (least + most), most - least)
    };
    let ((middle, width), (_, height)) = (range(|series| &series.x), range(|series| &series.y));
    let first = |series: &Series| Some((series.x.first().copied()?, series.y.first().copied()?));
    let named: Vec<(f64, f64)> = (series.iter())
        .filter(|series| series.style == Style::NamedPoints)
        .filter_map(first)
        .collect();
    let is_in_the_way = |(x, y): (f64, f64), (other_x, other_y): (f64, f64)| {
        let [beside, above] = [(other_x - x).abs() / width, (other_y - y) / height];
        above > 0.0 && above < IN_THE_WAY[1] && beside < IN_THE_WAY[0]
    };
    (series.iter())
        .map(|series| match first(series) {
            Some(at) => match (named.iter().any(|&other| is_in_the_way(at, other)), at.0 > middle) {
                (false, false) => Position::TopRight,
                (false, true) => Position::TopLeft,
                (true, false) => Position::BottomRight,
                (true, true) => Position::BottomLeft,
            },
            None => Position::TopRight,
        })
        .collect()
}

fn turns_back(x: &[f64]) -> bool {
    x.windows(2).any(|pair| pair[1] < pair[0])
}

impl From<Curves> for Figure {
    fn from(figure: Curves) -> Self {
        figure.into_figure()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Value {
        let mut curves = Curves::new("Strut", Axis::new("Time", "s"));
        curves
            .panel(Axis::new("Force", "kN"))
            .line("measured", &[0.0, 1.0], &[1.0, f64::NAN]);
        curves
            .series(Style::Dashed, "predicted", &[0.0, 1.0], &[1.0, 2.0])
            .region(0.2, 0.4, "found");
        curves
            .panel(Axis::new("Pressure", "MPa"))
            .line("measured", &[0.0, 1.0], &[3.0, 4.0])
            .horizontal(20.0, "limit");
        serde_json::to_value(curves.into_figure().drawing).expect("plain data")
    }

    #[test]
    fn panels_share_the_horizontal_axis() {
        let drawing = example();
        assert_eq!(drawing["layout"]["yaxis"]["title"]["text"], "Force, kN");
        assert_eq!(drawing["layout"]["yaxis2"]["title"]["text"], "Pressure, MPa");
        assert_eq!(drawing["layout"]["xaxis"]["anchor"], "y2");
        assert_eq!(drawing["data"][2]["yaxis"], "y2");
        let upper = drawing["layout"]["yaxis"]["domain"][0].as_f64().expect("a number");
        let lower = drawing["layout"]["yaxis2"]["domain"][1].as_f64().expect("a number");
        assert!(upper > lower, "the first panel is the upper one");
    }

    #[test]
    fn a_name_has_one_colour_and_one_legend_entry() {
        let drawing = example();
        let data = drawing["data"].as_array().expect("traces");
        assert_eq!(data[0]["line"]["color"], data[2]["line"]["color"]);
        assert_ne!(data[0]["line"]["color"], data[1]["line"]["color"]);
        assert_eq!(
            (&data[0]["showlegend"], &data[2]["showlegend"]),
            (&json!(true), &json!(false))
        );
    }

    #[test]
    fn marks_stay_in_their_panel_and_gaps_are_null() {
        let drawing = example();
        assert_eq!(drawing["layout"]["shapes"][0]["yref"], "y domain");
        assert_eq!(drawing["layout"]["shapes"][1]["yref"], "y2");
        assert_eq!(drawing["layout"]["shapes"][1]["xref"], "x domain");
        assert_eq!(drawing["data"][0]["y"][1], Value::Null);
        assert_eq!(drawing["data"][1]["line"]["dash"], "dash");
    }

    #[test]
    fn the_name_of_a_point_stands_where_there_is_room() {
        let mut curves = Curves::new("Settings", Axis::new("Ride", ""));
        let panel = curves.panel(Axis::new("Roll", ""));
        for (name, x, y) in [
            ("high", 1.0, 3.0),
            ("above", 1.0, 1.1),
            ("below", 1.02, 1.0),
            ("stiff", 3.0, 1.0),
        ] {
            panel.series(Style::NamedPoints, name, &[x], &[y]);
        }
        let drawing = serde_json::to_value(curves.into_figure().drawing).expect("plain data");
        let positions: Vec<&Value> = (0..4).map(|k| &drawing["data"][k]["textposition"]).collect();
        assert_eq!(positions, ["top right", "top right", "bottom right", "top left"]);
    }

    #[test]
    fn a_loop_is_read_by_its_nearest_point() {
        let mut curves = Curves::new("Loop", Axis::new("Displacement", "mm"));
        curves
            .panel(Axis::new("Force", "kN"))
            .line("measured", &[0.0, 1.0, 0.0], &[0.0, 1.0, 0.5]);
        assert_eq!(curves.into_figure().drawing.layout["hovermode"], "closest");
    }
}
