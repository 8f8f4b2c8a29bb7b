//! Sets up the clock tree: CAN needs the accuracy of the crystal, and the tick needs a fast processor.
//!
//! 8 MHz crystal -> PLL -> 168 MHz core, 42 MHz APB1 (CAN), 84 MHz APB2 (RM0090, section 7; flash wait states table 10).

use stm32f4::stm32f405::{FLASH, PWR, RCC};

/// Frequency of the core clock, Hz.
pub const CORE_HZ: u32 = CRYSTAL_HZ / PLL_M * PLL_N / 2;
/// Clock of the CAN peripheral (APB1), Hz.
pub const APB1_HZ: u32 = CORE_HZ / 4;

const CRYSTAL_HZ: u32 = 8_000_000;
const PLL_M: u32 = 4;
const PLL_N: u32 = 168;
/// 168 MHz at 2.7 V to 3.6 V: five wait states.
const FLASH_WAIT_STATES: u8 = 5;

const _: () = assert!(CORE_HZ == 168_000_000 && CRYSTAL_HZ / PLL_M == 2_000_000);

/// Switches the core to the PLL of the crystal. The watchdog must run already: if the crystal is broken, the board then resets
/// again and again with the solenoids off, instead of hanging.
pub fn run_from_crystal(rcc: &RCC, flash: &FLASH, pwr: &PWR) {
    rcc.apb1enr().modify(|_, w| w.pwren().enabled());
    pwr.cr().modify(|_, w| w.vos().set_bit());

    rcc.cr().modify(|_, w| w.hseon().on());
    while rcc.cr().read().hserdy().is_not_ready() {}

    #[allow(unsafe_code)]
    rcc.pllcfgr().write(|w| {
        w.pllsrc().hse();
        w.pllp().div2();
        // SAFETY: M = 4 and N = 168 are within the limits of RM0090, section 7.3.2 (2..63, 50..432).
        unsafe { w.pllm().bits(PLL_M as u8).plln().bits(PLL_N as u16) }
    });
    rcc.cr().modify(|_, w| w.pllon().on());
    while rcc.cr().read().pllrdy().is_not_ready() {}

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
    while !rcc.cfgr().read().sws().is_pll() {}
}
