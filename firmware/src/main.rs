//! The suspension controller on an STM32F405: it starts in a safe state and then runs a tick every 5 ms.
//!
//! ```text
//!   reset -> solenoids off -> watchdog -> clock -> CAN -> +-> take what the bus brings -+
//!                                                         |                            | 5 ms over?
//!                                                         +-- feed <- drive, send <- tick +
//! ```
//!
//! Nothing waits, and there are no interrupts: the tick takes well under 100 us, and the three-deep receive FIFO of the
//! peripheral lasts for 0.6 ms at 500 kbit/s. A loop that stops for any reason no longer feeds the watchdog, which then
//! resets the board. At reset, and on any fault, the solenoids are off, which is a stiff spring and high damping.
#![no_std]
#![no_main]

mod can;
mod clock;
mod fault;
mod solenoid;
mod watchdog;

use cortex_m::peripheral::{SCB, SYST, syst::SystClkSource};
use cortex_m_rt::entry;
use oleo_controller::{Configuration, Node, Port, Solenoids};
use oleo_interface::tick::TICK_MS;
use stm32f4::stm32f405::Peripherals;

/// The vehicle's suspension bus, bit/s.
const BIT_RATE: u32 = 500_000;
/// Core clock cycles of a tick, less one, as SysTick wants it.
const TICK_RELOAD: u32 = clock::CORE_HZ / 1000 * TICK_MS - 1;

const _: () = assert!(TICK_RELOAD < 1 << 24, "SysTick has 24 bits");
const _: () = assert!(
    clock::APB1_HZ.is_multiple_of(BIT_RATE * can::QUANTA),
    "the bit rate must divide the peripheral's clock: other nodes do not tolerate a bit rate that is off by one per cent"
);

#[entry]
fn main() -> ! {
    let (Some(board), Some(core)) = (Peripherals::take(), cortex_m::Peripherals::take()) else {
        SCB::sys_reset()
    };
    let Ok(mut solenoids) = Solenoids::new(solenoid::take(board.GPIOE, &board.RCC)) else {
        SCB::sys_reset()
    };
    let mut watchdog = watchdog::Watchdog::start(board.IWDG);
    clock::run_from_crystal(&board.RCC, &board.FLASH, &board.PWR);
    let can = can::Can::start(board.CAN1, board.GPIOB, &board.RCC, clock::APB1_HZ, BIT_RATE);
    let mut port = Port::new(can, Node::new(Configuration::defender110()));
    let mut systick = core.SYST;
    start_ticks(&mut systick);

    loop {
        port.poll();
        if systick.has_wrapped() {
            let outputs = port.tick();
            if solenoids.drive(outputs.command).is_err() {
                port.report_solenoid_failure();
            }
            watchdog.feed();
            #[cfg(feature = "deliberate-panic")]
            assert!(port.counters().dropped == 0);
        }
    }
}

fn start_ticks(systick: &mut SYST) {
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(TICK_RELOAD);
    systick.clear_current();
    systick.enable_counter();
}
