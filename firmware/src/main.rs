//! The suspension controller on an STM32F405: reset to the first safe state, then a tick every 5 ms for ever.
//!
//! ```text
//!   reset -> solenoids off -> watchdog -> clock -> CAN -> +-> take what the bus brings -+
//!                                                         |                            | 5 ms over?
//!                                                         +-- feed <- drive, send <- tick +
//! ```
//!
//! Nothing waits and nothing interrupts: the tick takes well under 100 us, the three-deep receive FIFO of the peripheral
//! lasts for 0.6 ms at 500 kbit/s. A loop that stops for any reason stops feeding the watchdog, which resets the board;
//! at reset, and on any fault, the solenoids are off (stiff spring, high damping).
#![no_std]
#![no_main]

mod can;
mod clock;
mod fault;
mod solenoid;
mod watchdog;

use cortex_m::peripheral::{SCB, SYST, syst::SystClkSource};
use cortex_m_rt::entry;
use embedded_can::{Frame as _, Id, StandardId, nb::Can as _};
use embedded_hal::digital::OutputPin as _;
use heapless::Deque;
use oleo_controller::{Configuration, Node, ValveCommand, timing::TICK_MS};
use solenoid::Solenoid;
use stm32f4::stm32f405::Peripherals;

/// The vehicle's suspension bus, bit/s.
const BIT_RATE: u32 = 500_000;
/// Frames waiting for a mailbox: two ticks' worth. Older ones give way, a late command being worse than none.
const SEND_QUEUE: usize = 4;
/// Core clock cycles of a tick, less one, as SysTick wants it.
const TICK_RELOAD: u32 = clock::CORE_HZ / 1000 * TICK_MS - 1;

const _: () = assert!(TICK_RELOAD < 1 << 24, "SysTick has 24 bits");

#[entry]
fn main() -> ! {
    let (Some(board), Some(core)) = (Peripherals::take(), cortex_m::Peripherals::take()) else {
        SCB::sys_reset()
    };
    let mut solenoids = solenoid::take(board.GPIOE, &board.RCC);
    let mut watchdog = watchdog::Watchdog::start(board.IWDG);
    clock::run_from_crystal(&board.RCC, &board.FLASH, &board.PWR);
    let mut can = can::Can::start(board.CAN1, board.GPIOB, &board.RCC, clock::APB1_HZ, BIT_RATE);
    let mut systick = core.SYST;
    start_ticks(&mut systick);

    let mut node = Node::new(Configuration::defender110());
    let mut to_send: Deque<can::Frame, SEND_QUEUE> = Deque::new();
    loop {
        // An overrun has lost a frame; the counters in the next ones tell the node.
        if let Ok(frame) = can.receive()
            && let Id::Standard(id) = frame.id()
        {
            #[cfg(feature = "deliberate-panic")]
            assert!(frame.dlc() == 8);
            node.receive(id.as_raw(), frame.data());
        }
        if let Some(frame) = to_send.front()
            && can.transmit(frame).is_ok()
        {
            to_send.pop_front();
        }
        if systick.has_wrapped() {
            let (outputs, frames) = node.tick();
            drive(&mut solenoids, outputs.command);
            for frame in frames {
                let Some(id) = StandardId::new(frame.id) else { continue };
                let Some(frame) = can::Frame::new(id, &frame.data) else {
                    continue;
                };
                if to_send.is_full() {
                    to_send.pop_front();
                }
                let _ = to_send.push_back(frame); // there is room now
            }
            watchdog.feed();
        }
    }
}

fn start_ticks(systick: &mut SYST) {
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(TICK_RELOAD);
    systick.clear_current();
    systick.enable_counter();
}

fn drive(solenoids: &mut [Solenoid; solenoid::COUNT], command: ValveCommand) {
    for (bit, solenoid) in solenoids.iter_mut().enumerate() {
        // These pins cannot fail (their error has no value).
        let Ok(()) = if command.word() & (1 << bit) != 0 {
            solenoid.set_high()
        } else {
            solenoid.set_low()
        };
    }
}
