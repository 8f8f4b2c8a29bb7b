//! Twelve solenoids behind twelve output pins, high = energised = open.
//!
//! Whatever ends the controller must leave the valves closed, so the output stage de-energises when it is made, when a pin reports an error,
//! and when it is dropped. A failed pin never stops the others from being switched.

use crate::valves::ValveCommand;
use embedded_hal::digital::OutputPin;

/// Number of solenoids: four corners with three valves.
pub const SOLENOIDS: usize = 12;

/// A pin could not be switched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SolenoidError {
    /// Bits of the pins that failed, as in the valve word.
    pub failed: u16,
}

impl core::fmt::Display for SolenoidError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "solenoids: output pins with bits {:#05x} could not be switched: check the output stage",
            self.failed
        )
    }
}

impl core::error::Error for SolenoidError {}

/// The output stage. Pins in the order of the valve word: front left 1, 2, 3, front right 1, ...
#[derive(Debug)]
pub struct Solenoids<P: OutputPin> {
    pins: [P; SOLENOIDS],
    latched: bool,
}

impl<P: OutputPin> Solenoids<P> {
    /// Takes the pins and de-energises them all.
    ///
    /// # Errors
    /// If a pin cannot be switched; all others are low and the stage is dropped.
    pub fn new(pins: [P; SOLENOIDS]) -> Result<Self, SolenoidError> {
        let mut stage = Self { pins, latched: false };
        stage.write(ValveCommand::SAFE)?;
        Ok(stage)
    }

    /// Drives all pins. After an error every further call only de-energises: a stage that failed once is not trusted again.
    ///
    /// # Errors
    /// The pins that could not be switched.
    pub fn drive(&mut self, command: ValveCommand) -> Result<(), SolenoidError> {
        let result = self.write(if self.latched { ValveCommand::SAFE } else { command });
        if result.is_err() {
            self.latched = true;
            self.de_energise();
        }
        result
    }

    /// All pins low, as far as they obey.
    pub fn de_energise(&mut self) {
        for pin in &mut self.pins {
            // Nothing is left to do for a pin that will not go low.
            let _ = pin.set_low();
        }
    }

    fn write(&mut self, command: ValveCommand) -> Result<(), SolenoidError> {
        let mut failed = 0;
        for (bit, pin) in self.pins.iter_mut().enumerate() {
            let mask = 1 << bit;
            let done = if command.word() & mask != 0 {
                pin.set_high()
            } else {
                pin.set_low()
            };
            if done.is_err() {
                failed |= mask;
            }
        }
        if failed == 0 {
            Ok(())
        } else {
            Err(SolenoidError { failed })
        }
    }
}

impl<P: OutputPin> Drop for Solenoids<P> {
    fn drop(&mut self) {
        self.de_energise();
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use core::cell::Cell;
    use embedded_hal::digital::{ErrorKind, ErrorType};
    use std::vec::Vec;

    #[derive(Debug)]
    struct Pin<'a> {
        level: &'a Cell<bool>,
        broken: &'a Cell<bool>,
    }

    impl Pin<'_> {
        fn set(&self, high: bool) -> Result<(), ErrorKind> {
            if self.broken.get() {
                return Err(ErrorKind::Other);
            }
            self.level.set(high);
            Ok(())
        }
    }

    impl ErrorType for Pin<'_> {
        type Error = ErrorKind;
    }

    impl OutputPin for Pin<'_> {
        fn set_low(&mut self) -> Result<(), ErrorKind> {
            self.set(false)
        }
        fn set_high(&mut self) -> Result<(), ErrorKind> {
            self.set(true)
        }
    }

    fn levels(cells: &[(Cell<bool>, Cell<bool>)]) -> u16 {
        cells
            .iter()
            .enumerate()
            .map(|(bit, (level, _))| u16::from(level.get()) << bit)
            .sum()
    }

    fn wired(cells: &[(Cell<bool>, Cell<bool>)]) -> [Pin<'_>; SOLENOIDS] {
        core::array::from_fn(|i| Pin {
            level: &cells[i].0,
            broken: &cells[i].1,
        })
    }

    fn cells(level: bool) -> Vec<(Cell<bool>, Cell<bool>)> {
        (0..SOLENOIDS).map(|_| (Cell::new(level), Cell::new(false))).collect()
    }

    #[test]
    fn pins_follow_the_word_and_fall_when_dropped() {
        let cells = cells(true);
        let mut stage = Solenoids::new(wired(&cells)).unwrap();
        assert_eq!(levels(&cells), 0);
        for word in [0x001, 0x800, 0xA5A, 0xFFF] {
            stage.drive(ValveCommand::from_word(word)).unwrap();
            assert_eq!(levels(&cells), word);
        }
        drop(stage);
        assert_eq!(levels(&cells), 0);
    }

    #[test]
    fn a_failed_pin_brings_all_others_down_for_good() {
        let cells = cells(false);
        let mut stage = Solenoids::new(wired(&cells)).unwrap();
        stage.drive(ValveCommand::from_word(0x0F0)).unwrap();
        cells[2].1.set(true);
        let error = stage.drive(ValveCommand::SOFT).unwrap_err();
        assert_eq!(error.failed, 0b100);
        assert_eq!(levels(&cells), 0);
        cells[2].1.set(false);
        stage.drive(ValveCommand::SOFT).unwrap();
        assert_eq!(levels(&cells), 0, "not trusted again");
    }
}
