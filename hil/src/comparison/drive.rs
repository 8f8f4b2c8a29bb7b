//! One setting on one drive.

use std::sync::Arc;

use oleo_controller::{Builder, ConfigurationError, Estimate, State, Strategy, ValveCommand, tick};
use oleo_interface::tick::TICK_S;
use oleo_interface::{Corners, StrutValves};
use oleo_plant_sim::course::{Course, Drive, Ending, NotFinite};
use oleo_plant_sim::handling::HandlingModel;
use oleo_plant_sim::road::{self, RoadError};
use oleo_plant_sim::strut::Strut;
use oleo_plant_sim::vehicle::RideError;
use oleo_plant_sim::vehicle::StrutElement;
use oleo_plant_sim::vehicle::suspension::{CoilElement, SuspensionElement};

use super::bench::Bench;
use super::case::DriveCase;
use super::figures::{Figures, Scored};
use super::sensors::Sensors;
use super::setting::Setting;
use super::witness::{Instant, Nobody, Witness};

/// A drive that could not be made.
#[derive(Debug, thiserror::Error)]
pub enum ComparisonError {
    /// Vehicle and springs do not fit.
    #[error(transparent)]
    Vehicle(#[from] RideError),
    /// A strut cannot be charged for its load.
    #[error("strut {0}")]
    Strut(#[from] oleo_plant_sim::model_file::InvalidValue),
    /// The model left the real numbers.
    #[error(transparent)]
    NotFinite(#[from] NotFinite),
    /// The vehicle cannot be described to the controller.
    #[error(transparent)]
    Configuration(#[from] ConfigurationError),
    /// No road.
    #[error(transparent)]
    Road(#[from] RoadError),
}

/// True lateral acceleration at which a manoeuvre counts as begun, m/s2.
const BEGUN_M_S2: f64 = 0.5;

/// Drives a case with a setting.
///
/// # Errors
/// A road that is not there, or a vehicle that its springs do not carry.
pub fn drive(bench: &Bench, case: &DriveCase, setting: &Setting) -> Result<Figures, ComparisonError> {
    let mut scored = Scored::new(case, bench.vehicle.solver.step_s);
    let ending = drive_seen_by(&mut scored, bench, case, setting)?;
    Ok(scored.figures(ending))
}

/// Drives a case with a setting, and says how it ended.
pub(super) fn drive_seen_by(
    witness: &mut impl Witness,
    bench: &Bench,
    case: &DriveCase,
    setting: &Setting,
) -> Result<Ending, ComparisonError> {
    match setting {
        Setting::AsSold => {
            let drive = begin(bench, case, CoilElement::of_vehicle(&bench.vehicle))?;
            follow(drive, witness, |_| (Corners::default(), ValveCommand::SAFE, false))
        }
        Setting::Fixed(open) => {
            let command = ValveCommand::from_corners(Corners::splat(*open));
            let drive = begin(bench, case, struts(bench, *open)?)?;
            follow(drive, witness, |_| (command.corners(), command, false))
        }
        Setting::Oracle { before, delay_s } => {
            let drive = begin(bench, case, struts(bench, *before)?)?;
            let decided_tick = case
                .begins_s
                .map_or(u64::MAX, |begins| ((begins + delay_s) / TICK_S).round() as u64);
            let (before, mut ticks) = (ValveCommand::from_corners(Corners::splat(*before)), 0);
            follow(drive, witness, |_| {
                let corners = ticks >= decided_tick;
                ticks += 1;
                let command = if corners { ValveCommand::SAFE } else { before };
                (command.corners(), command, corners)
            })
        }
        Setting::Controlled(_, configuration) => {
            let drive = begin(bench, case, struts(bench, StrutValves::splat(false))?)?;
            let (mut state, mut sensors) = (State::new(), Sensors::new(bench, case.seed));
            follow(drive, witness, |model| {
                let inputs = sensors.read(model.strut_displacement_m(), model.strut_output());
                let outputs = tick(configuration, &mut state, &inputs);
                (outputs.command.corners(), outputs.command, outputs.handling)
            })
        }
    }
}

/// What the controller estimates in each tick of a drive with all valves open, whatever it would decide: thresholds can be tried on it
/// without another drive.
///
/// # Errors
/// As of [`drive`].
pub fn estimates(bench: &Bench, case: &DriveCase) -> Result<Vec<Estimate>, ComparisonError> {
    let configuration = Builder {
        strategy: Strategy::AlwaysSoft,
        ..bench.controller()
    };
    let configuration = configuration.build()?;
    let drive = begin(bench, case, struts(bench, StrutValves::splat(false))?)?;
    let (mut state, mut sensors) = (State::new(), Sensors::new(bench, case.seed));
    let mut estimates = Vec::new();
    follow(drive, &mut Nobody, |model| {
        let inputs = sensors.read(model.strut_displacement_m(), model.strut_output());
        let outputs = tick(&configuration, &mut state, &inputs);
        estimates.push(outputs.estimate);
        (outputs.command.corners(), outputs.command, outputs.handling)
    })?;
    Ok(estimates)
}

/// The bench's four struts at rest.
fn struts(bench: &Bench, open: StrutValves<bool>) -> Result<Corners<StrutElement>, ComparisonError> {
    Corners::try_from_fn(|corner| Ok(StrutElement::new(Strut::at_rest(&bench.struts[corner], open)?)))
}

/// A drive of the bench's vehicle on these springs, at its beginning.
fn begin<E: SuspensionElement>(
    bench: &Bench,
    case: &DriveCase,
    elements: Corners<E>,
) -> Result<Drive<E>, ComparisonError> {
    let track = case.manoeuvre.track(case.driver, bench.vehicle.layout.width_m);
    let course = Course {
        manoeuvre: case.manoeuvre,
        driver: case.driver,
        road: road::from_name_or_path(&case.road, case.manoeuvre.length_m(&track), case.seed)?,
    };
    Ok(Drive::begin(&course, &bench.vehicle, &bench.handling, elements)?)
}

/// Drives to the end.
fn follow<E: SuspensionElement>(
    mut drive: Drive<E>,
    witness: &mut impl Witness,
    mut decide: impl FnMut(&HandlingModel<E>) -> (Corners<E::Signal>, ValveCommand, bool),
) -> Result<Ending, ComparisonError> {
    let places = drive.seat_places_m();
    loop {
        let (signals, command, handling) = decide(drive.model());
        witness.tick(&Instant {
            roll_rad: drive.model().motion().roll_rad,
            command,
            handling,
            phase: drive.phase(),
        });
        if let Some(ending) = drive.ending() {
            return Ok(ending);
        }
        drive.tick(signals, |model| {
            witness.step(places.map(|place_m| model.acceleration_at(place_m)))
        })?;
    }
}

/// When a manoeuvre begins, s: the first time that the same manoeuvre on a flat road, with all valves closed, asks for more than
/// 0.5 m/s2. On a rough road the road itself makes that much, so it cannot be seen there. `None` for a drive straight ahead.
///
/// # Errors
/// A vehicle that its springs do not carry.
pub fn beginning_s(bench: &Bench, case: &DriveCase) -> Result<Option<f64>, ComparisonError> {
    if case.is_straight() {
        return Ok(None);
    }
    let course = Course {
        manoeuvre: case.manoeuvre,
        driver: case.driver,
        road: Arc::new(road::Flat),
    };
    let closed = StrutValves::splat(false);
    let mut drive = Drive::begin(&course, &bench.vehicle, &bench.handling, struts(bench, closed)?)?;
    while drive.ending().is_none() {
        if drive.model().motion().lateral_acceleration_m_s2.abs() > BEGUN_M_S2 {
            return Ok(Some(f64::from(drive.ticks()) * TICK_S));
        }
        drive.tick(Corners::splat(closed), |_| {})?;
    }
    Ok(None)
}
