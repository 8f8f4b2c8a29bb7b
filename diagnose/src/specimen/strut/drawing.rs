//! The drawing of the strut.

use oleo_interface::Valve;

use crate::specimen::drawing::Drawing;
use crate::vocabulary::{Branch, Column, Place, Site};

/// Load path on the left, oil to the right; SVG.
#[must_use]
pub fn drawing(found: &[&Place]) -> String {
    let mut d = Drawing::new(900, 300, found);
    d.line("70,150 250,150", false);
    d.block((15, 120, 55, 60), "actu-|ator", false);
    d.site((95, 125, 62, 50), "mount", Site::Mount);
    d.site((180, 115, 46, 70), "main|seal", Site::MainSeal);
    d.site((250, 85, 115, 130), "main chamber|(oil)", Site::MainChamber);
    d.site((250, 232, 115, 30), "end stops", Site::EndStop);
    for (branch, bypass, y) in [
        (Branch::First, Valve::Bypass1, 70),
        (Branch::Second, Valve::Bypass2, 195),
    ] {
        let n = branch.number();
        let path = d.found_at(&[Site::Path(branch), Site::Paths]);
        d.line(&format!("365,{0} 410,{0} 410,{1} 470,{1}", y + 30, y), path);
        d.line(&format!("410,{0} 410,{1} 470,{1}", y + 30, y + 55), path);
        d.part(
            (470, y - 17, 90, 34),
            &format!("damper {n}"),
            &[Site::Path(branch), Site::Paths],
        );
        d.part(
            (470, y + 38, 90, 34),
            &format!("valve {n}"),
            &[Site::Valve(bypass), Site::Valves],
        );
        d.line(&format!("560,{0} 610,{0} 610,{1} 560,{1}", y, y + 55), path);
        d.line(&format!("610,{0} 760,{0}", y + 30), path);
    }
    d.part(
        (660, 205, 70, 40),
        "valve 3",
        &[Site::Valve(Valve::Spring), Site::Valves],
    );
    for (branch, y) in [(Branch::First, 65), (Branch::Second, 190)] {
        d.part(
            (760, y, 125, 70),
            &format!("accumulator {}|(gas)", branch.number()),
            &[Site::Accumulator(branch), Site::Accumulators],
        );
    }
    for (at, text, column) in [
        ((82, 90), "x", Column::DISPLACEMENT),
        ((203, 90), "F", Column::FORCE),
        ((307, 60), "p1", Column::known("p1_Pa")),
        ((700, 75), "p2", Column::known("p2_Pa")),
        ((635, 180), "p3", Column::known("p3_Pa")),
        ((744, 180), "p4", Column::known("p4_Pa")),
    ] {
        d.sensor(at, text, column);
    }
    d.svg()
}

#[cfg(test)]
mod tests {
    use oleo_plant_sim::strut::{Effects, StrutModel};

    use super::*;
    use crate::excitation;

    #[test]
    fn only_what_was_found_is_marked() {
        assert!(!drawing(&[]).contains("found\""));
        let drawn = |place: &str| drawing(&[&place.parse().expect("a place")]);
        assert_eq!(drawn("accumulator-2").matches("box found").count(), 1);
        let (mut model, excitation) = (StrutModel::defender110(8000.0), excitation::Strut::of_everything());
        model.effects = Effects::default();
        let all = super::super::candidates(&model, &excitation, super::super::Layout::RIG);
        assert!(all.len() > 60);
        for place in all.iter().map(|c| c.place.to_string()) {
            let place = place.as_str();
            assert!(drawn(place).contains("found\""), "{place}");
        }
    }
}
