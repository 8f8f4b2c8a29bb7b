//! Receive side of one sensor message: how old it is, and whether it is trusted.

use crate::can::{CheckStatus, Checker, Contract, FRAME_BYTES};

/// Number of bad frames, less the good ones, at which a message is no longer trusted.
const TRUST_LIMIT: u8 = 5;

/// What is known of one sensor message.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    checker: Checker,
    timeout_ticks: u8,
    /// Ticks since the last usable frame, saturating.
    age: u8,
    fresh: bool,
    bad: u8,
    untrusted: bool,
}

impl Receiver {
    /// Has received nothing: the message is lost until its first usable frame.
    pub const fn new(contract: &Contract) -> Self {
        Self {
            checker: Checker::new(contract),
            timeout_ticks: contract.timeout_ticks,
            age: contract.timeout_ticks,
            fresh: false,
            bad: 0,
            untrusted: false,
        }
    }

    /// Checks one frame and counts it for or against the message.
    pub fn receive(&mut self, data: &[u8; FRAME_BYTES]) -> CheckStatus {
        let status = self.checker.check(data);
        if status.is_usable() {
            self.fresh = true;
            self.age = 0;
            self.bad = self.bad.saturating_sub(1);
            if self.bad == 0 {
                self.untrusted = false;
            }
        } else if status.is_error() {
            self.bad = self.bad.saturating_add(1).min(TRUST_LIMIT);
            if self.bad == TRUST_LIMIT {
                self.untrusted = true;
            }
        }
        status
    }

    /// Ends the reception of a tick. Whether the message is lost: its content must not be used.
    pub fn end_of_tick(&mut self) -> bool {
        if !core::mem::take(&mut self.fresh) {
            self.checker.no_new_data();
            self.age = self.age.saturating_add(1);
        }
        self.untrusted || self.age >= self.timeout_ticks
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor_message::SensorMessage;

    /// A frame of another length is checked as if it were this one.
    #[test]
    fn a_frame_full_of_ones_has_a_wrong_crc_under_every_identifier() {
        for message in SensorMessage::ALL {
            let mut receiver = Receiver::new(&message.contract());
            assert_eq!(
                receiver.receive(&[0xFF; FRAME_BYTES]),
                CheckStatus::WrongCrc,
                "{message:?}"
            );
        }
    }
}
