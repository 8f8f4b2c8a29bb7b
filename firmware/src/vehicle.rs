//! The surroundings of the image for the vehicle: bxCAN, and a tick every 5 ms.

use crate::can::{Can, QUANTA};
use crate::clock::CORE_HZ;
use crate::report::{self, BOARD};
use crate::watchdog::WindowWatchdog;
use cortex_m::peripheral::{SYST, syst::SystClkSource};
use oleo_controller::BusCounters;
use oleo_controller::can::ClockSource;
use oleo_interface::tick::TICK_MS;
use stm32f4::stm32f405::{CAN1, GPIOA, GPIOB, RCC, USART1, WWDG};

/// Clock of the CAN peripheral (APB1), Hz.
const APB1_HZ: u32 = CORE_HZ / 4;
/// The vehicle's suspension bus, bit/s.
const BIT_RATE: u32 = 500_000;
/// Core clock cycles of a tick, less one, as SysTick wants it.
const TICK_RELOAD: u32 = CORE_HZ / 1000 * TICK_MS - 1;

const _: () = assert!(TICK_RELOAD < 1 << 24, "SysTick has 24 bits");
const _: () = assert!(
    APB1_HZ.is_multiple_of(BIT_RATE * QUANTA),
    "the bit rate must divide the peripheral's clock: other nodes do not tolerate a bit rate that is off by one per cent"
);

/// The driver of the bus.
pub type Bus = Can;

/// Says when a tick is over: SysTick does.
pub struct Pace {
    systick: SYST,
    window: WindowWatchdog,
    /// Whether the next tick was due before the last one had been worked off.
    late: bool,
    /// Whether this tick is that one: it ends too early for the window.
    catching_up: bool,
    was_off: bool,
}

/// Joins the bus and starts the ticks; nothing without the PLL, whose clock both need.
pub fn start(
    (can, _usart): (CAN1, USART1),
    (_port_a, port_b): (GPIOA, GPIOB),
    (mut systick, window): (SYST, WWDG),
    rcc: &RCC,
    source: ClockSource,
) -> Option<(Bus, Pace)> {
    if source == ClockSource::InternalWithoutPll {
        return None;
    }
    let can = Can::start(can, port_b, rcc, APB1_HZ, BIT_RATE)?;
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(TICK_RELOAD);
    systick.clear_current();
    systick.enable_counter();
    let window = WindowWatchdog::start(window, rcc);
    let pace = Pace {
        systick,
        window,
        late: false,
        catching_up: false,
        was_off: false,
    };
    Some((can, pace))
}

impl Pace {
    /// Whether 5 ms are over since it last was so.
    pub fn is_over(&mut self, _bus: &mut Bus) -> bool {
        self.catching_up = core::mem::take(&mut self.late);
        self.catching_up || self.systick.has_wrapped()
    }

    /// Is called when the tick has been worked off: reports overruns and the errors of the bus.
    pub fn end_tick(&mut self, bus: &mut Bus, _counters: &BusCounters) {
        if !self.catching_up {
            self.window.feed();
        }
        if self.systick.has_wrapped() {
            self.late = true;
            report::count(&BOARD.overruns);
        }
        let errors = bus.errors();
        report::set(&BOARD.bus_errors, errors.bits);
        if errors.is_off && !self.was_off {
            report::count(&BOARD.bus_off);
        }
        self.was_off = errors.is_off;
    }
}
