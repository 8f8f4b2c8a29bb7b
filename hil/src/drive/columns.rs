//! The columns of the CSV files of a drive, and what its figures take of a sample.

use oleo_controller::ValveCommand;
use oleo_interface::{Axle, Corner, StrutValves, Valve};
use oleo_plant_sim::course::{Run, Sample, Signals};

use super::driven::Driven;
use crate::telemetry::Series;

/// What a figure or column takes of a sample.
pub type Signal = fn(&Sample) -> f64;

/// Every column of the CSV file of a run.
pub const COLUMNS: [(&str, Signal); 36] = [
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
pub fn open_valves(sample: &Sample, axle: Axle) -> f64 {
    let open = |valves: &StrutValves<bool>| valves.iter().filter(|(_, open)| **open).count();
    sample.valves.of_axle(axle).map(open).iter().sum::<usize>() as f64
}

/// The runs of a request for viewers: the columns of their CSV files, and the signal of each valve.
pub fn series(drives: &[Driven]) -> Vec<Series> {
    let of_run = |driven: &Driven| {
        let run = &driven.run;
        let mut columns: Vec<(String, Vec<f64>)> = (COLUMNS.iter())
            .map(|(name, of)| ((*name).to_owned(), column(run, *of)))
            .collect();
        for corner in Corner::ALL {
            for (number, valve) in (1..).zip(Valve::ALL) {
                let signal = column(run, |sample| f64::from(u8::from(sample.valves[corner][valve])));
                columns.push((format!("valve{number}_{}", corner.key()), signal));
            }
        }
        Series {
            run: (drives.len() > 1).then(|| driven.name.replace(' ', "-")),
            time_s: column(run, |sample| sample.time_s),
            columns,
        }
    };
    drives.iter().map(of_run).collect()
}

/// One value for each sample of a run.
pub fn column(run: &Run, of: impl Fn(&Sample) -> f64) -> Vec<f64> {
    run.history.iter().map(of).collect()
}
