//! The columns of `timeseries.csv`: one value a tick, names with units. A run with a manoeuvre has some more.

use oleo_interface::tick::TICK_S;
use oleo_interface::{Corner, PressurePoint};
use oleo_plant_sim::vehicle::BodyMotion;

use crate::metrics::Metrics;
use crate::record::{CourseMotion, Recording, Sample, StrategyReport};
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

/// A quantity of the body.
type OfBody = fn(&BodyMotion) -> f64;

/// How the body moves.
const BODY: [(&str, OfBody); 6] = [
    ("heave_m", |body| body.heave_m),
    ("roll_rad", |body| body.roll_rad),
    ("pitch_rad", |body| body.pitch_rad),
    ("heave_acceleration_m_s2", |body| body.heave_acceleration_m_s2),
    ("roll_acceleration_rad_s2", |body| body.roll_acceleration_rad_s2),
    ("pitch_acceleration_rad_s2", |body| body.pitch_acceleration_rad_s2),
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

/// A tick of a run, as the columns take it.
pub struct Tick<'r> {
    /// Number of the tick, from 0.
    pub number: usize,
    /// State at its beginning, and the valve commands.
    pub sample: &'r Sample,
    /// Vertical acceleration at the driver's and at the left rear passenger's seat, m/s2: that of the last integration step before the
    /// tick, 0 at the start.
    pub felt_m_s2: [f64; 2],
    /// What the controller had last reported of its strategy.
    pub strategy: StrategyReport,
}

impl<'r> Tick<'r> {
    /// The tick of this number; `None` if it was not driven.
    pub fn of(recording: &'r Recording, number: usize, strategy: StrategyReport) -> Option<Self> {
        let seats = &recording.seat_acceleration_m_s2;
        let steps = seats.len() / recording.samples.len().max(1);
        let last = (number * steps).checked_sub(1);
        Some(Self {
            number,
            sample: recording.samples.get(number)?,
            felt_m_s2: last.and_then(|at| seats.get(at)).copied().unwrap_or_default(),
            strategy,
        })
    }
}

/// What a column takes of a tick.
pub type OfTick = Box<dyn Fn(&Tick) -> f64 + Send>;

/// Name of each column, and what it takes of a tick. What only a vehicle on a course or one with an inertial unit has is there where it is asked for.
pub fn quantities(on_course: bool, with_unit: bool) -> Vec<(String, OfTick)> {
    let mut columns: Vec<(String, OfTick)> = Vec::with_capacity(64);
    let mut column = |name: &str, of: OfTick| columns.push((name.to_owned(), of));
    column("time_s", Box::new(|at| at.number as f64 * TICK_S));
    column("station_m", Box::new(|at| at.sample.motion.station_m));
    for corner in Corner::ALL {
        let name = corner.key();
        column(
            &format!("road_{name}_m"),
            Box::new(move |at| at.sample.motion.wheel[corner].road_height_m),
        );
    }
    for (name, of) in BODY {
        column(name, Box::new(move |at| of(&at.sample.motion.body)));
    }
    column("driver_acceleration_m_s2", Box::new(|at| at.felt_m_s2[0]));
    column("rear_left_acceleration_m_s2", Box::new(|at| at.felt_m_s2[1]));
    for corner in Corner::ALL {
        let name = corner.key();
        column(
            &format!("displacement_{name}_m"),
            Box::new(move |at| at.sample.displacement_m[corner]),
        );
        column(
            &format!("force_{name}_N"),
            Box::new(move |at| at.sample.strut[corner].force_n),
        );
        for point in PressurePoint::ALL {
            column(
                &format!("{}_{name}_Pa", point.key()),
                Box::new(move |at| at.sample.strut[corner].pressure_pa[point.index()]),
            );
        }
        column(
            &format!("wheel_load_{name}_N"),
            Box::new(move |at| at.sample.motion.wheel[corner].load_n),
        );
    }
    if on_course {
        for (name, of) in COURSE {
            column(
                name,
                Box::new(move |at| at.sample.motion.course.as_ref().map_or(f64::NAN, of)),
            );
        }
    }
    if with_unit {
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            column(
                &format!("imu_specific_force_{name}_m_s2"),
                Box::new(move |at| {
                    at.sample
                        .inertial
                        .map_or(f64::NAN, |read| read.specific_force_m_s2[axis])
                }),
            );
        }
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            column(
                &format!("imu_rate_{name}_rad_s"),
                Box::new(move |at| at.sample.inertial.map_or(f64::NAN, |read| read.rate_rad_s[axis])),
            );
        }
    }
    column("valve_word", Box::new(|at| f64::from(at.sample.command.word())));
    column("energised_word", Box::new(|at| f64::from(at.sample.energised.word())));
    column("handling", Box::new(|at| f64::from(u8::from(at.strategy.handling))));
    column(
        "rollover_guard",
        Box::new(|at| f64::from(u8::from(at.strategy.rollover_guard))),
    );
    columns
}

/// Name and values of each column of `timeseries.csv`, a value for each tick.
pub fn columns(outcome: &Outcome, metrics: &Metrics) -> Vec<(String, Vec<f64>)> {
    let recording = &outcome.plant.recording;
    let ticks: Vec<Tick> = (metrics.strategy.iter().enumerate())
        .filter_map(|(number, strategy)| Tick::of(recording, number, *strategy))
        .collect();
    let on_course = ticks.iter().all(|at| at.sample.motion.course.is_some());
    let with_unit = ticks.iter().any(|at| at.sample.inertial.is_some());
    quantities(on_course, with_unit)
        .into_iter()
        .map(|(name, of)| (name, ticks.iter().map(of).collect()))
        .collect()
}
