//! The emulated board: SysTick as an instruction counter, semihosting as a console.
//!
//! QEMU with `-icount shift=0` advances its clock by 1 ns an instruction, and SysTick counts the board's 25 MHz, so one
//! count is 40 instructions, the same in every run.

use cortex_m::peripheral::{Peripherals, SYST, syst::SystClkSource};
use cortex_m_semihosting::debug;

pub use cortex_m_semihosting::hprintln as say;

/// Instructions of one count.
pub const INSTRUCTIONS_A_COUNT: u32 = 40;

const FULL: u32 = 0x00FF_FFFF;

/// A counter that runs.
pub struct Counter;

impl Counter {
    /// Starts it; `None` if it was taken before.
    pub fn start() -> Option<Self> {
        let mut systick = Peripherals::take()?.SYST;
        systick.set_clock_source(SystClkSource::Core);
        systick.set_reload(FULL);
        systick.clear_current();
        systick.enable_counter();
        Some(Counter)
    }

    /// Instructions `work` took, to one count.
    pub fn instructions(&self, work: impl FnOnce()) -> u32 {
        let before = SYST::get_current();
        work();
        (before.wrapping_sub(SYST::get_current()) & FULL) * INSTRUCTIONS_A_COUNT
    }
}

/// Ends the emulation, with exit status 0 if `well`.
pub fn leave(well: bool) -> ! {
    debug::exit(if well { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {
        cortex_m::asm::nop();
    }
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    say!("panic: {}", info);
    leave(false)
}
