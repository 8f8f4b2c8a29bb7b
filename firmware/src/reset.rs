//! What a reset must not wipe out: the latched safe state, and why the board was reset.
//!
//! A controller that has latched stays latched until somebody switches the supply off and on. Otherwise the watchdog, or a fault handler's
//! reset, would end it by itself. The latch is kept in the first backup register, which every reset but that of the supply leaves as it
//! is (RM0090, section 26.6.20), together with its complement, so that no other content is taken for a latch.

use oleo_controller::FaultCode;
use stm32f4::stm32f405::{PWR, RCC, RTC};

/// What stands in the upper half of the register with a latch.
const MARK: u32 = 0x1A7C_0000;

/// The memory of the latch.
pub struct Memory {
    register: RTC,
    kept: bool,
}

/// Why the board was reset: bits 25 to 31 of `RCC_CSR`, the lowest first: brown-out, reset pin, supply, software, independent watchdog,
/// window watchdog, low power. Several may be set; the next reset begins without them.
pub fn causes(rcc: &RCC) -> u32 {
    let causes = rcc.csr().read().bits() >> 25;
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    causes
}

/// Whether the supply was switched on.
pub fn is_power_on(causes: u32) -> bool {
    causes & 1 << 2 != 0
}

impl Memory {
    /// The memory, and the cause of a latch before the reset. Switching the supply on clears it.
    pub fn open(register: RTC, rcc: &RCC, pwr: &PWR, power_on: bool) -> (Self, Option<FaultCode>) {
        rcc.apb1enr().modify(|_, w| w.pwren().enabled());
        // Without this bit the backup registers cannot be written.
        pwr.cr().modify(|_, w| w.dbp().set_bit());
        let mut memory = Self { register, kept: false };
        if power_on {
            memory.write(0);
        }
        let cause = read(memory.register.bkpr(0).read().bits());
        memory.kept = cause.is_some();
        (memory, cause)
    }

    /// Keeps a latch. Only the first one is written.
    pub fn keep(&mut self, cause: FaultCode) {
        if !core::mem::replace(&mut self.kept, true) {
            let cause = cause.raw();
            self.write(MARK | u32::from(!cause) << 8 | u32::from(cause));
        }
    }

    fn write(&mut self, word: u32) {
        #[allow(unsafe_code)]
        // SAFETY: a backup register may hold any pattern.
        self.register.bkpr(0).write(|w| unsafe { w.bits(word) });
    }
}

/// The cause of the latch that a word stands for.
fn read(word: u32) -> Option<FaultCode> {
    let [cause, inverse, ..] = word.to_le_bytes();
    (word & 0xFFFF_0000 == MARK && inverse == !cause).then_some(())?;
    // A code that this image does not know is a latch all the same.
    Some(FaultCode::from_repr(cause).unwrap_or(FaultCode::Internal))
}
