//! The surroundings of the image for an emulator: slcan on USART1, and a tick whenever the simulated plant has ended one.
//!
//! QEMU's STM32F405 has no ready flags of the clock tree, so that the core seems to stay at 16 MHz; the line does not mind. Its ports
//! cannot be read back (`solenoid`).

use crate::clock::CORE_HZ;
use crate::slcan::Slcan;
use cortex_m::peripheral::SYST;
use oleo_controller::BusCounters;
use oleo_controller::can::ClockSource;
use stm32f4::stm32f405::{CAN1, GPIOA, GPIOB, RCC, USART1, WWDG};

/// The driver of the bus.
pub type Bus = Slcan;

/// Says when a tick is over: the plant does.
pub struct Pace;

/// Sets the line up.
pub fn start(
    (_can, usart): (CAN1, USART1),
    (port_a, _port_b): (GPIOA, GPIOB),
    _timers: (SYST, WWDG),
    rcc: &RCC,
    source: ClockSource,
) -> Option<(Bus, Pace)> {
    let apb2_hz = match source {
        ClockSource::Crystal | ClockSource::Internal => CORE_HZ / 2,
        ClockSource::InternalWithoutPll => 16_000_000,
    };
    Some((Slcan::start(usart, port_a, rcc, apb2_hz), Pace))
}

impl Pace {
    /// Whether the plant has ended a tick.
    pub fn is_over(&mut self, bus: &mut Bus) -> bool {
        bus.is_tick_due()
    }

    /// Is called when the tick has been worked off.
    pub fn end_tick(&mut self, bus: &mut Bus, counters: &BusCounters) {
        bus.end_tick(counters.wrong_crc.saturating_add(counters.wrong_sequence));
    }
}
