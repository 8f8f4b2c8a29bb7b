//! The specimen as a drawing, with the places found in colour.

use std::fmt::Write;

use oleo_interface::Valve;

use crate::vocabulary::{Branch, Column, Place, Site};

/// The drawing of a kind of specimen with the marked places; `None` for a kind without one.
#[must_use]
pub fn svg(kind: &str, places: &[&Place]) -> Option<String> {
    let marked = |sites: &[Site]| places.iter().any(|place| sites.contains(&place.site));
    let mut drawing = Drawing::default();
    match kind {
        "two-stage hydropneumatic strut" => strut(&mut drawing, &marked),
        "gas spring" => gas_spring(&mut drawing, &marked),
        "cylinder" => cylinder(&mut drawing, &marked),
        _ => return None,
    }
    Some(format!(
        "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"the specimen, found places marked\">{}</svg>",
        drawing.width, drawing.height, drawing.body
    ))
}

#[derive(Default)]
struct Drawing {
    width: u32,
    height: u32,
    body: String,
}

impl Drawing {
    fn size(&mut self, width: u32, height: u32) {
        (self.width, self.height) = (width, height);
    }

    fn line(&mut self, points: &str, found: bool) {
        let class = if found { "line found" } else { "line" };
        let _ = write!(self.body, "<polyline class=\"{class}\" points=\"{points}\"/>");
    }

    fn block(&mut self, at: (u32, u32, u32, u32), text: &str, found: bool) {
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

    fn text(&mut self, at: (u32, u32), text: &str, found: bool) {
        let class = if found { " class=\"found\"" } else { "" };
        let _ = write!(
            self.body,
            "<text{class} x=\"{}\" y=\"{}\" text-anchor=\"middle\">{text}</text>",
            at.0, at.1
        );
    }

    /// A measuring point: its name in a small frame.
    fn sensor(&mut self, at: (u32, u32), text: &str, found: bool) {
        self.block((at.0 - 18, at.1 - 11, 36, 22), text, found);
    }
}

fn strut(d: &mut Drawing, marked: &dyn Fn(&[Site]) -> bool) {
    d.size(900, 300);
    let path = |branch: Branch| marked(&[Site::Path(branch), Site::Paths]);
    let timing = marked(&[Site::Valves]);
    // Load path on the left, oil to the right.
    d.line("70,150 250,150", false);
    d.block((15, 120, 55, 60), "actu-|ator", false);
    d.block((95, 125, 62, 50), "mount", marked(&[Site::Mount]));
    d.block((180, 115, 46, 70), "main|seal", marked(&[Site::MainSeal]));
    d.block((250, 85, 115, 130), "main chamber|(oil)", marked(&[Site::MainChamber]));
    d.block((250, 232, 115, 30), "end stops", marked(&[Site::EndStop]));
    for (branch, bypass, y) in [
        (Branch::First, Valve::Bypass1, 70),
        (Branch::Second, Valve::Bypass2, 195),
    ] {
        let (n, found) = (branch.number(), path(branch));
        d.line(&format!("365,{0} 410,{0} 410,{1} 470,{1}", y + 30, y), found);
        d.line(&format!("410,{0} 410,{1} 470,{1}", y + 30, y + 55), found);
        d.block((470, y - 17, 90, 34), &format!("damper {n}"), found);
        d.block(
            (470, y + 38, 90, 34),
            &format!("valve {n}"),
            timing || marked(&[Site::Valve(bypass)]),
        );
        d.line(&format!("560,{0} 610,{0} 610,{1} 560,{1}", y, y + 55), found);
    }
    d.line("610,100 760,100", path(Branch::First));
    d.line("610,225 760,225", path(Branch::Second));
    d.block(
        (660, 205, 70, 40),
        "valve 3",
        timing || marked(&[Site::Valve(Valve::Spring)]),
    );
    let gas = |branch: Branch| marked(&[Site::Accumulator(branch), Site::Accumulators]);
    d.block((760, 65, 125, 70), "accumulator 1|(gas)", gas(Branch::First));
    d.block((760, 190, 125, 70), "accumulator 2|(gas)", gas(Branch::Second));
    for (at, text, column) in [
        ((82, 90), "x", "displacement_m"),
        ((203, 90), "F", "force_N"),
        ((307, 60), "p1", "p1_Pa"),
        ((700, 75), "p2", "p2_Pa"),
        ((635, 180), "p3", "p3_Pa"),
        ((744, 180), "p4", "p4_Pa"),
    ] {
        d.sensor(at, text, marked(&[Site::Sensor(Column::known(column))]));
    }
}

fn gas_spring(d: &mut Drawing, marked: &dyn Fn(&[Site]) -> bool) {
    d.size(900, 150);
    d.block((60, 55, 90, 40), "rod", false);
    d.line("150,75 330,75", false);
    d.block((330, 30, 40, 90), "pis-|ton", false);
    d.block((370, 30, 300, 90), "gas chamber", marked(&[Site::Chamber]));
    d.sensor((240, 50), "x", marked(&[Site::Sensor(Column::known("displacement_m"))]));
    d.line("670,75 740,75", false);
    d.sensor((760, 75), "p", marked(&[Site::Sensor(Column::known("p_Pa"))]));
}

fn cylinder(d: &mut Drawing, marked: &dyn Fn(&[Site]) -> bool) {
    d.size(900, 150);
    d.block(
        (60, 55, 90, 40),
        "load cell",
        marked(&[Site::Sensor(Column::known("force_N"))]),
    );
    d.line("150,75 290,75", false);
    d.block((290, 40, 60, 70), "rod seal", marked(&[Site::MainSeal]));
    d.block((350, 30, 320, 90), "chambers under pressure", false);
    d.sensor((220, 50), "x", marked(&[Site::Sensor(Column::known("displacement_m"))]));
    d.sensor((220, 105), "F", marked(&[Site::Sensor(Column::known("force_N"))]));
    d.line("670,75 740,75", false);
    d.sensor((760, 75), "p", false);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_was_found_is_marked() {
        let kind = "two-stage hydropneumatic strut";
        assert!(!svg(kind, &[]).expect("a drawing").contains("found\""));
        let drawn = |place: &str| svg(kind, &[&place.parse().expect("a place")]).expect("a drawing");
        assert_eq!(drawn("accumulator-2").matches("box found").count(), 1);
        for place in [
            "main-chamber",
            "accumulator-1",
            "main-seal",
            "path-1",
            "path-2",
            "valve-1..3",
            "valve-3",
            "end-stop",
            "mount",
            "sensor:p3_Pa",
            "sensor:displacement_m",
        ] {
            assert!(drawn(place).contains("found\""), "{place}");
        }
    }
}
