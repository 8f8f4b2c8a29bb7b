//! What is said about a manoeuvre beside the settings that it already has.

use super::kind::ManoeuvreKind;
use super::settings::CourseSettings;
use super::style::DriverStyle;

/// Settings that replace those of a manoeuvre; `None` leaves one as it is. They mean what they mean in [`CourseSettings`].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CourseChanges {
    /// Who drives.
    pub driver: Option<DriverStyle>,
    /// Way straight ahead before the first cones of a lane change, m.
    pub entry_m: Option<f64>,
    /// Radius of a bend, m.
    pub radius_m: Option<f64>,
    /// Angle of a step of steer, degrees.
    pub steer_deg: Option<f64>,
    /// Deceleration or acceleration that is asked for, m/s2.
    pub change_m_s2: Option<f64>,
    /// Time at which the step of steer, the brake or the accelerator begins, s.
    pub begin_s: Option<f64>,
    /// Side slope of the road, %.
    pub side_slope_percent: Option<f64>,
}

impl CourseChanges {
    /// The settings of a manoeuvre without any before.
    #[must_use]
    pub fn settings(&self, kind: ManoeuvreKind) -> CourseSettings {
        self.changed(CourseSettings::new(kind))
    }

    /// The settings, changed by what is given.
    #[must_use]
    pub fn changed(&self, before: CourseSettings) -> CourseSettings {
        CourseSettings {
            kind: before.kind,
            driver: self.driver.or(before.driver),
            entry_m: self.entry_m.or(before.entry_m),
            radius_m: self.radius_m.or(before.radius_m),
            steer_deg: self.steer_deg.or(before.steer_deg),
            change_m_s2: self.change_m_s2.or(before.change_m_s2),
            begin_s: self.begin_s.or(before.begin_s),
            side_slope_percent: self.side_slope_percent.or(before.side_slope_percent),
        }
    }

    /// Name of the first that is given.
    #[must_use]
    pub fn first_given(&self) -> Option<&'static str> {
        let given = [
            ("driver", self.driver.is_some()),
            ("side_slope_percent", self.side_slope_percent.is_some()),
            ("entry_m", self.entry_m.is_some()),
            ("radius_m", self.radius_m.is_some()),
            ("steer_deg", self.steer_deg.is_some()),
            ("change_m_s2", self.change_m_s2.is_some()),
            ("begin_s", self.begin_s.is_some()),
        ];
        given.into_iter().find(|(_, given)| *given).map(|(name, _)| name)
    }
}
