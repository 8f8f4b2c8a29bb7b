//! A course as people describe it on a command line or in a scenario file.
//!
//! What they leave out has its usual value; what the manoeuvre has no use for is refused, so that nobody believes that a setting
//! had an effect which it did not have.

use std::sync::Arc;

use super::Course;
use super::kind::ManoeuvreKind;
use super::manoeuvre::{LaneChange, Manoeuvre};
use super::style::DriverStyle;
use crate::model_file::{InvalidValue, Range};
use crate::road::{Bend, Road, SideSlope};
use crate::vehicle::VehicleParameters;

/// Way straight ahead before the first cones, m.
const ENTRY_M: f64 = 25.0;
/// Radius of a bend, m.
const RADIUS_M: f64 = 40.0;
/// Angle of a step of steer, degrees.
const STEER_DEG: f64 = 2.0;
/// Time before a step of steer, or before brake or accelerator, s.
const BEGIN_S: f64 = 1.0;
/// Time to settle in the bend before braking in it, s.
const SETTLED_IN_BEND_S: f64 = 8.0;
/// Time to drive from a step of steer on, or from the accelerator on, s.
const AFTER_STEP_S: f64 = 5.0;
/// Station at which a side slope begins, m.
const SLOPE_FROM_M: f64 = 5.0;

/// A manoeuvre, its driver and its road's slope, without speed and duration. `None` is the usual value.
///
/// ```
/// use oleo_plant_sim::course::{CourseSettings, ManoeuvreKind};
/// let mut settings = CourseSettings::new(ManoeuvreKind::StepSteer);
/// settings.steer_deg = Some(3.0);
/// assert!(settings.manoeuvre(20.0, None).is_ok());
/// settings.entry_m = Some(100.0);
/// assert_eq!(
///     settings.manoeuvre(20.0, None).unwrap_err().to_string(),
///     "entry_m does not belong to the manoeuvre step-steer: leave it out"
/// );
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CourseSettings {
    /// What is driven.
    pub kind: ManoeuvreKind,
    /// Who drives; usually eased.
    pub driver: Option<DriverStyle>,
    /// Way straight ahead before the first cones of a lane change, m, 10 to 20,000; usually 25.
    pub entry_m: Option<f64>,
    /// Radius of a bend, m, positive to the left, 8 to 100,000 either way; usually 40.
    pub radius_m: Option<f64>,
    /// Angle of the steering wheel over the steering ratio after a step of steer, degrees, positive to the left, 60 either way;
    /// usually 2.
    pub steer_deg: Option<f64>,
    /// Deceleration or acceleration that is asked for, m/s2, 0.1 to 12; usually 5 for braking and 2 for acceleration.
    pub change_m_s2: Option<f64>,
    /// Time at which the step of steer, the brake or the accelerator begins, s, 0 to 3600; usually 1, and 8 in a bend.
    pub begin_s: Option<f64>,
    /// Side slope of the road, %, positive where the left side is the higher one, 40 either way; usually 0.
    pub side_slope_percent: Option<f64>,
}

impl CourseSettings {
    /// A manoeuvre with usual values.
    pub fn new(kind: ManoeuvreKind) -> Self {
        Self {
            kind,
            driver: None,
            entry_m: None,
            radius_m: None,
            steer_deg: None,
            change_m_s2: None,
            begin_s: None,
            side_slope_percent: None,
        }
    }

    /// Who drives.
    pub fn driver(&self) -> DriverStyle {
        self.driver.unwrap_or(DriverStyle::Eased)
    }

    /// Side slope of the road, %.
    pub fn side_slope_percent(&self) -> f64 {
        self.side_slope_percent.unwrap_or(0.0)
    }

    /// The manoeuvre at a speed (m/s; in a circle that at the end). Without `duration_s` it takes its usual time, and a lane change
    /// ends behind its last cones.
    ///
    /// # Errors
    /// A setting that the manoeuvre has no use for, or that is out of its range, by its name here.
    pub fn manoeuvre(&self, speed_m_s: f64, duration_s: Option<f64>) -> Result<Manoeuvre, InvalidValue> {
        let kind = self.kind;
        self.check_belonging()?;
        if !(1.0 / 3.6..=250.0 / 3.6).contains(&speed_m_s) {
            let what = format!("is {}: a manoeuvre is driven at 1 to 250 km/h", 3.6 * speed_m_s);
            return Err(InvalidValue::new("speed_km_h", what));
        }
        let within = |key: &'static str, value: Option<f64>, usual: f64, range: Range, unit: &str| match value {
            Some(value) if !range.contains(value) => {
                Err(InvalidValue::new(key, format!("is {value}: {}", range.demand(unit))))
            }
            value => Ok(value.unwrap_or(usual)),
        };
        within("duration_s", duration_s, 1.0, Range::FromTo(0.1, 3600.0), "s")?;
        let entry_m = within("entry_m", self.entry_m, ENTRY_M, Range::FromTo(10.0, 20_000.0), "m")?;
        let radius_m = within("radius_m", self.radius_m, RADIUS_M, Range::FromTo(-1e5, 1e5), "m")?;
        if radius_m.abs() < 8.0 {
            let what = format!("is {radius_m}: must be 8 m or more, to the left (positive) or right (negative)");
            return Err(InvalidValue::new("radius_m", what));
        }
        let steer_deg = within(
            "steer_deg",
            self.steer_deg,
            STEER_DEG,
            Range::FromTo(-60.0, 60.0),
            "degrees",
        )?;
        let usual_m_s2 = if kind == ManoeuvreKind::Acceleration { 2.0 } else { 5.0 };
        let change_m_s2 = within(
            "change_m_s2",
            self.change_m_s2,
            usual_m_s2,
            Range::FromTo(0.1, 12.0),
            "m/s2",
        )?;
        within(
            "side_slope_percent",
            self.side_slope_percent,
            0.0,
            Range::FromTo(-40.0, 40.0),
            "%",
        )?;
        let usual_s = match kind {
            ManoeuvreKind::BrakingInBend => SETTLED_IN_BEND_S,
            _ => BEGIN_S,
        };
        let at_s = within("begin_s", self.begin_s, usual_s, Range::FromTo(0.0, 3600.0), "s")?;
        let after = |usual_s: f64| duration_s.unwrap_or(usual_s);
        if kind.has_begin() && duration_s.is_some_and(|end_s| end_s <= at_s) {
            let what = format!("is {at_s}: the drive ends before, at {} s", after(0.0));
            return Err(InvalidValue::new("begin_s", what));
        }
        let lane_change = |kind| Manoeuvre::LaneChange {
            kind,
            speed_m_s,
            entry_m,
            duration_s,
        };
        let braking = |radius_m| Manoeuvre::Braking {
            speed_m_s,
            radius_m,
            deceleration_m_s2: change_m_s2,
            at_s,
            duration_s: after(20.0f64.max(at_s + 12.0)),
        };
        Ok(match kind {
            ManoeuvreKind::Straight => Manoeuvre::Straight {
                speed_m_s,
                duration_s: after(20.0),
            },
            ManoeuvreKind::LaneChange => lane_change(LaneChange::Severe),
            ManoeuvreKind::LaneChange2 => lane_change(LaneChange::ObstacleAvoidance),
            ManoeuvreKind::ConstantRadius => Manoeuvre::ConstantRadius {
                radius_m,
                from_m_s: speed_m_s.min(3.0),
                to_m_s: speed_m_s,
                duration_s: after(90.0),
            },
            ManoeuvreKind::StepSteer => Manoeuvre::StepSteer {
                speed_m_s,
                angle_rad: steer_deg.to_radians(),
                at_s,
                duration_s: after(at_s + AFTER_STEP_S),
            },
            ManoeuvreKind::Braking => braking(None),
            ManoeuvreKind::BrakingInBend => braking(Some(radius_m)),
            ManoeuvreKind::Acceleration => Manoeuvre::Acceleration {
                speed_m_s,
                acceleration_m_s2: change_m_s2,
                at_s,
                duration_s: after(at_s + AFTER_STEP_S),
            },
        })
    }

    /// Length of road that a manoeuvre of these settings needs, m.
    pub fn road_length_m(&self, manoeuvre: &Manoeuvre, vehicle: &VehicleParameters) -> f64 {
        manoeuvre.length_m(&manoeuvre.track(self.driver(), vehicle.layout.width_m))
    }

    /// The course of a manoeuvre of these settings on a surface, which is sloped and laid round the bend.
    pub fn course(&self, manoeuvre: Manoeuvre, surface: Arc<dyn Road>) -> Course {
        let mut road = surface;
        if self.side_slope_percent() != 0.0 {
            road = Arc::new(SideSlope::new(road, 0.01 * self.side_slope_percent(), SLOPE_FROM_M));
        }
        if let Some(radius_m) = manoeuvre.radius_m() {
            road = Arc::new(Bend::new(road, radius_m));
        }
        Course {
            manoeuvre,
            driver: self.driver(),
            road,
        }
    }

    /// A setting without effect on the manoeuvre is refused.
    fn check_belonging(&self) -> Result<(), InvalidValue> {
        let kind = self.kind;
        let settings = [
            ("driver", self.driver.is_some(), kind.has_driver()),
            ("entry_m", self.entry_m.is_some(), kind.has_cones()),
            ("radius_m", self.radius_m.is_some(), kind.has_radius()),
            ("steer_deg", self.steer_deg.is_some(), kind == ManoeuvreKind::StepSteer),
            ("change_m_s2", self.change_m_s2.is_some(), kind.has_pedal()),
            ("begin_s", self.begin_s.is_some(), kind.has_begin()),
        ];
        match settings.into_iter().find(|(_, given, belongs)| *given && !belongs) {
            None => Ok(()),
            Some((key, ..)) => {
                let what = format!("does not belong to the manoeuvre {}: leave it out", kind.key());
                Err(InvalidValue::new(key, what))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use strum::VariantArray;

    fn complaint(kind: ManoeuvreKind, change: impl FnOnce(&mut CourseSettings)) -> String {
        let mut settings = CourseSettings::new(kind);
        change(&mut settings);
        settings.manoeuvre(15.0, Some(10.0)).unwrap_err().to_string()
    }

    #[test]
    fn every_name_is_read_back_and_has_usual_values() {
        for kind in ManoeuvreKind::VARIANTS {
            assert_eq!(kind.key().parse(), Ok(*kind));
            let speed_m_s = kind.usual_speed_km_h() / 3.6;
            CourseSettings::new(*kind).manoeuvre(speed_m_s, None).unwrap();
        }
    }

    /// Every setting, in every manoeuvre: either the manoeuvre is another one with it, or it is refused.
    #[test]
    fn a_setting_has_an_effect_or_is_refused() {
        let set: [fn(&mut CourseSettings); 5] = [
            |s| s.entry_m = Some(77.0),
            |s| s.radius_m = Some(77.0),
            |s| s.steer_deg = Some(7.7),
            |s| s.change_m_s2 = Some(7.7),
            |s| s.begin_s = Some(7.7),
        ];
        for kind in ManoeuvreKind::VARIANTS {
            let usual = CourseSettings::new(*kind);
            for set in set {
                let mut changed = usual.clone();
                set(&mut changed);
                match changed.manoeuvre(15.0, Some(20.0)) {
                    Ok(manoeuvre) => assert_ne!(manoeuvre, usual.manoeuvre(15.0, Some(20.0)).unwrap()),
                    Err(error) => assert!(error.to_string().contains("does not belong to"), "{error}"),
                }
            }
        }
    }

    #[test]
    fn values_out_of_range_are_named() {
        use ManoeuvreKind::{BrakingInBend, ConstantRadius, LaneChange, StepSteer, Straight};
        for (text, expected) in [
            (
                complaint(LaneChange, |s| s.entry_m = Some(f64::NAN)),
                "entry_m is NaN: must be from 10 to",
            ),
            (
                complaint(ConstantRadius, |s| s.radius_m = Some(-7.0)),
                "radius_m is -7: must be 8 m or more",
            ),
            (
                complaint(StepSteer, |s| s.steer_deg = Some(61.0)),
                "steer_deg is 61: must be from -60 to 60",
            ),
            (
                complaint(StepSteer, |s| s.begin_s = Some(10.0)),
                "begin_s is 10: the drive ends before, at 10 s",
            ),
            (
                CourseSettings::new(BrakingInBend)
                    .manoeuvre(15.0, Some(8.0))
                    .unwrap_err()
                    .to_string(),
                "begin_s is 8: the drive ends before, at 8 s",
            ),
            (
                complaint(BrakingInBend, |s| s.change_m_s2 = Some(0.0)),
                "change_m_s2 is 0: must be from 0.1 to 12",
            ),
            (
                complaint(Straight, |s| s.side_slope_percent = Some(50.0)),
                "side_slope_percent is 50: must be from -40",
            ),
            (
                complaint(ConstantRadius, |s| s.driver = Some(DriverStyle::Hard)),
                "driver does not belong",
            ),
        ] {
            assert!(text.starts_with(expected), "{text}");
        }
        let slow = CourseSettings::new(Straight).manoeuvre(0.0, None).unwrap_err();
        assert!(slow.to_string().starts_with("speed_km_h is 0"), "{slow}");
    }
}
