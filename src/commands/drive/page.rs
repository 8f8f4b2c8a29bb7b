//! `report.html` of a drive: the verdict of the manoeuvre first, then the plan, the response, the body, wheels and suspension. The
//! colour of a line is the drive (its model or its suspension), its panel the quantity or the corner.

use oleo_hil::drive::{Driven, Plan, column, open_valves};
use oleo_hil::page::{Path, map, went};
use oleo_interface::{Axle, Corner};
use oleo_plant_sim::course::{Ending, Manoeuvre, Sample};
use oleo_report::{Axis, Curves, Page, Style, Table, Verdict, significant};

use crate::results::command_line;

/// What a panel shows of a sample.
type Signal<'a> = &'a dyn Fn(&Sample) -> f64;

/// Quantity, unit and value of one panel.
type Panel<'a> = (&'a str, &'a str, Signal<'a>);

/// The page of one or several drives.
pub fn page(plan: &Plan, model: &str, drives: &[Driven], table: &Table, comparison: Option<&Table>) -> Page {
    let mut page = Page::new(&format!("Drive: {}", plan.title), &command_line());
    page.fact("Vehicle", plan.vehicle_name())
        .fact("Model", model)
        .fact("Suspension", &settings(drives))
        .fact("Driver", plan.course.driver.key())
        .fact("Road", &plan.road_name)
        .fact("Speed", &speed(plan));
    let (verdict, sentence) = verdict(plan, drives);
    page.verdict(verdict, &sentence).outcome(table.clone());
    if let Some(comparison) = comparison {
        page.section("Ride model against handling model")
            .table(comparison.clone());
    }
    if !matches!(plan.course.manoeuvre, Manoeuvre::Straight { .. }) {
        course(&mut page, plan, drives);
    }
    page.section("Body").figure(over_time(
        "Motion of the body",
        drives,
        &[
            ("Heave", "mm", &|s| 1e3 * s.heave_m),
            ("Roll", "degrees", &|s| s.roll_rad.to_degrees()),
            ("Pitch", "degrees", &|s| s.pitch_rad.to_degrees()),
            ("Vertical", "m/s2", &|s| s.vertical_acceleration_m_s2),
            ("Front axle heave", "mm", &|s| 1e3 * s.front_axle_heave_m),
        ],
    ));
    page.section("Wheels and suspension");
    let corners = |unit: &str, of: &dyn Fn(&Sample, Corner) -> f64, title: &str| {
        let signals = Corner::ALL.map(|corner| move |s: &Sample| of(s, corner));
        let names = Corner::ALL.map(|corner| corner.name().replace('-', " "));
        let panels: Vec<Panel> = (names.iter().zip(&signals))
            .map(|(name, signal)| (name.as_str(), unit, signal as Signal))
            .collect();
        over_time(title, drives, &panels)
    };
    page.figure(corners("kN", &|s, corner| 1e-3 * s.wheel_load_n[corner], "Wheel loads"))
        .figure(corners(
            "mm",
            &|s, corner| 1e3 * s.strut_displacement_m[corner],
            "Displacements, compression positive",
        ))
        .figure(over_time(
            "Open valves",
            drives,
            &[("Open", "of 12", &|s| {
                open_valves(s, Axle::Front) + open_valves(s, Axle::Rear)
            })],
        ));
    page
}

/// The suspensions, each once.
pub fn settings(drives: &[Driven]) -> String {
    let mut names: Vec<&str> = drives.iter().map(|driven| driven.setting.name()).collect();
    names.dedup();
    names.join(", ")
}

/// Speed of the manoeuvre in words: that at the start, and in a circle that at the end too.
fn speed(plan: &Plan) -> String {
    let km_h = |m_s: f64| significant(3.6 * m_s, 3);
    match plan.course.manoeuvre {
        Manoeuvre::ConstantRadius { from_m_s, to_m_s, .. } => format!("{} to {} km/h", km_h(from_m_s), km_h(to_m_s)),
        other => format!("{} km/h", km_h(other.initial_speed_m_s())),
    }
}

/// What happened in each run, and whether that is good: a vehicle that hits a cone or leaves its course has failed the manoeuvre.
pub fn verdict(plan: &Plan, drives: &[Driven]) -> (Verdict, String) {
    let failed = (drives.iter()).any(|Driven { run, .. }| {
        run.ending != Ending::Completed || run.cone_margin_m.is_some_and(|margin_m| margin_m < 0.0)
    });
    let one_setting = drives.windows(2).all(|pair| pair[0].setting == pair[1].setting);
    let sentences: Vec<String> = (drives.iter())
        .map(|Driven { name, setting, run }| {
            let roll = significant(run.max_roll_rad.to_degrees(), 2);
            let vehicle = match drives {
                [_] => "the vehicle".to_owned(),
                _ if one_setting => format!("the {name}"),
                _ => format!("With {} the vehicle", setting.words()),
            };
            let lifted = if run.wheel_lift_s > 0.0 {
                format!(
                    ", and a wheel was off the ground for {} s",
                    significant(run.wheel_lift_s, 2)
                )
            } else {
                String::new()
            };
            format!(
                "{vehicle} {}; its largest roll was {roll} degrees{lifted}.",
                went(Some(run.ending), run.cone_margin_m)
            )
        })
        .collect();
    let (stop, join) = match one_setting {
        true => (":", " With the same road and setting, "),
        false => (".", " "),
    };
    let text = format!("{} at {}{stop} {}", plan.title, speed(plan), sentences.join(join));
    (if failed { Verdict::Fail } else { Verdict::Pass }, text)
}

/// Plan, steering and response.
fn course(page: &mut Page, plan: &Plan, drives: &[Driven]) {
    let path = |Driven { name, run, .. }: &Driven| Path {
        name: (*name).to_owned(),
        ahead_m: column(run, |s| s.station_m),
        left_m: column(run, |s| s.lateral_m),
        yaw_rad: column(run, |s| s.yaw_rad),
    };
    let paths: Vec<Path> = drives.iter().map(path).collect();
    page.section("Course")
        .figure(map(&plan.track, &paths, plan.outline_m()));
    if matches!(plan.course.manoeuvre, Manoeuvre::ConstantRadius { .. }) {
        page.figure(over_lateral(drives));
    }
    page.figure(over_time(
        "Steering and response",
        drives,
        &[
            ("Steer angle", "degrees", &|s| s.steer_rad.to_degrees()),
            ("Lateral", "m/s2", &|s| s.lateral_acceleration_m_s2),
            ("Fore-aft", "m/s2", &|s| s.longitudinal_acceleration_m_s2),
            ("Yaw rate", "degrees/s", &|s| s.yaw_rate_rad_s.to_degrees()),
            ("Speed", "km/h", &|s| 3.6 * s.speed_m_s),
        ],
    ));
}

/// What ISO 4138 draws of a steady circle.
fn over_lateral(drives: &[Driven]) -> Curves {
    let mut figure = Curves::new(
        "Roll and steer over lateral acceleration",
        Axis::new("Lateral acceleration", "m/s2"),
    );
    figure.caption(
        "The slope of the upper line is the roll gradient, that of the lower one the understeer gradient. The table has both from 0.5 to \
         3 m/s2. The speed rises slowly, so that each point is nearly steady.",
    );
    let panels: [Panel; 2] = [
        ("Roll", "degrees", &|s| s.roll_rad.to_degrees()),
        ("Steer angle", "degrees", &|s| s.steer_rad.to_degrees()),
    ];
    figure.height(560);
    for (quantity, unit, of) in panels {
        figure.panel(Axis::new(quantity, unit));
        for Driven { name, run, .. } in drives {
            let x = column(run, |s| s.lateral_acceleration_m_s2);
            figure.series(Style::Line, name, &x, &column(run, of));
        }
    }
    figure
}

/// Panels over time, with a line for each drive.
fn over_time(title: &str, drives: &[Driven], panels: &[Panel]) -> Curves {
    let mut figure = Curves::new(title, Axis::new("Time", "s"));
    figure.link("time");
    for (quantity, unit, of) in panels {
        figure.panel(Axis::new(quantity, unit));
        for Driven { name, run, .. } in drives {
            figure.line(name, &column(run, |s| s.time_s), &column(run, of));
        }
    }
    figure
}
