//! Sets up the clock tree: CAN needs the accuracy of the crystal, and the tick needs a fast processor.
//!
//! 8 MHz crystal -> PLL -> 168 MHz core, 42 MHz APB1 (CAN), 84 MHz APB2 (RM0090, section 7; flash wait states table 10).
//!
//! No wait is without an end. If the crystal does not start, the PLL runs from the internal oscillator (HSI, 16 MHz, 1 % at room
//! temperature), which a bus of 500 kbit/s with short lines may or may not tolerate; the board reports it. If the PLL does not lock
//! either, the core stays at 16 MHz, where the bit rate of the bus cannot be made.

use crate::watchdog::Watchdog;
use oleo_controller::can::ClockSource;
use stm32f4::stm32f405::{FLASH, PWR, RCC};

/// Frequency of the core clock, Hz.
pub const CORE_HZ: u32 = 168_000_000;

/// Clock of the PLL's phase comparison, Hz.
const COMPARISON_HZ: u32 = 2_000_000;
const PLL_N: u32 = 168;
const CRYSTAL_M: u32 = 8_000_000 / COMPARISON_HZ;
const INTERNAL_M: u32 = 16_000_000 / COMPARISON_HZ;
/// 168 MHz at 2.7 V to 3.6 V: five wait states.
const FLASH_WAIT_STATES: u8 = 5;
/// Longest wait for an oscillator, the PLL or the switch between clocks, in reads of the register: some 5 ms at 16 MHz and ten cycles
/// a read. A crystal starts within 2 ms (datasheet, table 41), the PLL within 0.3 ms. The watchdog runs already, and is fed between two
/// waits.
const PATIENCE: u32 = 8_000;

const _: () = assert!(COMPARISON_HZ * PLL_N / 2 == CORE_HZ);

/// Waits until something is so, with an end; returns whether it is.
pub fn is_soon(ready: impl Fn() -> bool) -> bool {
    (0..PATIENCE).any(|_| ready())
}

/// Switches the core to the PLL of the crystal, or to the best that there is.
pub fn start(rcc: &RCC, flash: &FLASH, pwr: &PWR, watchdog: &mut Watchdog) -> ClockSource {
    rcc.apb1enr().modify(|_, w| w.pwren().enabled());
    pwr.cr().modify(|_, w| w.vos().set_bit());

    rcc.cr().modify(|_, w| w.hseon().on());
    let crystal = is_soon(|| rcc.cr().read().hserdy().is_ready());
    watchdog.feed();

    #[allow(unsafe_code)]
    rcc.pllcfgr().write(|w| {
        if crystal {
            w.pllsrc().hse();
        } else {
            w.pllsrc().hsi();
        }
        w.pllp().div2();
        let m = if crystal { CRYSTAL_M } else { INTERNAL_M };
        // SAFETY: M = 4 or 8 and N = 168 are within the limits of RM0090, section 7.3.2 (2..63, 50..432).
        unsafe { w.pllm().bits(m as u8).plln().bits(PLL_N as u16) }
    });
    rcc.cr().modify(|_, w| w.pllon().on());
    if !is_soon(|| rcc.cr().read().pllrdy().is_ready()) {
        return ClockSource::InternalWithoutPll;
    }
    watchdog.feed();
    flash.acr().write(|w| {
        w.prften().set_bit();
        w.icen().set_bit();
        w.dcen().set_bit();
        w.latency().set(FLASH_WAIT_STATES)
    });
    rcc.cfgr().modify(|_, w| {
        w.hpre().div1();
        w.ppre1().div4();
        w.ppre2().div2();
        w.sw().pll()
    });
    if !is_soon(|| rcc.cfgr().read().sws().is_pll()) {
        return ClockSource::InternalWithoutPll;
    }
    if crystal {
        ClockSource::Crystal
    } else {
        ClockSource::Internal
    }
}
