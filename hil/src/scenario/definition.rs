//! A complete and valid scenario: vehicle and road, clock, faults and checks.

use oleo_controller::{DamperPolicy, Strategy};
use oleo_interface::tick::TICK_S;
use oleo_interface::{Axle, Corners};
use oleo_plant_sim::course::CourseSettings;
use oleo_plant_sim::vehicle::{Load, Payload};
use strum::{EnumString, IntoStaticStr, VariantNames};

use super::check::Check;
use super::fault::Fault;
use crate::bus::BusAddress;
use crate::imu::ImuSettings;

/// How time passes in a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, EnumString, IntoStaticStr, VariantNames)]
#[strum(serialize_all = "lowercase")]
pub enum Clock {
    /// Plant and controller exchange tick n before either goes on: deterministic, as fast as it goes.
    #[default]
    Lockstep,
    /// Absolute deadlines of wall-clock time.
    RealTime,
}

impl Clock {
    /// As on the command line: `lockstep` or `realtime`.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// What the plant does when the controller is gone for good.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, EnumString, VariantNames)]
#[strum(serialize_all = "lowercase")]
pub enum OnControllerLoss {
    /// Goes on to the end with de-energised valves.
    #[default]
    Continue,
    /// The run ends.
    End,
}

/// A run, complete and checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Name of the scenario, for messages and pages.
    pub name: String,
    /// One sentence that says what the scenario shows.
    pub description: String,
    /// The file as it was written, TOML.
    pub text: String,
    /// What a command line changed, in words such as `road iso-c`; the description is then that of another run.
    pub changes: Vec<String>,
    /// Built-in road or path of a `.crg` or `.csv` file.
    pub road: String,
    /// The manoeuvre that is driven with the handling model; `None` drives straight ahead with the ride model.
    pub course: Option<CourseSettings>,
    /// Forward speed of the vehicle, m/s, 0 to 250 km/h; in a circle the speed at the end.
    pub speed_m_s: f64,
    /// Number of ticks of the run.
    pub ticks: u32,
    /// Strategy that sets the valves.
    pub strategy: Strategy,
    /// How dampers are switched in ride mode.
    pub damper_policy: DamperPolicy,
    /// Strut model: `defender110` or the path of a `model.toml`.
    pub strut: String,
    /// Strut models of single corners, of which the controller is not told: as [`strut`](Self::strut), which a corner without one has.
    pub strut_at: Corners<Option<String>>,
    /// Vehicle: `defender110` or the path of a parameter file.
    pub vehicle: String,
    /// Handling parameters: `defender110` or the path of a file.
    pub handling: String,
    /// What the vehicle carries. The controller does not know it.
    pub load: Load,
    /// A mass that it carries besides, which neither the controller nor its model knows.
    pub payload: Option<Payload>,
    /// Axle whose anti-roll bar has lost a link, so that it twists no more. Neither the controller nor its model knows it.
    pub broken_anti_roll_link: Option<Axle>,
    /// The inertial unit that sends on the same bus; `None` without one.
    pub imu: Option<ImuSettings>,
    /// Time at the start that does not count for ride measures, s.
    pub score_from_s: f64,
    /// Of the road and of all fault randomness.
    pub seed: u64,
    /// Bus that carries the frames.
    pub bus: BusAddress,
    /// Whether the run is in lockstep or in real time.
    pub clock: Clock,
    /// What the plant does without a controller.
    pub on_controller_loss: OnControllerLoss,
    /// Wall-clock time after which a silent partner is gone, s. A guard against hanging, without effect on results.
    pub partner_timeout_s: f64,
    /// Faults that are injected.
    pub faults: Vec<Fault>,
    /// Checks that the run must meet.
    pub checks: Vec<Check>,
}

impl Scenario {
    /// What was run, as a title: the name, and what was changed.
    pub fn title(&self) -> String {
        match self.changes.as_slice() {
            [] => self.name.clone(),
            changes => format!("{} with {}", self.name, changes.join(", ")),
        }
    }

    /// Simulated time of the whole scenario, s.
    pub fn duration_s(&self) -> f64 {
        f64::from(self.ticks) * TICK_S
    }

    /// Length of road that the ride model needs, m, with room for the smooth entry and the rear axle.
    pub fn road_length_m(&self) -> f64 {
        self.speed_m_s * self.duration_s() + 20.0
    }

    /// First tick of the first fault, and the first tick after the last one, where there is any.
    pub fn fault_ticks(&self) -> Option<(u32, u32)> {
        let from = self.faults.iter().map(|fault| fault.from_tick).min()?;
        let until = self.faults.iter().map(|fault| fault.until_tick).max()?;
        Some((from, until))
    }
}
