//! Drives twelve solenoids on one port: PE4 to PE15, high = energised, each with a pull-down resistor on the board.
//!
//! They share a port, so that one write turns all of them off wherever something goes wrong. At reset the pins are inputs,
//! and the resistors keep the valves closed, which is a stiff spring and high damping.

use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, OutputPin};
use oleo_controller::ValveCommand;
use oleo_interface::{Corners, StrutValves};
use stm32f4::stm32f405::{GPIOE, RCC};

/// Pin of the solenoid with the lowest bit in the command word.
const FIRST_PIN: u8 = 4;
const PINS: core::ops::Range<u8> = FIRST_PIN..16;
const ALL: u32 = (ValveCommand::SOFT.word() as u32) << FIRST_PIN;

/// One input of the solenoid drivers. It is off until it is switched on.
pub struct Solenoid {
    mask: u32,
}

/// Makes the port's twelve pins outputs and hands out one for each valve, in the order of the command word's bits. Takes
/// the port, so that nobody else has it.
pub fn take(_port: GPIOE, rcc: &RCC) -> Corners<StrutValves<Solenoid>> {
    rcc.ahb1enr().modify(|_, w| w.gpioeen().enabled());
    all_off();
    let port = registers();
    for pin in PINS {
        port.moder().modify(|_, w| w.moder(pin).output());
    }
    Corners::from_fn(|corner| {
        StrutValves::from_fn(|valve| Solenoid {
            mask: u32::from(ValveCommand::SAFE.with(corner, valve, true).word()) << FIRST_PIN,
        })
    })
}

/// Turns all twelve off with a single write. It needs no state and cannot fail, so fault handlers use it too.
pub fn all_off() {
    write(ALL << 16);
}

impl ErrorType for Solenoid {
    type Error = Infallible;
}

impl OutputPin for Solenoid {
    fn set_low(&mut self) -> Result<(), Infallible> {
        write(self.mask << 16);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        write(self.mask);
        Ok(())
    }
}

/// Writes the bit set/reset register, which changes only the pins whose bits are one. Nothing is read back, so there is no race
/// with a handler.
fn write(bits: u32) {
    #[allow(unsafe_code)]
    // SAFETY: every pattern is valid in BSRR; only the masks of PE4..PE15 are ever passed.
    registers().bsrr().write(|w| unsafe { w.bits(bits) });
}

fn registers() -> &'static stm32f4::stm32f405::gpioi::RegisterBlock {
    #[allow(unsafe_code)]
    // SAFETY: a fixed, always mapped peripheral; each pin's bits are written by its `Solenoid` or cleared by `all_off`.
    unsafe {
        &*GPIOE::ptr()
    }
}
