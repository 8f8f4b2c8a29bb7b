//! Two watchdogs. The independent one resets the board if a tick is not completed in time, whatever becomes of the clocks. The window
//! watchdog resets it also if ticks follow each other too fast, as when a fault in the timer or a jump in the program feeds both.
//!
//! The independent one runs from its own 32 kHz oscillator (17 to 47 kHz over the part's range, datasheet table 38), so the nominal
//! 20 ms, four ticks, are 14 to 38 ms on a given board. Once started it cannot be stopped, only fed.

use stm32f4::stm32f405::{IWDG, RCC, WWDG, iwdg::kr::KEY};

/// Counts of the watchdog's 8 kHz clock: 20 ms.
const RELOAD: u16 = 160 - 1;

/// The independent watchdog, once it is running.
pub struct Watchdog {
    registers: IWDG,
}

impl Watchdog {
    /// Starts it. From here on every tick must complete in time.
    pub fn start(registers: IWDG) -> Self {
        registers.kr().write(|w| w.key().variant(KEY::Start));
        registers.kr().write(|w| w.key().variant(KEY::Unlock));
        registers.pr().write(|w| w.pr().divide_by4());
        registers.rlr().write(|w| w.rl().set(RELOAD));
        // Both values take effect with the slow clock; until then the longest period holds, which is the default.
        while registers.sr().read().bits() != 0 {}
        let mut watchdog = Watchdog { registers };
        watchdog.feed();
        watchdog
    }

    /// Says that a tick has completed, or a step of the start.
    pub fn feed(&mut self) {
        self.registers.kr().write(|w| w.key().variant(KEY::Feed));
    }
}

/// Counter after a feed. At 0x3F the board is reset: after 12 counts.
const WINDOW_START: u8 = 0x40 + 11;
/// Counts that must have passed before it is fed.
const WINDOW_CLOSED: u8 = 4;

/// The window watchdog, once it is running. Its clock is APB1 (42 MHz) divided by 4096 and 8 (RM0090,
/// section 22.4), so that a count is 0.78 ms: it wants to be fed not before 2.3 to 3.1 ms, and not after 8.6 to
/// 9.4 ms, depending on where in a count it was fed.
#[cfg_attr(
    feature = "slcan",
    allow(
        dead_code,
        reason = "the emulated board's ticks take the time that the emulator takes"
    )
)]
pub struct WindowWatchdog {
    registers: WWDG,
}

#[cfg_attr(
    feature = "slcan",
    allow(
        dead_code,
        reason = "the emulated board's ticks take the time that the emulator takes"
    )
)]
impl WindowWatchdog {
    /// Starts it. From here on ticks must come as often as they should.
    pub fn start(registers: WWDG, rcc: &RCC) -> Self {
        const { assert!(WINDOW_START - WINDOW_CLOSED > 0x40) };
        rcc.apb1enr().modify(|_, w| w.wwdgen().enabled());
        registers
            .cfr()
            .write(|w| w.wdgtb().div8().w().set(WINDOW_START - WINDOW_CLOSED));
        let mut watchdog = Self { registers };
        watchdog.feed();
        watchdog
    }

    /// Says that a tick has ended.
    pub fn feed(&mut self) {
        self.registers.cr().write(|w| w.wdga().enabled().t().set(WINDOW_START));
    }
}
