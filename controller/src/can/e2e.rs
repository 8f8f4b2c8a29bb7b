//! End-to-end protection after AUTOSAR profile 2.
//!
//! CAN's own CRC protects a frame on the wire. It does not see a frame that was sent twice, sent by the wrong node, or repeated by
//! a gateway that hangs. Profile 2 adds a 4-bit counter and an 8-bit CRC with polynomial 0x2F over counter, payload and a data
//! identifier that is not sent. Byte 0 is the CRC, the low half of byte 1 the counter.
//!
//! Source (*recalled*, and compared with the Python package `autosar-e2e`): AUTOSAR FO R20-11, "E2E Protocol Specification"
//! (document 849), profile 2; CRC8H2F of "Specification of CRC Routines" (start 0xFF, final XOR 0xFF; check value of "123456789"
//! 0xDF).
//!
//! ```text
//!   CRC = CRC8H2F( byte 1 .. byte 7, data_ids[counter] )
//! ```

use crc::{CRC_8_AUTOSAR, Crc};

use super::contract::Contract;
use super::frame::FRAME_BYTES;

/// CRC8H2F, computed with a table of 256 bytes.
const CRC8H2F: Crc<u8> = Crc::<u8>::new(&CRC_8_AUTOSAR);

const COUNTER_MASK: u8 = 0x0F;

/// Number of frames in sequence that must follow a broken sequence before data is used again (`SyncCounterInit`).
const SYNC_FRAMES: u8 = 2;
/// Number of periods without new data after which the sequence counts as broken (`MaxNoNewOrRepeatedData`).
const MAX_NO_NEW: u8 = 3;

fn crc_of(data: &[u8; FRAME_BYTES], contract: &Contract) -> u8 {
    let [_, header, ..] = *data;
    let data_id = contract
        .data_ids
        .get(usize::from(header & COUNTER_MASK))
        .copied()
        .unwrap_or(0);
    let mut digest = CRC8H2F.digest();
    digest.update(data.get(1..).unwrap_or(&[]));
    digest.update(&[data_id]);
    digest.finalize()
}

/// Sending side of one message.
///
/// ```
/// use oleo_controller::can::{COMMAND, CheckStatus, Checker, Protector};
/// let (mut sender, mut receiver) = (Protector::new(&COMMAND), Checker::new(&COMMAND));
/// let mut data = [0; 8];
/// sender.protect(&mut data);
/// assert_eq!(receiver.check(&data), CheckStatus::Initial);
/// sender.protect(&mut data);
/// assert_eq!(receiver.check(&data), CheckStatus::Ok);
/// data[5] ^= 1;
/// assert_eq!(receiver.check(&data), CheckStatus::WrongCrc);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Protector {
    contract: Contract,
    counter: Counter,
}

impl Protector {
    /// A sender that has sent nothing. Its first frame carries the counter 1, because the profile's sender increments before it
    /// sends.
    pub const fn new(contract: &Contract) -> Self {
        Self {
            contract: *contract,
            counter: Counter::INITIAL,
        }
    }

    /// Writes counter and CRC into a payload whose first 12 bits are free.
    pub fn protect(&mut self, data: &mut [u8; FRAME_BYTES]) {
        self.counter.protect(&self.contract, data);
    }
}

/// What a [`Protector`] remembers. The contract is its caller's.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Counter(u8);

impl Counter {
    pub const INITIAL: Self = Self(0);

    /// See [`Protector::protect`].
    pub fn protect(&mut self, contract: &Contract, data: &mut [u8; FRAME_BYTES]) {
        self.0 = self.0.wrapping_add(1) & COUNTER_MASK;
        let [crc, header, ..] = data;
        *crc = 0;
        *header = (*header & !COUNTER_MASK) | self.0;
        let computed = crc_of(data, contract);
        let [crc, ..] = data;
        *crc = computed;
    }
}

/// Outcome of the check of one received frame (`E2E_P02CheckStatusType`).
///
/// ```
/// use oleo_controller::can::CheckStatus;
/// assert!(CheckStatus::OkSomeLost.is_usable());
/// assert!(!CheckStatus::Initial.is_usable() && !CheckStatus::Initial.is_error());
/// assert!(CheckStatus::Repeated.is_error());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckStatus {
    /// The CRC is right and the counter one further: the data may be used.
    Ok,
    /// The CRC is right and up to `max_delta - 1` frames are missing: the data may be used.
    OkSomeLost,
    /// The CRC is wrong: the frame is corrupted, or it is another message under this identifier.
    WrongCrc,
    /// This is the first frame: there is nothing to compare its counter with.
    Initial,
    /// The frame is in sequence again after a broken sequence, but not yet for long enough.
    Sync,
    /// The counter did not move.
    Repeated,
    /// The counter moved too far or backwards.
    WrongSequence,
}

impl CheckStatus {
    /// Whether the data may be used.
    pub const fn is_usable(self) -> bool {
        matches!(self, Self::Ok | Self::OkSomeLost)
    }

    /// Whether the frame counts against the message: it is corrupted, repeated or out of sequence.
    pub const fn is_error(self) -> bool {
        matches!(self, Self::WrongCrc | Self::Repeated | Self::WrongSequence)
    }
}

/// Receiving side of one message. See [`Protector`] for an example.
#[derive(Clone, Copy, Debug)]
pub struct Checker {
    contract: Contract,
    sequence: Sequence,
}

impl Checker {
    /// A receiver that has received nothing.
    pub const fn new(contract: &Contract) -> Self {
        Self {
            contract: *contract,
            sequence: Sequence::INITIAL,
        }
    }

    /// Notes that a period has passed without a frame, so that the counter may be one further when the next one arrives.
    pub fn no_new_data(&mut self) {
        self.sequence.no_new_data();
    }

    /// Checks a received frame.
    pub fn check(&mut self, data: &[u8; FRAME_BYTES]) -> CheckStatus {
        self.sequence.check(&self.contract, data)
    }
}

/// What a [`Checker`] remembers. The contract is its caller's.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Sequence {
    last: Option<u8>,
    /// By how much more than the contract says the counter may be further, because periods have passed without a frame.
    passed: u8,
    sync: u8,
    no_new: u8,
}

impl Sequence {
    pub const INITIAL: Self = Self {
        last: None,
        passed: 0,
        sync: 0,
        no_new: 0,
    };

    /// See [`Checker::no_new_data`].
    pub fn no_new_data(&mut self) {
        self.no_new = self.no_new.saturating_add(1);
        self.passed = self.passed.saturating_add(1);
    }

    /// See [`Checker::check`].
    pub fn check(&mut self, contract: &Contract, data: &[u8; FRAME_BYTES]) -> CheckStatus {
        let [crc, header, ..] = *data;
        if crc != crc_of(data, contract) {
            return CheckStatus::WrongCrc;
        }
        let counter = header & COUNTER_MASK;
        let Some(last) = self.last else {
            self.last = Some(counter);
            self.passed = 0;
            return CheckStatus::Initial;
        };
        let delta = counter.wrapping_sub(last) & COUNTER_MASK;
        if delta == 0 {
            self.no_new = self.no_new.saturating_add(1);
            return CheckStatus::Repeated;
        }
        let in_sequence = delta <= contract.max_delta.saturating_add(self.passed);
        self.passed = 0;
        self.last = Some(counter);
        let broken = core::mem::take(&mut self.no_new) > MAX_NO_NEW;
        if !in_sequence {
            self.sync = SYNC_FRAMES;
            return CheckStatus::WrongSequence;
        }
        if broken {
            self.sync = SYNC_FRAMES;
        }
        if self.sync > 0 {
            self.sync -= 1;
            return CheckStatus::Sync;
        }
        if delta == 1 {
            CheckStatus::Ok
        } else {
            CheckStatus::OkSomeLost
        }
    }
}
