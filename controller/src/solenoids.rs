//! Twelve solenoids behind twelve output pins: a high pin energises the solenoid and opens the valve.
//!
//! Whatever ends the controller must leave the valves closed. So the output stage de-energises all of them when it is made, when a
//! pin reports an error, and when it is dropped. A failed pin never keeps the others from being switched.

use embedded_hal::digital::OutputPin;
use oleo_interface::{Corners, StrutValves};

use crate::valves::ValveCommand;

/// Some output pins could not be switched. The message names their valves. See [`Solenoids`] for an example.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SolenoidError {
    /// The valves whose pins failed, as bits of [`ValveCommand::word`].
    pub failed: u16,
}

impl core::fmt::Display for SolenoidError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("solenoids: the output pins of")?;
        let mut before = "";
        for (corner, strut) in ValveCommand::from_word(self.failed).corners().iter() {
            for (valve, failed) in strut.iter() {
                if *failed {
                    write!(f, "{before} {} valve {}", corner.name(), valve.number())?;
                    before = ",";
                }
            }
        }
        f.write_str(" could not be switched: check the output stage")
    }
}

impl core::error::Error for SolenoidError {}

/// The output stage: one pin for each valve.
///
/// ```
/// use embedded_hal::digital::{ErrorKind, ErrorType, OutputPin};
/// use oleo_controller::{Corners, Solenoids, StrutValves, ValveCommand};
///
/// struct BrokenPin;
/// impl ErrorType for BrokenPin {
///     type Error = ErrorKind;
/// }
/// impl OutputPin for BrokenPin {
///     fn set_low(&mut self) -> Result<(), ErrorKind> {
///         Ok(())
///     }
///     fn set_high(&mut self) -> Result<(), ErrorKind> {
///         Err(ErrorKind::Other)
///     }
/// }
///
/// let pins = Corners::from_fn(|_| StrutValves::from_fn(|_| BrokenPin));
/// let mut solenoids = Solenoids::new(pins).expect("these pins can be low");
/// let error = solenoids.drive(ValveCommand::from_word(0b100)).unwrap_err();
/// assert_eq!(
///     error.to_string(),
///     "solenoids: the output pins of front-left valve 3 could not be switched: check the output stage"
/// );
/// // Now it only de-energises.
/// assert!(solenoids.drive(ValveCommand::SOFT).is_ok());
/// ```
#[derive(Debug)]
// The pins first and whole words, which a small image copies without a call.
#[repr(C, align(4))]
pub struct Solenoids<P: OutputPin> {
    pins: Corners<StrutValves<P>>,
    latched: bool,
}

impl<P: OutputPin> Solenoids<P> {
    /// Takes the pins and de-energises all of them.
    ///
    /// # Errors
    /// If a pin cannot be switched. All others are low then, and the stage is dropped.
    pub fn new(pins: Corners<StrutValves<P>>) -> Result<Self, SolenoidError> {
        let mut stage = Self { pins, latched: false };
        stage.write(ValveCommand::SAFE)?;
        Ok(stage)
    }

    /// Drives all pins. After an error every further call only de-energises, because a stage that failed once is not trusted
    /// again.
    ///
    /// # Errors
    /// Names the pins that could not be switched. All others are low then.
    pub fn drive(&mut self, command: ValveCommand) -> Result<(), SolenoidError> {
        let result = self.write(if self.latched { ValveCommand::SAFE } else { command });
        if result.is_err() {
            self.latched = true;
            self.de_energise();
        }
        result
    }

    /// Sets all pins low. A pin that cannot be switched is passed over.
    pub fn de_energise(&mut self) {
        for strut in self.pins.values_mut() {
            for pin in strut.each_mut().into_array() {
                // Nothing more can be done for a pin that does not go low.
                let _ = fails(pin, false);
            }
        }
    }

    fn write(&mut self, command: ValveCommand) -> Result<(), SolenoidError> {
        let (mut failed, mut bit) = (0, 1);
        for pins in self.pins.values_mut() {
            for pin in pins.each_mut().into_array() {
                if fails(pin, command.word() & bit != 0) {
                    failed |= bit;
                }
                bit <<= 1;
            }
        }
        if failed == 0 {
            Ok(())
        } else {
            Err(SolenoidError { failed })
        }
    }
}

/// Switches a pin; returns whether it fails. There are twelve, and one copy of the driver's code is enough.
#[inline(never)]
fn fails<P: OutputPin>(pin: &mut P, high: bool) -> bool {
    if high { pin.set_high() } else { pin.set_low() }.is_err()
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
    use std::string::ToString;
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

    fn wired(cells: &[(Cell<bool>, Cell<bool>)]) -> Corners<StrutValves<Pin<'_>>> {
        Corners::from_fn(|corner| {
            StrutValves::from_fn(|valve| {
                let (level, broken) = &cells[ValveCommand::bit(corner, valve)];
                Pin { level, broken }
            })
        })
    }

    fn cells(level: bool) -> Vec<(Cell<bool>, Cell<bool>)> {
        (0..12).map(|_| (Cell::new(level), Cell::new(false))).collect()
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
        assert_eq!(
            error.to_string(),
            "solenoids: the output pins of front-left valve 3 could not be switched: check the output stage"
        );
        assert_eq!(levels(&cells), 0);
        cells[2].1.set(false);
        stage.drive(ValveCommand::SOFT).unwrap();
        assert_eq!(levels(&cells), 0, "not trusted again");
    }
}
