//! Drives twelve solenoids on one port: PE4 to PE15, high = energised, each with a pull-down resistor on the board.
//!
//! They share a port, so that one write turns all of them off wherever something goes wrong. At reset the pins are inputs,
//! and the resistors keep the valves closed, which is a stiff spring and high damping.

use embedded_hal::digital::{ErrorKind, ErrorType, OutputPin};
use oleo_controller::ValveCommand;
use oleo_interface::{Corners, StrutValves};
use stm32f4::stm32f405::{GPIOE, RCC};

/// Pin of the solenoid with the lowest bit in the command word.
const FIRST_PIN: u8 = 4;
const PINS: core::ops::Range<u8> = FIRST_PIN..16;
const ALL: u32 = (ValveCommand::SOFT.word() as u32) << FIRST_PIN;

/// One input of the solenoid drivers. It is off until it is switched on.
///
/// Each call reads the pin first: it must be where the last call has put it. By then 5 ms have passed, so that the level is what the
/// pin really has, and not what was just written. A pin that is shorted, or whose driver holds it, is found in the tick after; a broken
/// solenoid or wire is not.
pub struct Solenoid {
    pin: u8,
    high: bool,
}

impl Solenoid {
    fn set(&mut self, high: bool) -> Result<(), ErrorKind> {
        let mask = 1_u32.wrapping_shl(self.pin.into());
        // The emulator has no ports: they read as zero.
        let obeyed = cfg!(feature = "slcan") || is_high(mask) == self.high;
        write(if high { mask } else { mask << 16 });
        self.high = high;
        if obeyed { Ok(()) } else { Err(ErrorKind::Other) }
    }
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
            pin: FIRST_PIN + ValveCommand::bit(corner, valve) as u8,
            high: false,
        })
    })
}

/// Turns all twelve off with a single write. It needs no state and cannot fail, so fault handlers use it too.
pub fn all_off() {
    write(ALL << 16);
}

impl ErrorType for Solenoid {
    type Error = ErrorKind;
}

impl OutputPin for Solenoid {
    fn set_low(&mut self) -> Result<(), ErrorKind> {
        self.set(false)
    }

    fn set_high(&mut self) -> Result<(), ErrorKind> {
        self.set(true)
    }
}

/// Writes the bit set/reset register, which changes only the pins whose bits are one, so there is no race with a handler.
fn write(bits: u32) {
    #[allow(unsafe_code)]
    // SAFETY: every pattern is valid in BSRR; only the masks of PE4..PE15 are ever passed.
    registers().bsrr().write(|w| unsafe { w.bits(bits) });
}

/// Whether a pin is high.
fn is_high(mask: u32) -> bool {
    registers().idr().read().bits() & mask != 0
}

fn registers() -> &'static stm32f4::stm32f405::gpioi::RegisterBlock {
    #[allow(unsafe_code)]
    // SAFETY: a fixed, always mapped peripheral; each pin's bits are written by its `Solenoid` or cleared by `all_off`.
    unsafe {
        &*GPIOE::ptr()
    }
}
