//! Draws a specimen as SVG with the places of the misfit in colour.

use std::fmt::Write;

use crate::vocabulary::{Column, Place, Site};

/// A drawing in progress. Lengths are in the drawing's own units, about a pixel each.
pub struct Drawing<'p> {
    width: u32,
    height: u32,
    found: &'p [&'p Place],
    body: String,
}

impl<'p> Drawing<'p> {
    /// An empty drawing of a size; `found` are the places to mark.
    #[must_use]
    pub const fn new(width: u32, height: u32, found: &'p [&'p Place]) -> Self {
        Self {
            width,
            height,
            found,
            body: String::new(),
        }
    }

    /// True if something was found at one of these sites.
    #[must_use]
    pub fn found_at(&self, sites: &[Site]) -> bool {
        self.found.iter().any(|place| sites.contains(&place.site))
    }

    /// A line through points, written as SVG writes them: `x,y x,y ...`.
    pub fn line(&mut self, points: &str, found: bool) {
        let class = if found { "line found" } else { "line" };
        let _ = write!(self.body, "<polyline class=\"{class}\" points=\"{points}\"/>");
    }

    /// A box at (x, y) of a width and height, with text in it; `|` begins a new line.
    pub fn block(&mut self, at: (u32, u32, u32, u32), text: &str, found: bool) {
        let class = if found { "box found" } else { "box" };
        let (x, y, w, h) = at;
        let _ = write!(
            self.body,
            "<rect class=\"{class}\" x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" rx=\"5\"/>"
        );
        let lines: Vec<&str> = text.split('|').collect();
        let first = y + h / 2 + 5 - 8 * (lines.len() as u32 - 1);
        for (line, k) in lines.iter().zip(0..) {
            self.text((x + w / 2, first + 16 * k), line, found);
        }
    }

    /// A box that is a site: marked where something was found there.
    pub fn site(&mut self, at: (u32, u32, u32, u32), text: &str, site: Site) {
        self.part(at, text, &[site]);
    }

    /// A box that is the first of several sites, and is marked where something was found at any of them. It selects what the page
    /// says about the first.
    pub fn part(&mut self, at: (u32, u32, u32, u32), text: &str, sites: &[Site]) {
        let found = self.found_at(sites);
        let Some(site) = sites.first() else { return };
        let _ = write!(self.body, "<g data-topic=\"{site}\">");
        self.block(at, text, found);
        self.body += "</g>";
    }

    /// A measuring point: its symbol in a small frame around (x, y).
    pub fn sensor(&mut self, at: (u32, u32), text: &str, column: Column) {
        self.site((at.0 - 18, at.1 - 11, 36, 22), text, Site::Sensor(column));
    }

    fn text(&mut self, at: (u32, u32), text: &str, found: bool) {
        let class = if found { " class=\"found\"" } else { "" };
        let _ = write!(
            self.body,
            "<text{class} x=\"{}\" y=\"{}\" text-anchor=\"middle\">{text}</text>",
            at.0, at.1
        );
    }

    /// The drawing as SVG.
    #[must_use]
    pub fn svg(self) -> String {
        format!(
            "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"the specimen, found places marked\">{}</svg>",
            self.width, self.height, self.body
        )
    }
}
