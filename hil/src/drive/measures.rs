//! The measures of a drive: comfort at both seats, roll, clearance to the cones, and the measures of each standard.

use oleo_interface::tick::TICK_S;
use oleo_plant_sim::course::{Manoeuvre, Sample};
use oleo_plant_sim::measures::SeatMeter;
use oleo_plant_sim::vehicle::Seats;

use super::driven::Driven;
use super::plan::Plan;

/// Lateral acceleration between which the understeer gradient is fitted, m/s2 (ISO 4138: the linear range).
const LINEAR_RANGE_M_S2: (f64, f64) = (0.5, 3.0);

/// Key in `summary.json`, words, value, unit.
pub type Measure = (&'static str, &'static str, f64, &'static str);

/// Measures of one drive; comfort from `score_from_s` (s) on.
pub fn measures(plan: &Plan, driven: &Driven, score_from_s: f64) -> Vec<Measure> {
    let run = &driven.run;
    let mut meters = Seats::from_fn(|_| SeatMeter::new(TICK_S, score_from_s));
    for sample in &run.history {
        meters.iter_mut().for_each(|(seat, meter)| meter.add(sample.seat[seat]));
    }
    let Seats { driver, passenger } = meters.map(|meter| meter.measures());
    let peak = |of: fn(&Sample) -> f64| run.history.iter().map(|s| of(s).abs()).fold(0.0, f64::max);
    let mut list = vec![
        (
            "weighted_rms_driver_m_s2",
            "vertical weighted RMS at the driver (BS 6841)",
            driver.vertical.weighted_rms_m_s2,
            "m/s2",
        ),
        (
            "weighted_rms_rear_left_m_s2",
            "vertical weighted RMS at the left rear passenger",
            passenger.vertical.weighted_rms_m_s2,
            "m/s2",
        ),
        (
            "msdv_driver_m_s1_5",
            "motion sickness dose at the driver",
            driver.vertical.msdv_m_s1_5,
            "m/s^1.5",
        ),
        (
            "max_roll_deg",
            "largest body roll",
            run.max_roll_rad.to_degrees(),
            "degrees",
        ),
        (
            "max_pitch_deg",
            "largest body pitch",
            peak(|s| s.pitch_rad).to_degrees(),
            "degrees",
        ),
        (
            "wheel_lift_s",
            "time with a wheel off the ground",
            run.wheel_lift_s,
            "s",
        ),
    ];
    if driver.lateral_weighted_rms_m_s2 + driver.fore_aft_weighted_rms_m_s2 > 0.0 {
        for (key, words, value) in [
            (
                "weighted_rms_lateral_driver_m_s2",
                "lateral weighted RMS at the driver (Wd)",
                driver.lateral_weighted_rms_m_s2,
            ),
            (
                "weighted_rms_lateral_rear_left_m_s2",
                "lateral weighted RMS at the left rear passenger",
                passenger.lateral_weighted_rms_m_s2,
            ),
            (
                "weighted_rms_fore_aft_driver_m_s2",
                "fore-aft weighted RMS at the driver (Wd)",
                driver.fore_aft_weighted_rms_m_s2,
            ),
            (
                "weighted_rms_combined_driver_m_s2",
                "weighted RMS of all three axes at the driver",
                driver.combined_rms_m_s2,
            ),
            (
                "weighted_rms_combined_rear_left_m_s2",
                "weighted RMS of all three axes at the left rear passenger",
                passenger.combined_rms_m_s2,
            ),
        ] {
            list.push((key, words, value, "m/s2"));
        }
    }
    if run.max_lateral_m_s2 > 0.0 {
        list.push((
            "max_lateral_m_s2",
            "largest lateral acceleration",
            run.max_lateral_m_s2,
            "m/s2",
        ));
        list.push((
            "max_yaw_rate_deg_s",
            "largest yaw rate",
            peak(|s| s.yaw_rate_rad_s).to_degrees(),
            "degrees/s",
        ));
        list.push((
            "max_side_slip_deg",
            "largest side slip",
            peak(|s| s.side_slip_rad).to_degrees(),
            "degrees",
        ));
    }
    let rise_m = plan.rise_m(driven.setting);
    if rise_m != (0.0, 0.0) {
        list.push((
            "front_rise_m",
            "change of ride height from the gas temperature, front",
            rise_m.0,
            "m",
        ));
        list.push((
            "rear_rise_m",
            "change of ride height from the gas temperature, rear",
            rise_m.1,
            "m",
        ));
    }
    if let Some(margin) = run.cone_margin_m {
        list.push((
            "cone_margin_m",
            "smallest clearance to the cones (negative if one is hit)",
            margin,
            "m",
        ));
    }
    match &plan.course.manoeuvre {
        Manoeuvre::ConstantRadius { .. } => {
            if let Some(gradient) = understeer_gradient(&run.history) {
                let gradient = gradient.to_degrees();
                list.push(("understeer_deg_s2_m", "understeer gradient", gradient, "degrees/(m/s2)"));
            }
            if let Some(gradient) = roll_gradient(&run.history) {
                list.push((
                    "roll_gradient_deg_s2_m",
                    "roll gradient",
                    gradient.to_degrees(),
                    "degrees/(m/s2)",
                ));
            }
        }
        Manoeuvre::StepSteer { at_s, .. } => {
            if let Some((steady, overshoot, time_s)) = step_response(&run.history, *at_s) {
                list.push((
                    "steady_yaw_rate_deg_s",
                    "steady yaw rate",
                    steady.to_degrees(),
                    "degrees/s",
                ));
                list.push(("yaw_overshoot", "overshoot of the yaw rate", 100.0 * overshoot, "%"));
                list.push(("yaw_response_s", "time to 90 % of the steady yaw rate", time_s, "s"));
            }
        }
        Manoeuvre::Braking { at_s, .. } => {
            if let Some((distance_m, mean_m_s2)) = stopping(&run.history, *at_s) {
                list.push(("stopping_distance_m", "stopping distance", distance_m, "m"));
                list.push(("mean_deceleration_m_s2", "mean deceleration", mean_m_s2, "m/s2"));
            }
        }
        Manoeuvre::Straight { .. } | Manoeuvre::LaneChange { .. } | Manoeuvre::Acceleration { .. } => {}
    }
    list
}

/// Slope of `of` over lateral acceleration in the linear range, by least squares.
fn slope(history: &[Sample], of: fn(&Sample) -> f64) -> Option<f64> {
    let inside = |s: &&Sample| {
        let lateral = s.lateral_acceleration_m_s2.abs();
        s.time_s > 5.0 && lateral > LINEAR_RANGE_M_S2.0 && lateral < LINEAR_RANGE_M_S2.1
    };
    let (mut n, mut x, mut y, mut xx, mut xy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for sample in history.iter().filter(inside) {
        let (a, b) = (sample.lateral_acceleration_m_s2, of(sample));
        n += 1.0;
        x += a;
        y += b;
        xx += a * a;
        xy += a * b;
    }
    let determinant = n * xx - x * x;
    (n > 10.0 && determinant > 0.0).then(|| (n * xy - x * y) / determinant)
}

/// Change of steer angle with lateral acceleration at constant radius.
fn understeer_gradient(history: &[Sample]) -> Option<f64> {
    slope(history, |s| s.steer_rad)
}

fn roll_gradient(history: &[Sample]) -> Option<f64> {
    slope(history, |s| s.roll_rad)
}

/// Steady yaw rate, overshoot over it, time from the step to 90 % of it.
fn step_response(history: &[Sample], at_s: f64) -> Option<(f64, f64, f64)> {
    let steady = history.last()?.yaw_rate_rad_s;
    let side = steady.signum();
    let most = history.iter().map(|s| side * s.yaw_rate_rad_s).fold(0.0, f64::max);
    let reached = history.iter().find(|s| side * s.yaw_rate_rad_s >= 0.9 * steady.abs())?;
    Some((steady, most / steady.abs() - 1.0, reached.time_s - at_s))
}

/// Way and mean deceleration from the begin of braking to the end of the drive.
fn stopping(history: &[Sample], at_s: f64) -> Option<(f64, f64)> {
    let begin = history.iter().find(|s| s.time_s >= at_s)?;
    let (mut way_m, mut from) = (0.0, begin);
    for sample in history.iter().filter(|s| s.time_s > at_s) {
        let (dx, dy) = (sample.station_m - from.station_m, sample.lateral_m - from.lateral_m);
        way_m += (dx * dx + dy * dy).sqrt();
        from = sample;
    }
    let took_s = from.time_s - begin.time_s;
    (took_s > 0.0).then(|| (way_m, (begin.speed_m_s - from.speed_m_s) / took_s))
}
