//! The controller's half of a run: it answers ticks until the plant ends the run or is lost.

use std::time::{Duration, Instant};

use oleo_controller::Mode;
use oleo_interface::tick::TICK_S;

use super::waiting::{TICK, partner_timeout};
use crate::bus::{Bus, BusError};
use crate::clock::{Lateness, RealTime};
use crate::controller_node::{ControllerNode, Heard};
use crate::scenario::Scenario;

/// Most ticks for which a controller without a plant is watched until it reaches a safe mode.
const RUN_DOWN_TICKS: u32 = 1000;

/// How the controller came to be without its plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlantLost {
    /// The plant's last tick.
    pub last_tick: u32,
    /// Number of ticks from there to a safe mode; `None` if the mode machine did not reach one.
    pub safe_after: Option<u32>,
    /// Whether the plant was started again, and so wants another run.
    pub restarted: bool,
}

pub(super) fn in_lockstep<B: Bus>(
    controller: &mut ControllerNode<B>,
    scenario: &Scenario,
) -> Result<Option<PlantLost>, BusError> {
    let wait = partner_timeout(scenario);
    loop {
        let restarted = match controller.listen(wait) {
            Ok(Heard::Tick) => {
                controller.decide()?;
                controller.send_done()?;
                continue;
            }
            Ok(Heard::End) => {
                controller.send_tally()?;
                return Ok(None);
            }
            Ok(Heard::Restarted) => true,
            Ok(Heard::Nothing) | Err(BusError::Closed { .. }) => false,
            Err(error) => return Err(error),
        };
        return Ok(Some(PlantLost {
            last_tick: controller.tick(),
            safe_after: run_down(controller)?,
            restarted,
        }));
    }
}

/// Ticks on without a plant until the mode is safe. Returns the number of ticks that this has taken.
fn run_down<B: Bus>(controller: &mut ControllerNode<B>) -> Result<Option<u32>, BusError> {
    for ticks in 1..=RUN_DOWN_TICKS {
        controller.next_tick();
        match controller.decide() {
            Ok(()) | Err(BusError::Closed { .. }) => {}
            Err(error) => return Err(error),
        }
        if matches!(controller.mode().0, Mode::Safe | Mode::Latched) {
            return Ok(Some(ticks));
        }
    }
    Ok(None)
}

pub(super) fn in_real_time<B: Bus>(
    controller: &mut ControllerNode<B>,
    scenario: &Scenario,
    begin: Instant,
) -> Result<(Lateness, Option<PlantLost>), BusError> {
    let mut clock = RealTime::new(begin, TICK, scenario.ticks as usize);
    let silence = (scenario.partner_timeout_s / TICK_S) as u32;
    let (mut silent, mut last_tick, mut safe_after) = (0, 0, None);
    let mut restarted = false;
    for tick in 0.. {
        clock.wait(tick);
        match controller.listen(Duration::ZERO) {
            Ok(Heard::End) => {
                controller.send_tally()?;
                break;
            }
            Ok(Heard::Restarted) => restarted = true,
            Ok(Heard::Tick | Heard::Nothing) => {}
            Err(BusError::Closed { .. }) => silent = silence,
            Err(error) => return Err(error),
        }
        if controller.heard_the_plant() {
            (silent, last_tick, safe_after) = (0, tick, None);
        } else {
            silent += 1;
        }
        controller.set_tick(tick);
        match controller.decide() {
            Ok(()) | Err(BusError::Closed { .. }) => {}
            Err(error) => return Err(error),
        }
        if silent > 0 && safe_after.is_none() && matches!(controller.mode().0, Mode::Safe | Mode::Latched) {
            safe_after = Some(tick - last_tick);
        }
        if silent > silence || (restarted && safe_after.is_some()) {
            let lost = PlantLost {
                last_tick,
                safe_after,
                restarted,
            };
            return Ok((clock.lateness(), Some(lost)));
        }
    }
    Ok((clock.lateness(), None))
}
