//! A drawing that moves: parts of an SVG follow a table over time, at the place of the pointer in the figures that share its
//! time axis, or of its own slider.

use serde_json::{Map, Value, json};

use crate::table::escape;

/// Most instants of a scene: more cannot be told apart on a slider as wide as a page.
const INSTANTS: usize = 800;

/// An SVG whose elements with `data-part="NAME"` move, and whose elements with `data-lamp="NAME"` have the class `on` or not.
#[derive(Clone, Debug)]
pub struct Scene {
    title: String,
    svg: String,
    caption: String,
    link: String,
    unit: String,
    /// Indices of the samples that are shown.
    shown: Vec<usize>,
    at: Vec<f64>,
    begin: f64,
    parts: Map<String, Value>,
    lamps: Map<String, Value>,
}

impl Scene {
    /// A scene with as many samples as `at` has; `link` names the figures whose pointer it follows, `unit` is that of `at`.
    pub fn new(title: &str, svg: &str, link: &str, at: &[f64], unit: &str) -> Self {
        let count = at.len().min(INSTANTS);
        let shown: Vec<usize> = (0..count)
            .map(|i| if count > 1 { i * (at.len() - 1) / (count - 1) } else { i })
            .collect();
        Self {
            title: title.into(),
            svg: svg.into(),
            caption: String::new(),
            link: link.into(),
            unit: unit.into(),
            at: shown.iter().map(|&i| hundredth(at[i])).collect(),
            shown,
            begin: 0.0,
            parts: Map::new(),
            lamps: Map::new(),
        }
    }

    /// Words under the drawing: what to see in it.
    pub fn caption(&mut self, caption: &str) -> &mut Self {
        self.caption = caption.into();
        self
    }

    /// The time that is shown first.
    pub fn begin(&mut self, at: f64) -> &mut Self {
        self.begin = at;
        self
    }

    /// Where a part is in each sample: right and down in the units of the drawing, and its angle in degrees, clockwise.
    pub fn part(&mut self, name: &str, place: impl Fn(usize) -> [f64; 3]) -> &mut Self {
        let places: Vec<[f64; 3]> = self.shown.iter().map(|&i| place(i).map(hundredth)).collect();
        self.parts.insert(name.into(), json!(places));
        self
    }

    /// Whether a lamp is on in each sample.
    pub fn lamp(&mut self, name: &str, on: impl Fn(usize) -> bool) -> &mut Self {
        let states: String = self.shown.iter().map(|&i| if on(i) { '1' } else { '0' }).collect();
        self.lamps.insert(name.into(), states.into());
        self
    }

    pub(crate) fn to_html(&self, number: usize) -> String {
        let last = self.at.len().saturating_sub(1);
        let first = self.at.partition_point(|at| *at < self.begin).min(last);
        let data = json!({ "at": self.at, "parts": self.parts, "lamps": self.lamps });
        format!(
            "<figure class=\"scene\" data-link=\"{link}\" id=\"scene-{number}\"><h3>{title}</h3>{svg}\
             <div class=\"player\"><button type=\"button\">Play</button>\
             <input type=\"range\" min=\"0\" max=\"{last}\" value=\"{first}\" aria-label=\"{title}: time\">\
             <output></output> {unit}</div><figcaption>{caption}</figcaption>\
             <script type=\"application/json\" id=\"scene-{number}-data\">{data}</script></figure>\n",
            link = escape(&self.link),
            title = escape(&self.title),
            svg = self.svg,
            unit = escape(&self.unit),
            caption = escape(&self.caption),
            data = data.to_string().replace("</", "<\\/"),
        )
    }
}

/// Two decimals: finer than a pixel, and a third of the size of the data.
fn hundredth(value: f64) -> f64 {
    if value.is_finite() {
        (100.0 * value).round() / 100.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_and_last_sample_are_shown_and_no_more_than_can_be_seen() {
        let at: Vec<f64> = (0..5_000).map(f64::from).collect();
        let mut scene = Scene::new("Vehicle", "<svg></svg>", "time", &at, "s");
        scene
            .part("body", |i| [i as f64, 0.126, 0.0])
            .lamp("open", |i| i > 2_500);
        assert_eq!((scene.at.len(), scene.at[0], scene.at[799]), (800, 0.0, 4_999.0));
        assert_eq!(scene.parts["body"][799], json!([4999.0, 0.13, 0.0]));
        let lamp = scene.lamps["open"].as_str().expect("states");
        assert!(lamp.starts_with('0') && lamp.ends_with('1') && lamp.len() == 800);
        assert!(scene.to_html(1).contains("max=\"799\" value=\"0\""));
        assert!(scene.begin(2_500.0).to_html(1).contains("max=\"799\" value=\"400\""));
    }

    #[test]
    fn a_scene_of_nothing_is_drawn() {
        assert!(
            Scene::new("Nothing", "<svg></svg>", "time", &[], "s")
                .to_html(1)
                .contains("max=\"0\"")
        );
    }
}
