//! The independent watchdog. It resets the board if a tick is not completed in time.
//!
//! It runs from its own 32 kHz oscillator (17 to 47 kHz over the part's range, datasheet table 38), so the nominal
//! 20 ms, four ticks, are 14 to 38 ms on a given board. Once started it cannot be stopped, only fed.

use stm32f4::stm32f405::{IWDG, iwdg::kr::KEY};

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
