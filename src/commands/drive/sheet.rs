//! Writes the results of a drive: tables, CSV files and the page.

use oleo_controller::ValveCommand;
use oleo_hil::page::Path;
use oleo_interface::{Axle, Corner, StrutValves};
use oleo_plant_sim::course::{Ending, Manoeuvre, Run, Sample, Signals};
use oleo_report::{Axis, Column, Curves, OutputDirectory, Page, Table, significant};
use serde_json::{Map, Value, json};

use super::arguments::Args;
use super::measures::{Measure, measures};
use super::plan::Plan;
use crate::failure::Failure;
use crate::results::command_line;

/// RMS of the difference over RMS of the first, at the same places of the road: the handling model's speed gives way on
/// a rough road, the ride model's is constant.
fn difference(a: &[Sample], b: &[Sample], of: fn(&Sample) -> f64) -> f64 {
    let (mut apart, mut size) = (0.0, 0.0);
    let mut from = 0;
    for sample in a {
        let station = sample.station_m;
        while from + 2 < b.len() && b[from + 1].station_m < station {
            from += 1;
        }
        let (Some(low), Some(high)) = (b.get(from), b.get(from + 1)) else {
            break;
        };
        if station > high.station_m || station < low.station_m {
            continue;
        }
        let share = (station - low.station_m) / (high.station_m - low.station_m);
        let (x, y) = (of(sample), of(low) + share * (of(high) - of(low)));
        apart += (x - y) * (x - y);
        size += x * x;
    }
    (apart / size).sqrt()
}

/// What a figure or column takes of a sample.
type Signal = fn(&Sample) -> f64;

/// Quantity, unit and the lines of one panel.
type Panel<'a> = (&'a str, &'a str, &'a [(&'a str, Signal)]);

const COMPARED: [(&str, &str, Signal); 5] = [
    ("heave", "body vertical displacement (figures 2, 6)", |s| s.heave_m),
    ("heave_acceleration", "body vertical acceleration (figure 3)", |s| {
        s.vertical_acceleration_m_s2
    }),
    ("front_axle", "front axle vertical displacement (figure 4)", |s| {
        s.front_axle_heave_m
    }),
    ("roll", "body roll angle (figures 5, 7)", |s| s.roll_rad),
    ("pitch", "body pitch angle", |s| s.pitch_rad),
];

const COLUMNS: [(&str, Signal); 36] = [
    ("time_s", |s| s.time_s),
    ("station_m", |s| s.station_m),
    ("lateral_m", |s| s.lateral_m),
    ("heave_m", |s| s.heave_m),
    ("yaw_rad", |s| s.yaw_rad),
    ("pitch_rad", |s| s.pitch_rad),
    ("roll_rad", |s| s.roll_rad),
    ("speed_m_s", |s| s.speed_m_s),
    ("side_slip_rad", |s| s.side_slip_rad),
    ("yaw_rate_rad_s", |s| s.yaw_rate_rad_s),
    ("longitudinal_acceleration_m_s2", |s| s.longitudinal_acceleration_m_s2),
    ("lateral_acceleration_m_s2", |s| s.lateral_acceleration_m_s2),
    ("heave_acceleration_m_s2", |s| s.vertical_acceleration_m_s2),
    ("steer_rad", |s| s.steer_rad),
    ("wheel_steer_rad", |s| s.wheel_steer_rad),
    ("driver_acceleration_m_s2", |s| s.seat.driver.vertical_m_s2),
    ("rear_left_acceleration_m_s2", |s| s.seat.passenger.vertical_m_s2),
    ("driver_lateral_acceleration_m_s2", |s| s.seat.driver.lateral_m_s2),
    ("rear_left_lateral_acceleration_m_s2", |s| s.seat.passenger.lateral_m_s2),
    ("front_axle_heave_m", |s| s.front_axle_heave_m),
    ("front_axle_roll_rad", |s| s.front_axle_roll_rad),
    ("wheel_load_front_left_N", |s| s.wheel_load_n[Corner::FrontLeft]),
    ("wheel_load_front_right_N", |s| s.wheel_load_n[Corner::FrontRight]),
    ("wheel_load_rear_left_N", |s| s.wheel_load_n[Corner::RearLeft]),
    ("wheel_load_rear_right_N", |s| s.wheel_load_n[Corner::RearRight]),
    ("displacement_front_left_m", |s| {
        s.strut_displacement_m[Corner::FrontLeft]
    }),
    ("displacement_front_right_m", |s| {
        s.strut_displacement_m[Corner::FrontRight]
    }),
    ("displacement_rear_left_m", |s| s.strut_displacement_m[Corner::RearLeft]),
    ("displacement_rear_right_m", |s| {
        s.strut_displacement_m[Corner::RearRight]
    }),
    ("force_front_left_N", |s| s.strut_force_n[Corner::FrontLeft]),
    ("force_front_right_N", |s| s.strut_force_n[Corner::FrontRight]),
    ("force_rear_left_N", |s| s.strut_force_n[Corner::RearLeft]),
    ("force_rear_right_N", |s| s.strut_force_n[Corner::RearRight]),
    ("valve_word", |s| f64::from(valve_word(&s.valves))),
    ("front_valves_open", |s| open_valves(s, Axle::Front)),
    ("rear_valves_open", |s| open_valves(s, Axle::Rear)),
];

/// The controller's valve word: bit `3 * corner + valve`, 1 open.
fn valve_word(signals: &Signals) -> u16 {
    ValveCommand::from_corners(*signals).word()
}

/// Open valves of an axle, 0 to 6.
fn open_valves(sample: &Sample, axle: Axle) -> f64 {
    let open = |valves: &StrutValves<bool>| valves.iter().filter(|(_, open)| **open).count();
    sample.valves.of_axle(axle).map(open).iter().sum::<usize>() as f64
}

fn column(run: &Run, of: fn(&Sample) -> f64) -> Vec<f64> {
    run.history.iter().map(of).collect()
}

/// Prints the table and writes the folder.
pub fn publish(
    plan: &Plan,
    args: &Args,
    runs: &[(&str, Run)],
    mut out: Option<OutputDirectory>,
) -> Result<(), Failure> {
    let mut columns = vec![Column::text("Measure")];
    columns.extend(runs.iter().map(|(name, _)| Column::number(name)));
    columns.push(Column::text("Unit"));
    let mut table = Table::new(columns);
    let mut summary = Map::new();
    let mut row = vec!["end of the run".to_owned()];
    row.extend(runs.iter().map(|(_, run)| ending(run.ending)));
    row.push(String::new());
    table.row(row);
    let all: Vec<Vec<Measure>> = runs
        .iter()
        .map(|(_, run)| measures(plan, run, args.score_from_s))
        .collect();
    let longest = all.iter().max_by_key(|list| list.len()).cloned().unwrap_or_default();
    for (key, words, _, unit) in longest {
        let value = |list: &Vec<Measure>| list.iter().find(|m| m.0 == key).map(|m| m.2);
        let mut row = vec![words.to_owned()];
        row.extend(
            all.iter()
                .map(|list| value(list).map_or("-".to_owned(), |v| significant(v, 4))),
        );
        row.push(unit.to_owned());
        table.row(row);
    }
    for ((name, run), list) in runs.iter().zip(&all) {
        let mut entry: Map<String, Value> = list.iter().map(|m| (m.0.to_owned(), json!(m.2))).collect();
        entry.insert("ending".into(), json!(run.ending.word()));
        entry.insert("duration_s".into(), json!(run.history.last().map_or(0.0, |s| s.time_s)));
        summary.insert(name.replace(' ', "_"), Value::Object(entry));
    }
    let mut comparison = None;
    if let [(_, one), (_, other)] = runs {
        let mut rows = Table::new([
            Column::text("Signal"),
            Column::number("RMS difference at the same place on the road / RMS of the ride model"),
        ]);
        for (key, words, of) in COMPARED {
            let ratio = difference(&one.history, &other.history, of);
            rows.row([words.to_owned(), format!("{:.1} %", 100.0 * ratio)]);
            summary.insert(format!("difference_{key}"), json!(ratio));
        }
        comparison = Some(rows);
    }
    if let Some(out) = &mut out {
        let page = page(plan, args, runs, &table, comparison.as_ref());
        for (name, run) in runs {
            let columns: Vec<(&str, Vec<f64>)> = COLUMNS.iter().map(|(name, of)| (*name, column(run, *of))).collect();
            let columns: Vec<(&str, &[f64])> = columns
                .iter()
                .map(|(name, values)| (*name, values.as_slice()))
                .collect();
            out.csv(&format!("{}.csv", name.replace(' ', "-")), &columns)?;
        }
        out.summary("summary.json", Some(args.seed), &summary)?;
        out.page(&page)?;
    }
    let text = format!(
        "{}: road {}, {}\n{table}{}",
        plan.title,
        plan.road_name,
        args.setting.name(),
        comparison.map_or(String::new(), |table| table.to_string())
    );
    args.results.publish(out, &text)
}

fn ending(ending: Ending) -> String {
    match ending {
        Ending::Completed => ending.word().to_owned(),
        Ending::RolledOver(time_s) | Ending::Spun(time_s) | Ending::LostTrack(time_s) => {
            format!("{} at {time_s:.2} s", ending.word())
        }
    }
}

fn page(plan: &Plan, args: &Args, runs: &[(&str, Run)], table: &Table, comparison: Option<&Table>) -> Page {
    let mut page = Page::new(&format!("Drive: {}", plan.title), &command_line());
    page.fact("Vehicle", &plan.vehicle.name)
        .fact("Suspension", args.setting.name())
        .fact("Driver", plan.course.driver.key())
        .fact("Road", &plan.road_name)
        .fact(
            "Speed",
            &format!("{:.1} km/h", 3.6 * plan.course.manoeuvre.initial_speed_m_s()),
        )
        .outcome(table.clone());
    if let Some(comparison) = comparison {
        page.section("Ride model against handling model")
            .table(comparison.clone());
    }
    let panels = |title: &str, panels: &[Panel]| {
        let mut figure = Curves::new(title, Axis::new("Time", "s"));
        figure.link("time");
        for (quantity, unit, series) in panels {
            let panel = figure.panel(Axis::new(quantity, unit));
            for (name, run) in runs {
                for (label, of) in *series {
                    let label = if runs.len() > 1 {
                        format!("{name} {label}")
                    } else {
                        (*label).to_owned()
                    };
                    panel.line(label.trim(), &column(run, |s| s.time_s), &column(run, *of));
                }
            }
        }
        figure
    };
    page.section("Body").figure(panels(
        "Motion of the body",
        &[
            ("Heave", "m", &[("heave", |s| s.heave_m)]),
            ("Roll", "degrees", &[("roll", |s| s.roll_rad.to_degrees())]),
            ("Pitch", "degrees", &[("pitch", |s| s.pitch_rad.to_degrees())]),
            (
                "Vertical acceleration",
                "m/s2",
                &[("at the centre of mass", |s| s.vertical_acceleration_m_s2)],
            ),
            ("Front axle heave", "m", &[("front axle", |s| s.front_axle_heave_m)]),
        ],
    ));
    if !matches!(plan.course.manoeuvre, Manoeuvre::Straight { .. }) {
        page.section("Course").figure(map(plan, runs)).figure(panels(
            "Steering and response",
            &[
                ("Steer angle", "degrees", &[("steer", |s| s.steer_rad.to_degrees())]),
                (
                    "Acceleration",
                    "m/s2",
                    &[
                        ("lateral", |s| s.lateral_acceleration_m_s2),
                        ("fore-aft", |s| s.longitudinal_acceleration_m_s2),
                    ],
                ),
                (
                    "Yaw rate",
                    "degrees/s",
                    &[("yaw rate", |s| s.yaw_rate_rad_s.to_degrees())],
                ),
                ("Speed", "km/h", &[("speed", |s| 3.6 * s.speed_m_s)]),
            ],
        ));
    }
    page.section("Wheels and suspension").figure(panels(
        "Wheel loads, displacements (compression positive) and valves",
        &[
            (
                "Wheel load",
                "N",
                &[
                    ("front left", |s| s.wheel_load_n[Corner::FrontLeft]),
                    ("front right", |s| s.wheel_load_n[Corner::FrontRight]),
                    ("rear left", |s| s.wheel_load_n[Corner::RearLeft]),
                    ("rear right", |s| s.wheel_load_n[Corner::RearRight]),
                ],
            ),
            (
                "Displacement",
                "m",
                &[
                    ("front left", |s| s.strut_displacement_m[Corner::FrontLeft]),
                    ("front right", |s| s.strut_displacement_m[Corner::FrontRight]),
                    ("rear left", |s| s.strut_displacement_m[Corner::RearLeft]),
                    ("rear right", |s| s.strut_displacement_m[Corner::RearRight]),
                ],
            ),
            (
                "Open valves",
                "of 12",
                &[("open", |s| open_valves(s, Axle::Front) + open_valves(s, Axle::Rear))],
            ),
        ],
    ));
    page
}

/// The course from above with its cones.
fn map(plan: &Plan, runs: &[(&str, Run)]) -> Curves {
    let path = |(name, run): &(&str, Run)| Path {
        name: format!("{name}, centre of mass"),
        ahead_m: column(run, |s| s.station_m),
        left_m: column(run, |s| s.lateral_m),
    };
    oleo_hil::page::map(&plan.track, &runs.iter().map(path).collect::<Vec<_>>())
}
