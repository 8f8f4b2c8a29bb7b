//! A course: a manoeuvre, the driver who drives it, and the road under it; and a vehicle on it, tick by tick.
//!
//! ```text
//!  manoeuvre --+                     +--> track --> driver (preview or optimal preview) --> steer --+
//!  driver -----+--> Course --> Drive-+--> speed control --> drive, brake ---------------------------+--> HandlingModel
//!  road -------+                     +--> valves' signals of the caller ----------------------------+         |
//!                                                                              Sample, Ending <---------------+
//! ```
//!
//! [`CourseSettings`] is a course as people describe it. Nothing here reads a file or knows a command line: a road is handed in.

mod changes;
mod drive;
mod kind;
mod manoeuvre;
mod optimal_preview;
mod preview;
mod run;
mod sample;
mod settings;
mod speed;
mod style;
mod track;

use std::sync::Arc;

pub use changes::CourseChanges;
pub use drive::{Drive, NotFinite};
pub use kind::ManoeuvreKind;
pub use manoeuvre::{LaneChange, Manoeuvre, Phase};
pub use optimal_preview::OptimalPreviewDriver;
pub use preview::PreviewDriver;
pub use run::Run;
pub use sample::{Sample, Signals};
pub use settings::CourseSettings;
pub use speed::SpeedControl;
pub use style::DriverStyle;
pub use track::{Gate, LaneChangeLine, Track};

use crate::road::Road;
use crate::vehicle::VehicleParameters;

/// A manoeuvre, its driver and the road.
#[derive(Clone)]
pub struct Course {
    /// What is driven, and how fast.
    pub manoeuvre: Manoeuvre,
    /// The driver of the manoeuvre.
    pub driver: DriverStyle,
    /// What it is driven on.
    pub road: Arc<dyn Road>,
}

impl Course {
    /// The line that the driver follows with a vehicle.
    pub fn track(&self, vehicle: &VehicleParameters) -> Track {
        self.manoeuvre.track(self.driver, vehicle.layout.width_m)
    }
}

/// How a drive ended. Roll-over, spinning and hit cones are outcomes, not failures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ending {
    /// The vehicle completed the manoeuvre.
    Completed,
    /// The body lay on its side or beyond at this time, s.
    RolledOver(f64),
    /// It slid 45 degrees from its heading at this time, s.
    Spun(f64),
    /// It was too far off the line at this time, s.
    LostTrack(f64),
}

impl Ending {
    /// The ending in words, for tables.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Completed => "completed",
            Self::RolledOver(_) => "rolled over",
            Self::Spun(_) => "spun",
            Self::LostTrack(_) => "lost the track",
        }
    }
}
