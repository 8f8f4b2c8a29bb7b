//! The part of a page that only a run with a manoeuvre has, and the map of a course, which other pages share.

use oleo_plant_sim::course::Track;
use oleo_report::{Axis, Curves, Page, Style};

use super::time::Time;
use crate::record::CourseMotion;
use crate::run::Outcome;

/// A path from above: its name, and places ahead and to the left, m.
pub struct Path {
    /// Name in the picture.
    pub name: String,
    /// Ahead, m.
    pub ahead_m: Vec<f64>,
    /// To the left, m.
    pub left_m: Vec<f64>,
}

/// A course from above: paths, cones and the line of the driver.
pub fn map(track: &Track, paths: &[Path]) -> Curves {
    let mut figure = Curves::new("From above", Axis::new("Ahead", "m"));
    let panel = figure.panel(Axis::new("Left", "m"));
    for path in paths {
        panel.line(&path.name, &path.ahead_m, &path.left_m);
    }
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for gate in track.gates() {
        for i in 0..=4 {
            let station = gate.from_m + (gate.to_m - gate.from_m) * f64::from(i) / 4.0;
            x.extend([station, station]);
            y.extend([gate.right_m, gate.left_m]);
        }
    }
    if !x.is_empty() {
        panel.series(Style::Points, "cones", &x, &y);
        let last_m = track.end_m().unwrap_or(0.0);
        let stations: Vec<f64> = (0..=200).map(|i| last_m * f64::from(i) / 200.0).collect();
        let line: Vec<f64> = stations.iter().map(|x| track.lateral_m(*x)).collect();
        panel.series(Style::Dashed, "line wanted", &stations, &line);
    }
    figure
}

/// Adds path, steering and response, where there is a manoeuvre.
pub(super) fn section(page: &mut Page, outcome: &Outcome, time: &Time) {
    let samples = &outcome.plant.recording.samples;
    let Some(track) = &outcome.plant.track else { return };
    let column = |value: &dyn Fn(&CourseMotion) -> f64| -> Vec<f64> {
        let course = samples.iter().map(|sample| sample.motion.course.as_ref());
        course.map(|at| at.map_or(f64::NAN, value)).collect()
    };
    page.section("Manoeuvre").text(
        "Steer, lateral values and yaw are positive to the left. The steer angle is that of the steering wheel over the steering ratio. The path \
         deviation is positive where the body's centre of mass is right of the driver's line.",
    );
    page.figure(map(
        track,
        &[Path {
            name: "centre of mass".to_owned(),
            ahead_m: column(&|at| at.body.position_m[0]),
            left_m: column(&|at| at.body.position_m[1]),
        }],
    ));
    let mut curves = time.curves("Steering and response");
    curves.height(960);
    let mut panel = |quantity: &str, unit: &str, value: &dyn Fn(&CourseMotion) -> f64| {
        let values = column(value);
        if values.iter().any(|value| value.is_finite()) {
            curves.panel(Axis::new(quantity, unit)).line(quantity, &time.s, &values);
            time.mark(&mut curves);
        }
    };
    panel("Steer", "degrees", &|at| at.steer_rad.to_degrees());
    panel("Lateral", "m/s2", &|at| at.body.lateral_acceleration_m_s2);
    panel("Fore-aft", "m/s2", &|at| at.body.longitudinal_acceleration_m_s2);
    panel("Yaw rate", "degrees/s", &|at| at.body.rates_rad_s[2].to_degrees());
    panel("Speed", "km/h", &|at| 3.6 * at.body.speed_m_s);
    panel("Path deviation", "m", &|at| at.path_deviation_m.unwrap_or(f64::NAN));
    page.figure(curves);
}
