//! Swim lanes: what state each of several things was in over a common axis, one lane a thing. For modes, faults and valves,
//! which have states and no values.

use plotly::common::{Fill, HoverInfo, Line, Marker, Mode};
use plotly::{Scatter, Trace};
use serde_json::json;

use crate::axis::{Axis, escape_plotly};
use crate::figure::{Drawing, Figure};

/// Height of a lane, and of what is above and below them.
const LANE_HEIGHT_PX: usize = 22;
const MARGIN_PX: usize = 110;
/// Half the height of a stretch in its lane of height 1.
const HALF: f64 = 0.38;
/// Number of places along the axis at which the states can be read with the pointer.
const READINGS: usize = 400;

/// Colour of a state, by what it means. All have three quarters of their strength on light and dark grounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tint {
    /// Nothing to say yet.
    Grey,
    /// Switched on, open.
    Blue,
    /// Another choice, as good as the one without colour.
    Sky,
    /// As it should be.
    Green,
    /// Restricted.
    Amber,
    /// Failed.
    Red,
    /// Done from outside.
    Violet,
    /// Ended for good.
    Pink,
}

impl Tint {
    fn colour(self) -> &'static str {
        match self {
            Self::Grey => "rgba(127,127,127,0.55)",
            Self::Blue => "rgba(0,114,178,0.75)",
            Self::Sky => "rgba(86,180,233,0.75)",
            Self::Green => "rgba(0,158,115,0.75)",
            Self::Amber => "rgba(230,159,0,0.8)",
            Self::Red => "rgba(213,94,0,0.85)",
            Self::Violet => "rgba(140,107,177,0.85)",
            Self::Pink => "rgba(204,121,167,0.85)",
        }
    }
}

/// Lanes over a common axis, the first at the top.
#[derive(Clone)]
pub struct Lanes {
    title: String,
    caption: String,
    x_axis: Axis,
    link: Option<String>,
    lanes: Vec<Lane>,
}

#[derive(Clone)]
struct Lane {
    name: String,
    stretches: Vec<Stretch>,
}

#[derive(Clone)]
struct Stretch {
    from: f64,
    to: f64,
    state: String,
    tint: Tint,
}

impl Lanes {
    /// A figure without lanes.
    pub fn new(title: &str, x_axis: Axis) -> Self {
        Self {
            title: title.into(),
            caption: String::new(),
            x_axis,
            link: None,
            lanes: Vec::new(),
        }
    }

    /// Words under the figure: what to see in it.
    pub fn caption(&mut self, caption: &str) -> &mut Self {
        self.caption = caption.into();
        self
    }

    /// Zooms together with all figures of the page that are linked under the same name.
    pub fn link(&mut self, name: &str) -> &mut Self {
        self.link = Some(name.into());
        self
    }

    /// Adds a lane below the others; the stretches that follow are in it.
    pub fn lane(&mut self, name: &str) -> &mut Self {
        self.lanes.push(Lane {
            name: name.into(),
            stretches: Vec::new(),
        });
        self
    }

    /// The last lane's thing was in `state` from `from` to `to`. Between stretches nothing is drawn.
    pub fn stretch(&mut self, from: f64, to: f64, state: &str, tint: Tint) -> &mut Self {
        if let Some(lane) = self.lanes.last_mut() {
            lane.stretches.push(Stretch {
                from,
                to,
                state: state.into(),
                tint,
            });
        }
        self
    }

    /// Adds stretches of the last lane from a state for each sample, given with its word and colour; `None` is nothing to
    /// draw. `at` has one value more than `states`: where the last one ends.
    pub fn samples<'a>(&mut self, at: &[f64], states: impl IntoIterator<Item = Option<(&'a str, Tint)>>) -> &mut Self {
        let mut begun: Option<(f64, &str, Tint)> = None;
        let mut end = at.first().copied().unwrap_or(0.0);
        for (from_to, state) in at.windows(2).zip(states) {
            if begun.map(|(_, word, tint)| (word, tint)) != state {
                if let Some((from, word, tint)) = begun {
                    self.stretch(from, from_to[0], word, tint);
                }
                begun = state.map(|(word, tint)| (from_to[0], word, tint));
            }
            end = from_to[1];
        }
        if let Some((from, word, tint)) = begun {
            self.stretch(from, end, word, tint);
        }
        self
    }

    fn into_figure(self) -> Figure {
        let count = self.lanes.len();
        // The first lane is at the top, and plotly.js counts upwards.
        let level = |lane: usize| (count - 1 - lane) as f64;
        let mut traces: Vec<Box<dyn Trace>> = self
            .states()
            .into_iter()
            .map(|(state, tint)| self.boxes(&state, tint, level))
            .collect();
        traces.extend(self.readings());
        let mut x_axis = self.x_axis.to_json();
        x_axis["anchor"] = json!("y");
        let ticks: Vec<(f64, &str)> = (0..count)
            .map(|lane| (level(lane), self.lanes[lane].name.as_str()))
            .collect();
        let mut y_axis = Axis::new("", "").ticks(ticks).range(-0.6, count as f64 - 0.4).to_json();
        y_axis["fixedrange"] = json!(true);
        y_axis["showgrid"] = json!(false);
        y_axis["zeroline"] = json!(false);
        y_axis["showspikes"] = json!(false);
        Figure {
            title: self.title,
            caption: self.caption,
            height_px: MARGIN_PX + LANE_HEIGHT_PX * count,
            link: self.link,
            drawing: Drawing {
                traces,
                layout: json!({ "xaxis": x_axis, "yaxis": y_axis, "hovermode": "x", "showlegend": true, "dragmode": "zoom" }),
            },
        }
    }

    /// The states in the order in which they first occur.
    fn states(&self) -> Vec<(String, Tint)> {
        let mut states: Vec<(String, Tint)> = Vec::new();
        for stretch in self.lanes.iter().flat_map(|lane| &lane.stretches) {
            if !states
                .iter()
                .any(|(state, tint)| (state, *tint) == (&stretch.state, stretch.tint))
            {
                states.push((stretch.state.clone(), stretch.tint));
            }
        }
        states
    }

    /// All stretches of a state as one filled line with gaps.
    fn boxes(&self, state: &str, tint: Tint, level: impl Fn(usize) -> f64) -> Box<dyn Trace> {
        let (mut x, mut y) = (Vec::new(), Vec::new());
        for (index, lane) in self.lanes.iter().enumerate() {
            for stretch in (lane.stretches.iter()).filter(|s| s.state == state && s.tint == tint) {
                let (low, high) = (level(index) - HALF, level(index) + HALF);
                x.extend([
                    stretch.from,
                    stretch.to,
                    stretch.to,
                    stretch.from,
                    stretch.from,
                    f64::NAN,
                ]);
                y.extend([low, low, high, high, low, f64::NAN]);
            }
        }
        Scatter::new(x, y)
            .name(escape_plotly(state))
            .mode(Mode::Lines)
            .fill(Fill::ToSelf)
            .fill_color(tint.colour())
            .line(Line::new().width(0.5).color(tint.colour()))
            .hover_info(HoverInfo::Skip)
    }

    /// Invisible points along the axis that tell the pointer all states.
    fn readings(&self) -> Option<Box<dyn Trace>> {
        let all = || self.lanes.iter().flat_map(|lane| &lane.stretches);
        let from = all().map(|s| s.from).fold(f64::INFINITY, f64::min);
        let to = all().map(|s| s.to).fold(f64::NEG_INFINITY, f64::max);
        if all().next().is_none() || to <= from {
            return None;
        }
        let x: Vec<f64> = (0..READINGS)
            .map(|i| from + (to - from) * (i as f64 + 0.5) / READINGS as f64)
            .collect();
        let text: Vec<String> = x
            .iter()
            .map(|&at| escape_plotly(&self.reading(at)).replace('\n', "<br>"))
            .collect();
        let middle = 0.5 * (self.lanes.len() as f64 - 1.0);
        let x = crate::decimate::rounded(&x);
        Some(
            Scatter::new(x.clone(), vec![middle; x.len()])
                .text_array(text)
                .hover_info(HoverInfo::Text)
                .mode(Mode::Markers)
                .marker(Marker::new().opacity(0.0))
                .show_legend(false),
        )
    }

    /// The states at a place, a line each: "open: front left 1, front left 2".
    fn reading(&self, at: f64) -> String {
        let mut states: Vec<(&str, Vec<&str>)> = Vec::new();
        for lane in &self.lanes {
            for stretch in lane.stretches.iter().filter(|s| s.from <= at && at < s.to) {
                match states.iter_mut().find(|(state, _)| *state == stretch.state) {
                    Some((_, lanes)) => lanes.push(&lane.name),
                    None => states.push((&stretch.state, vec![&lane.name])),
                }
            }
        }
        let lines: Vec<String> = (states.iter())
            .map(|(state, lanes)| format!("{state}: {}", lanes.join(", ")))
            .collect();
        lines.join("\n")
    }
}

impl From<Lanes> for Figure {
    fn from(figure: Lanes) -> Self {
        figure.into_figure()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Lanes {
        let mut lanes = Lanes::new("Valves", Axis::new("Time", "s"));
        let open = Some(("open", Tint::Blue));
        lanes
            .lane("front left 1")
            .samples(&[0.0, 1.0, 2.0, 3.0], [open, open, None]);
        lanes
            .lane("front left 2")
            .samples(&[0.0, 1.0, 2.0, 3.0], [None, open, open]);
        lanes.lane("Mode").stretch(0.0, 3.0, "normal", Tint::Green);
        lanes
    }

    #[test]
    fn equal_samples_are_one_stretch() {
        let lanes = example();
        let times: Vec<(f64, f64)> = lanes
            .lanes
            .iter()
            .flat_map(|l| &l.stretches)
            .map(|s| (s.from, s.to))
            .collect();
        assert_eq!(times, [(0.0, 2.0), (1.0, 3.0), (0.0, 3.0)]);
        assert_eq!(lanes.reading(1.5), "open: front left 1, front left 2\nnormal: Mode");
        assert_eq!(lanes.reading(2.5), "open: front left 2\nnormal: Mode");
    }

    #[test]
    fn a_state_is_one_series_and_the_first_lane_is_the_upper_one() {
        let drawing = serde_json::to_value(example().into_figure().drawing).expect("plain data");
        let data = drawing["data"].as_array().expect("traces");
        assert_eq!(
            (data.len(), &data[0]["name"], &data[1]["name"]),
            (3, &json!("open"), &json!("normal"))
        );
        let top = |trace: usize| data[trace]["y"][2].as_f64().expect("a height");
        assert!(top(0) > top(1));
        assert_eq!(data[0]["x"][5], serde_json::Value::Null, "a gap between the stretches");
    }
}
