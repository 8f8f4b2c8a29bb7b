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

/// The plant's last tick, and the number of ticks from there to a safe mode; `None` if the mode machine did not reach one.
pub(super) type PlantLost = (u32, Option<u32>);

pub(super) fn in_lockstep<B: Bus>(
    controller: &mut ControllerNode<B>,
    scenario: &Scenario,
) -> Result<Option<PlantLost>, BusError> {
    let wait = partner_timeout(scenario);
    loop {
        match controller.listen(wait) {
            Ok(Heard::Tick) => {
                controller.decide()?;
                controller.send_done()?;
            }
            Ok(Heard::End) => {
                controller.send_tally()?;
                return Ok(None);
            }
            Ok(Heard::Nothing) | Err(BusError::Closed { .. }) => {
                let last = controller.tick();
                let mut taken = None;
                for ticks in 1..=RUN_DOWN_TICKS {
                    controller.next_tick();
                    match controller.decide() {
                        Ok(()) | Err(BusError::Closed { .. }) => {}
                        Err(error) => return Err(error),
                    }
                    if matches!(controller.mode().0, Mode::Safe | Mode::Latched) {
                        taken = Some(ticks);
                        break;
                    }
                }
                return Ok(Some((last, taken)));
            }
            Err(error) => return Err(error),
        }
    }
}

pub(super) fn in_real_time<B: Bus>(
    controller: &mut ControllerNode<B>,
    scenario: &Scenario,
    begin: Instant,
) -> Result<(Lateness, Option<PlantLost>), BusError> {
    let mut clock = RealTime::new(begin, TICK, scenario.ticks as usize);
    let silence = (scenario.partner_timeout_s / TICK_S) as u32;
    let (mut silent, mut last_heard, mut safe_after) = (0, 0, None);
    for tick in 0.. {
        clock.wait(tick);
        match controller.listen(Duration::ZERO) {
            Ok(Heard::End) => {
                controller.send_tally()?;
                break;
            }
            Ok(_) => {}
            Err(BusError::Closed { .. }) => silent = silence,
            Err(error) => return Err(error),
        }
        if controller.heard_anything() {
            (silent, last_heard, safe_after) = (0, tick, None);
        } else {
            silent += 1;
        }
        controller.set_tick(tick);
        match controller.decide() {
            Ok(()) | Err(BusError::Closed { .. }) => {}
            Err(error) => return Err(error),
        }
        if silent > 0 && safe_after.is_none() && matches!(controller.mode().0, Mode::Safe | Mode::Latched) {
            safe_after = Some(tick - last_heard);
        }
        if silent > silence {
            return Ok((clock.lateness(), Some((last_heard, safe_after))));
        }
    }
    Ok((clock.lateness(), None))
}
