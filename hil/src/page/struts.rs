//! The section on the struts: one at a time, selected by its corner.

use oleo_interface::{Corner, PressurePoint, Valve};
use oleo_report::{Axis, Curves, Page, Style};

use super::time::Time;
use crate::run::Outcome;

/// The pressure differences that drive oil through the dampers and valve 3: the first path leaves the main chamber (p1) for the
/// first accumulator (p2), the second for the place before valve 3 (p3).
const DIFFERENCES: [(&str, PressurePoint, PressurePoint); 3] = [
    ("p1 - p2 (damper 1)", PressurePoint::P1, PressurePoint::P2),
    ("p1 - p3 (damper 2)", PressurePoint::P1, PressurePoint::P3),
    ("p3 - p4 (valve 3)", PressurePoint::P3, PressurePoint::P4),
];

pub(super) fn section(page: &mut Page, outcome: &Outcome, time: &Time) {
    page.section("Struts").text(
        "Compression is positive, and pressures are gauge pressures. Valves 1 and 2 bypass the dampers; when they are open, the \
         damping is low. Valve 3 connects the 0.4 l accumulator; when it is open, the spring is soft. Both dampers lie between the \
         main chamber (p1) and what is behind them, so the pressure differences show how hard they work.",
    );
    page.choice(
        "Corner",
        Corner::ALL.map(|corner| (corner.name().replace('-', " "), strut(outcome, time, corner).into())),
    );
}

fn strut(outcome: &Outcome, time: &Time, corner: Corner) -> Curves {
    let samples = &outcome.plant.recording.samples;
    let column = |value: &dyn Fn(usize) -> f64| (0..samples.len()).map(value).collect::<Vec<f64>>();
    let mut curves = time.curves(&format!("Strut {}", corner.name().replace('-', " ")));
    curves.height(860);
    curves.panel(Axis::new("Displacement", "mm"));
    curves.line(
        "displacement",
        &time.s,
        &column(&|i| 1e3 * samples[i].displacement_m[corner]),
    );
    time.mark(&mut curves);
    let pressure = |i: usize, point: PressurePoint| 1e-6 * samples[i].strut[corner].pressure_pa[point.index()];
    curves.panel(Axis::new("Pressure", "MPa"));
    for point in PressurePoint::ALL {
        curves.line(point.key(), &time.s, &column(&|i| pressure(i, point)));
    }
    curves.panel(Axis::new("Difference", "MPa"));
    for (name, from, to) in DIFFERENCES {
        curves.line(name, &time.s, &column(&|i| pressure(i, from) - pressure(i, to)));
    }
    curves.panel(Axis::new("Force", "kN"));
    curves.line("force", &time.s, &column(&|i| 1e-3 * samples[i].strut[corner].force_n));
    // The three signals lie above each other. A signal is at its label when closed, and above it when open.
    curves.panel(
        Axis::new("Open", "")
            .ticks([(0.0, "valve 1"), (1.5, "valve 2"), (3.0, "valve 3")])
            .range(-0.3, 4.3),
    );
    for valve in Valve::ALL {
        let label = 1.5 * valve.index() as f64;
        let open = column(&|i| label + f64::from(u8::from(samples[i].energised.is_open(corner, valve))));
        curves.series(Style::Step, &format!("valve {}", valve.number()), &time.s, &open);
    }
    curves
}
