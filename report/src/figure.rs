//! What the page asks of any kind of figure: a title, a height, and the traces and layout that plotly.js draws.
//! Colours of text and grid are left to the page, which knows whether it is light, dark or on paper.

use plotly::Trace;
use serde::Serialize;
use serde_json::Value;

/// Eight colours that stay apart for colour-blind readers and on light and dark grounds (after Okabe and Ito, "Color
/// Universal Design", with black and yellow replaced).
pub(crate) const COLOURS: [&str; 8] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#8c6bb1", "#7f7f7f",
];

/// One figure of a page.
#[derive(Clone)]
pub struct Figure {
    pub(crate) title: String,
    pub(crate) caption: String,
    pub(crate) height_px: usize,
    /// Figures of a page with the same name zoom their horizontal axes together.
    pub(crate) link: Option<String>,
    pub(crate) drawing: Drawing,
}

/// The document plotly.js takes, less its configuration.
#[derive(Clone, Serialize)]
pub(crate) struct Drawing {
    #[serde(rename = "data")]
    pub(crate) traces: Vec<Box<dyn Trace>>,
    pub(crate) layout: Value,
}

/// Colour of the series with this index; the palette repeats.
pub(crate) fn colour(index: usize) -> &'static str {
    COLOURS[index % COLOURS.len()]
}
