//! The columns of `timeseries.csv`: one value a tick, names with units. A run with a manoeuvre has some more.

use oleo_interface::tick::TICK_S;
use oleo_interface::{Corner, PressurePoint};

use crate::metrics::Metrics;
use crate::record::CourseMotion;
use crate::run::Outcome;

/// A quantity of a steered vehicle.
type Quantity = fn(&CourseMotion) -> f64;

/// What only a vehicle on a course has. Lateral values, yaw and steer are positive to the left.
const COURSE: [(&str, Quantity); 11] = [
    ("lateral_m", |at| at.body.position_m[1]),
    ("yaw_rad", |at| at.body.yaw_rad),
    ("speed_m_s", |at| at.body.speed_m_s),
    ("side_slip_rad", |at| at.body.side_slip_rad),
    ("roll_rate_rad_s", |at| at.body.rates_rad_s[0]),
    ("yaw_rate_rad_s", |at| at.body.rates_rad_s[2]),
    ("longitudinal_acceleration_m_s2", |at| {
        at.body.longitudinal_acceleration_m_s2
    }),
    ("lateral_acceleration_m_s2", |at| at.body.lateral_acceleration_m_s2),
    ("steer_rad", |at| at.steer_rad),
    ("path_deviation_m", |at| at.path_deviation_m.unwrap_or(f64::NAN)),
    ("cone_margin_m", |at| at.cone_margin_m.unwrap_or(f64::NAN)),
];

/// The columns of words: mode and first cause as the controller's last status message says them, empty before the first.
pub fn words(metrics: &Metrics) -> [(&'static str, Vec<&'static str>); 2] {
    let account = metrics.account.iter();
    [
        (
            "mode",
            account
                .clone()
                .map(|said| said.map_or("", |(mode, _)| mode.name()))
                .collect(),
        ),
        (
            "fault",
            account.map(|said| said.map_or("", |(_, fault)| fault.name())).collect(),
        ),
    ]
}

/// Name and values of each column of `timeseries.csv`, a value for each tick.
pub fn columns(outcome: &Outcome, metrics: &Metrics) -> Vec<(String, Vec<f64>)> {
    let samples = &outcome.plant.recording.samples;
    let steps = outcome.plant.recording.seat_acceleration_m_s2.len() / samples.len().max(1);
    let mut columns: Vec<(String, Vec<f64>)> = Vec::with_capacity(64);
    let mut column = |name: &str, value: &dyn Fn(usize) -> f64| {
        columns.push((name.to_owned(), (0..samples.len()).map(value).collect()));
    };
    column("time_s", &|i| i as f64 * TICK_S);
    column("station_m", &|i| samples[i].motion.station_m);
    for corner in Corner::ALL {
        let name = corner.key();
        column(&format!("road_{name}_m"), &|i| {
            samples[i].motion.wheel[corner].road_height_m
        });
    }
    column("heave_m", &|i| samples[i].motion.body.heave_m);
    column("roll_rad", &|i| samples[i].motion.body.roll_rad);
    column("pitch_rad", &|i| samples[i].motion.body.pitch_rad);
    column("heave_acceleration_m_s2", &|i| {
        samples[i].motion.body.heave_acceleration_m_s2
    });
    column("roll_acceleration_rad_s2", &|i| {
        samples[i].motion.body.roll_acceleration_rad_s2
    });
    column("pitch_acceleration_rad_s2", &|i| {
        samples[i].motion.body.pitch_acceleration_rad_s2
    });
    let felt = |i: usize, seat: usize| {
        // At the beginning of a tick the acceleration is that of the last step before it.
        let index = (i * steps).checked_sub(1);
        index.map_or(0.0, |at| outcome.plant.recording.seat_acceleration_m_s2[at][seat])
    };
    column("driver_acceleration_m_s2", &|i| felt(i, 0));
    column("rear_left_acceleration_m_s2", &|i| felt(i, 1));
    for corner in Corner::ALL {
        let name = corner.key();
        column(&format!("displacement_{name}_m"), &|i| {
            samples[i].displacement_m[corner]
        });
        column(&format!("force_{name}_N"), &|i| samples[i].strut[corner].force_n);
        for point in PressurePoint::ALL {
            let title = format!("{}_{name}_Pa", point.key());
            column(&title, &|i| samples[i].strut[corner].pressure_pa[point.index()]);
        }
        column(&format!("wheel_load_{name}_N"), &|i| {
            samples[i].motion.wheel[corner].load_n
        });
    }
    if samples.iter().all(|sample| sample.motion.course.is_some()) {
        for (name, value) in COURSE {
            column(name, &|i| samples[i].motion.course.as_ref().map_or(f64::NAN, value));
        }
    }
    column("valve_word", &|i| f64::from(samples[i].command.word()));
    column("energised_word", &|i| f64::from(samples[i].energised.word()));
    column("handling", &|i| f64::from(u8::from(metrics.strategy[i].handling)));
    column("rollover_guard", &|i| {
        f64::from(u8::from(metrics.strategy[i].rollover_guard))
    });
    columns
}
