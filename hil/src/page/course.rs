//! The part of a page that only a run with a manoeuvre has, and the map of a course, which other pages share.

use oleo_plant_sim::course::{Ending, Track};
use oleo_report::{Axis, Curves, Page, Style, significant};

use super::time::Time;
use crate::record::CourseMotion;
use crate::run::Outcome;

/// A vehicle's way from above: its name, places ahead and to the left, m, and headings, rad, positive to the left.
pub struct Path {
    /// Name in the picture.
    pub name: String,
    /// Ahead, m.
    pub ahead_m: Vec<f64>,
    /// To the left, m.
    pub left_m: Vec<f64>,
    /// Heading, rad.
    pub yaw_rad: Vec<f64>,
}

/// Distance between two drawn outlines, m, and the most of them: on a circle they would cover each other.
const OUTLINE_EVERY_M: f64 = 8.0;
const MOST_OUTLINES: usize = 24;
/// Heights of the plan of a lane change, which is long, and of a circle.
const LANES_PX: usize = 330;
const CIRCLE_PX: usize = 620;

/// A course from above, to scale: paths, the outline of the vehicle at places along each (corners ahead and left of the centre of
/// mass, m), cones and the line of the driver.
pub fn map(track: &Track, paths: &[Path], outline_m: [[f64; 2]; 4]) -> Curves {
    let mut figure = Curves::new("From above, to scale", Axis::new("Ahead", "m"));
    figure.equal_scales();
    figure.height(if track.gates().is_empty() { CIRCLE_PX } else { LANES_PX });
    figure.caption(&format!(
        "The way of the body's centre of mass, and the outline of the body every {OUTLINE_EVERY_M} m from the start, {MOST_OUTLINES} at \
         most. Drag over a part to see it larger."
    ));
    let panel = figure.panel(Axis::new("Left", "m"));
    for path in paths {
        panel.line(&path.name, &path.ahead_m, &path.left_m);
    }
    for path in paths {
        let (x, y) = outlines(path, outline_m);
        panel.series(Style::Outline, &path.name, &x, &y);
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

/// The outline of the body at places along a path, as one line with gaps.
fn outlines(path: &Path, [nose_left, nose_right, tail_left, tail_right]: [[f64; 2]; 4]) -> (Vec<f64>, Vec<f64>) {
    let (mut x, mut y) = (Vec::new(), Vec::new());
    let mut last: Option<(f64, f64)> = None;
    for ((ahead_m, left_m), yaw_rad) in path.ahead_m.iter().zip(&path.left_m).zip(&path.yaw_rad) {
        let far = last.is_none_or(|(a, b)| {
            let (dx, dy) = (ahead_m - a, left_m - b);
            (dx * dx + dy * dy).sqrt() >= OUTLINE_EVERY_M
        });
        if x.len() >= 6 * MOST_OUTLINES {
            break;
        }
        if !far || !(ahead_m + left_m + yaw_rad).is_finite() {
            continue;
        }
        last = Some((*ahead_m, *left_m));
        let (sin, cos) = (libm::sin(*yaw_rad), libm::cos(*yaw_rad));
        for [along, across] in [nose_left, nose_right, tail_right, tail_left, nose_left] {
            x.push(ahead_m + cos * along - sin * across);
            y.push(left_m + sin * along + cos * across);
        }
        x.push(f64::NAN);
        y.push(f64::NAN);
    }
    (x, y)
}

/// How a manoeuvre ended, in words: a drive that hit a cone is not completed just so.
pub fn ending_in_words(ending: Option<Ending>, cone_margin_m: Option<f64>) -> String {
    match ending {
        None => "stopped".to_owned(),
        Some(Ending::Completed) if cone_margin_m.is_some_and(|margin_m| margin_m < 0.0) => {
            "completed, but a cone was hit".to_owned()
        }
        Some(Ending::Completed) => Ending::Completed.word().to_owned(),
        Some(ending) => {
            let (Ending::RolledOver(time_s) | Ending::Spun(time_s) | Ending::LostTrack(time_s)) = ending else {
                return ending.word().to_owned();
            };
            format!("{} at {} s", ending.word(), significant(time_s, 3))
        }
    }
}

/// How a manoeuvre went, as a clause behind its name.
pub fn went(ending: Option<Ending>, cone_margin_m: Option<f64>) -> String {
    match (ending, cone_margin_m) {
        (Some(Ending::Completed), Some(margin_m)) if margin_m < 0.0 => format!(
            "came through, but hit a cone; it went up to {} m beyond the cones",
            significant(-margin_m, 2)
        ),
        (Some(Ending::Completed), Some(margin_m)) => format!(
            "came through without touching a cone; the least room was {} m",
            significant(margin_m, 2)
        ),
        (Some(Ending::Completed), None) => "drove to the end".to_owned(),
        (Some(Ending::RolledOver(time_s)), _) => format!("rolled over after {} s", significant(time_s, 3)),
        (Some(Ending::Spun(time_s)), _) => format!("spun after {} s", significant(time_s, 3)),
        (Some(Ending::LostTrack(time_s)), _) => format!("lost the track after {} s", significant(time_s, 3)),
        (None, _) => "was stopped before the end".to_owned(),
    }
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
            yaw_rad: column(&|at| at.body.yaw_rad),
        }],
        outcome.plant.assembly.outline_m,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_that_hits_a_cone_is_not_simply_completed() {
        let completed = Some(Ending::Completed);
        assert_eq!(ending_in_words(completed, None), "completed");
        assert_eq!(ending_in_words(completed, Some(0.2)), "completed");
        assert_eq!(ending_in_words(completed, Some(-0.2)), "completed, but a cone was hit");
        assert_eq!(
            ending_in_words(Some(Ending::RolledOver(4.25)), Some(-1.0)),
            "rolled over at 4.25 s"
        );
        assert!(went(completed, Some(-0.25)).contains("hit a cone") && went(completed, Some(0.25)).contains("0.25 m"));
    }

    #[test]
    fn outlines_turn_with_the_heading_and_keep_their_distance() {
        let path = Path {
            name: "way".to_owned(),
            ahead_m: (0..=100).map(|i| 0.2 * f64::from(i)).collect(),
            left_m: vec![1.0; 101],
            yaw_rad: vec![std::f64::consts::FRAC_PI_2; 101],
        };
        let (x, y) = outlines(&path, [[2.0, 0.5], [2.0, -0.5], [-3.0, 0.5], [-3.0, -0.5]]);
        assert_eq!(x.iter().filter(|x| x.is_nan()).count(), 3, "at 0, 8 and 16 m");
        // Turned to the left by a right angle, the nose is left of the centre and the left side behind it.
        assert!(
            (x[0] + 0.5).abs() < 1e-12 && (y[0] - 3.0).abs() < 1e-12,
            "{} {}",
            x[0],
            y[0]
        );
    }
}
