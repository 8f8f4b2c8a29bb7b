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
//! resets the board, as it does if the flash is not what was built (`image`). At reset, and on any fault, the solenoids are off, which is a stiff spring and high damping.
//!
//! With the feature `slcan` the same image speaks CAN as text over USART1, and the frames at the other end of the line say when 5 ms
//! are over (`slcan`): that image runs on an emulated board.
#![no_std]
#![no_main]

#[cfg(not(feature = "slcan"))]
mod can;
mod clock;
mod fault;
mod frame;
mod image;
mod report;
mod reset;
#[cfg(feature = "slcan")]
mod slcan;
mod solenoid;
#[cfg_attr(feature = "slcan", path = "emulated.rs")]
#[cfg_attr(not(feature = "slcan"), path = "vehicle.rs")]
mod surroundings;
mod watchdog;

use cortex_m::{peripheral::SCB, singleton};
use cortex_m_rt::entry;
use oleo_controller::can::{ClockSource, ImageState};
use oleo_controller::{Configuration, FaultCode, Mode, Node, Port, Solenoids};
use report::BOARD;
use stm32f4::stm32f405::Peripherals;

type Controller = Port<surroundings::Bus>;

#[entry]
fn main() -> ! {
    let (Some(board), Some(core)) = (Peripherals::take(), cortex_m::Peripherals::take()) else {
        SCB::sys_reset()
    };
    // Borrowed, because moving it out of the result would take the library's copying of memory into the image.
    let mut solenoids = Solenoids::new(solenoid::take(board.GPIOE, &board.RCC));
    let Ok(solenoids) = &mut solenoids else {
        SCB::sys_reset()
    };
    let mut watchdog = watchdog::Watchdog::start(board.IWDG);
    let causes = reset::causes(&board.RCC);
    let (memory, latch) = reset::Memory::open(board.RTC, &board.RCC, &board.PWR, reset::is_power_on(causes));
    let source = clock::start(&board.RCC, &board.FLASH, &board.PWR, &mut watchdog);
    // A wrong image must not drive: the watchdog resets the board, and it is checked again.
    let Some(image) = image::check(|| watchdog.feed()) else {
        loop {
            cortex_m::asm::wfi();
        }
    };
    let (buses, ports) = ((board.CAN1, board.USART1), (board.GPIOA, board.GPIOB));
    let timers = (core.SYST, board.WWDG);
    let Some((bus, pace)) = surroundings::start(buses, ports, timers, &board.RCC, source) else {
        SCB::sys_reset()
    };
    report::set(&BOARD.reset_causes, causes);
    report::set(&BOARD.clock_source, source as u32);
    report::set(&BOARD.latch_before_reset, latch.map_or(0, |cause| cause.raw().into()));
    report::set(
        &BOARD.brown_out_level,
        board.FLASH.optcr().read().bor_lev().bits().into(),
    );
    report::set(&BOARD.image, image as u32);
    let Some(port) = controller(bus, latch) else {
        SCB::sys_reset()
    };
    run(port, pace, solenoids, watchdog, memory, (source, image))
}

/// The controller, in a static: it is large, and the stack of the loop is to be small.
#[inline(never)]
fn controller(bus: surroundings::Bus, latch: Option<FaultCode>) -> Option<&'static mut Controller> {
    let port = singleton!(: Controller = Port::new(bus, Node::new(Configuration::defender110())))?;
    if let Some(cause) = latch {
        port.latch(cause);
    }
    Some(port)
}

/// Ticks for ever.
#[inline(never)]
fn run(
    port: &mut Controller,
    mut pace: surroundings::Pace,
    solenoids: &mut Solenoids<solenoid::Solenoid>,
    mut watchdog: watchdog::Watchdog,
    mut memory: reset::Memory,
    start: (ClockSource, ImageState),
) -> ! {
    loop {
        port.poll();
        if pace.is_over(port.can_mut()) {
            port.report_board(report::message(start));
            let outputs = port.tick();
            if solenoids.drive(outputs.command).is_err() {
                port.report_solenoid_failure();
            }
            if outputs.mode == Mode::Latched {
                memory.keep(outputs.fault);
            }
            let heard = port.node().counters();
            pace.end_tick(port.can_mut(), &heard);
            let counters = port.counters();
            report::set(&BOARD.port_errors, counters.errors);
            report::set(&BOARD.port_dropped, counters.dropped);
            watchdog.feed();
            #[cfg(feature = "deliberate-panic")]
            assert!(port.counters().dropped == 0);
        }
    }
}
