//! The plant's half of a run, in lockstep or in real time.

use std::time::{Duration, Instant};

use oleo_interface::tick::TICK_S;

use super::error::RunError;
use super::outcome::Outcome;
use super::waiting::{TICK, partner_timeout};
use crate::bus::{Bus, BusError, TraceEntry};
use crate::clock::{Lateness, RealTime};
use crate::plant_node::{Answer, PlantNode};
use crate::record::Recording;
use crate::scenario::{OnControllerLoss, Scenario};
use crate::sync::Role;

/// A run that is under way.
#[derive(Clone, Copy)]
pub struct Underway<'r> {
    /// Number of ticks done.
    pub ticks: u32,
    /// What was driven until now.
    pub recording: &'r Recording,
    /// The frames until now.
    pub trace: &'r [TraceEntry],
}

/// Is called every few ticks with the run as it is. It returns `false` to end the run early.
pub type Watch<'a> = &'a mut dyn FnMut(Underway) -> bool;

/// Number of ticks between two calls of [`Watch`]: twenty calls in a second of driving, which look smooth to who follows it.
pub(super) const WATCH_TICKS: u32 = 10;

fn underway<B: Bus>(plant: &PlantNode<B>) -> Underway<'_> {
    Underway {
        ticks: plant.tick(),
        recording: plant.recording(),
        trace: plant.trace(),
    }
}

/// How the plant's loop ended.
pub(super) struct PlantEnd {
    stopped: Instant,
    pub(super) controller_lost_at: Option<u32>,
    interrupted: bool,
    bus_failure: Option<BusError>,
    lateness: Option<Lateness>,
}

impl PlantEnd {
    pub(super) fn outcome<B: Bus>(
        self,
        plant: PlantNode<B>,
        mut lateness: Vec<(Role, Lateness)>,
        started: Instant,
    ) -> Outcome {
        lateness.extend(self.lateness.map(|late| (Role::Plant, late)));
        Outcome {
            plant: plant.into_result(),
            wall_s: (self.stopped - started).as_secs_f64(),
            lateness,
            controller_lost_at: self.controller_lost_at,
            interrupted: self.interrupted,
            bus_failure: self.bus_failure,
        }
    }
}

/// Says that the run is over, to a controller that is there, and takes its answer. A bus that fails now loses no result.
fn part<B: Bus>(
    plant: &mut PlantNode<B>,
    wait: Duration,
    partner: &mut dyn FnMut() -> Result<(), BusError>,
) -> Option<BusError> {
    let parted = plant
        .send_end()
        .and_then(|()| partner())
        .and_then(|()| plant.listen(wait));
    match parted {
        Ok(_) | Err(BusError::Closed { .. }) => None,
        Err(error) => Some(error),
    }
}

/// `partner` is what the other node does in a tick, if it runs in this thread.
pub(super) fn in_lockstep<B: Bus>(
    plant: &mut PlantNode<B>,
    scenario: &Scenario,
    partner: &mut dyn FnMut() -> Result<(), BusError>,
    watch: Watch,
) -> Result<PlantEnd, RunError> {
    let wait = partner_timeout(scenario);
    let (mut controller_lost_at, mut interrupted, mut bus_failure) = (None, false, None);
    while plant.tick() < scenario.ticks && !plant.is_over() {
        // If the other end of the bus was closed, the controller is gone too.
        let exchange = |plant: &mut PlantNode<B>, partner: &mut dyn FnMut() -> Result<(), BusError>| {
            plant.send_sensors()?;
            plant.send_done()?;
            partner()?;
            plant.listen(wait)
        };
        if controller_lost_at.is_none() {
            match exchange(plant, partner) {
                Ok(Answer::Done | Answer::Rejoined) => {}
                Ok(Answer::Nothing) | Err(BusError::Closed { .. }) => {
                    controller_lost_at = Some(plant.tick());
                    if scenario.on_controller_loss == OnControllerLoss::End {
                        break;
                    }
                }
                Err(error) if plant.tick() > 0 => {
                    bus_failure = Some(error);
                    break;
                }
                Err(error) => return Err(error.into()),
            }
        }
        plant.advance()?;
        if plant.tick().is_multiple_of(WATCH_TICKS) && !watch(underway(plant)) {
            interrupted = true;
            break;
        }
    }
    let stopped = Instant::now();
    if controller_lost_at.is_none() && bus_failure.is_none() {
        bus_failure = part(plant, wait, partner);
    }
    Ok(PlantEnd {
        stopped,
        controller_lost_at,
        interrupted,
        bus_failure,
        lateness: None,
    })
}

pub(super) fn in_real_time<B: Bus>(
    plant: &mut PlantNode<B>,
    scenario: &Scenario,
    begin: Instant,
    watch: Watch,
) -> Result<PlantEnd, RunError> {
    let mut clock = RealTime::new(begin, TICK, scenario.ticks as usize);
    let silence = (scenario.partner_timeout_s / TICK_S) as u32;
    let (mut controller_lost_at, mut is_gone) = (None, false);
    let (mut interrupted, mut bus_failure) = (false, None);
    while plant.tick() < scenario.ticks && !plant.is_over() {
        clock.wait(plant.tick());
        // The command that answered the last tick holds from here on: one tick of latency, as on a real bus.
        match plant.listen(Duration::ZERO).and_then(|_| plant.send_sensors()) {
            Ok(()) => is_gone = plant.ticks_without_command() >= silence.max(1),
            Err(BusError::Closed { .. }) => is_gone = true,
            Err(error) if plant.tick() > 0 => {
                bus_failure = Some(error);
                break;
            }
            Err(error) => return Err(error.into()),
        }
        if is_gone {
            controller_lost_at = controller_lost_at.or(Some(plant.tick()));
        }
        plant.advance()?;
        if is_gone && scenario.on_controller_loss == OnControllerLoss::End {
            break;
        }
        if plant.tick().is_multiple_of(WATCH_TICKS) && !watch(underway(plant)) {
            interrupted = true;
            break;
        }
    }
    let stopped = Instant::now();
    if !is_gone && bus_failure.is_none() {
        bus_failure = part(plant, partner_timeout(scenario), &mut || Ok(()));
    }
    Ok(PlantEnd {
        stopped,
        controller_lost_at,
        interrupted,
        bus_failure,
        lateness: Some(clock.lateness()),
    })
}
