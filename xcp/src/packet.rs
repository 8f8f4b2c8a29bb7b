//! Packets on CAN: at most eight bytes, the first of which says what it is.
//!
//! All numbers are little-endian (Intel), as in the vehicle's own messages.

use heapless::Vec;

/// Most bytes of a command or an answer (`MAX_CTO`) and of a frame of measured data (`MAX_DTO`).
pub const MOST_BYTES: usize = 8;

/// A packet that the slave sends. Its length is that of the CAN frame.
pub type Packet = Vec<u8, MOST_BYTES>;

/// First byte of a positive answer.
pub const POSITIVE: u8 = 0xFF;
/// First byte of a refusal.
pub const NEGATIVE: u8 = 0xFE;
/// Largest packet identifier of measured data. The numbers above are answers, events and services.
pub const LAST_DATA_PID: u8 = 0xFB;

/// Codes of the commands that this slave knows (protocol layer specification, "table of command codes").
pub mod command {
    #![allow(missing_docs, reason = "the names are those of the specification")]
    pub const CONNECT: u8 = 0xFF;
    pub const DISCONNECT: u8 = 0xFE;
    pub const GET_STATUS: u8 = 0xFD;
    pub const SYNCH: u8 = 0xFC;
    pub const GET_COMM_MODE_INFO: u8 = 0xFB;
    pub const GET_ID: u8 = 0xFA;
    pub const SET_MTA: u8 = 0xF6;
    pub const UPLOAD: u8 = 0xF5;
    pub const SHORT_UPLOAD: u8 = 0xF4;
    pub const BUILD_CHECKSUM: u8 = 0xF3;
    pub const DOWNLOAD: u8 = 0xF0;
    pub const SET_DAQ_PTR: u8 = 0xE2;
    pub const WRITE_DAQ: u8 = 0xE1;
    pub const SET_DAQ_LIST_MODE: u8 = 0xE0;
    pub const GET_DAQ_LIST_MODE: u8 = 0xDF;
    pub const START_STOP_DAQ_LIST: u8 = 0xDE;
    pub const START_STOP_SYNCH: u8 = 0xDD;
    pub const GET_DAQ_CLOCK: u8 = 0xDC;
    pub const GET_DAQ_PROCESSOR_INFO: u8 = 0xDA;
    pub const GET_DAQ_RESOLUTION_INFO: u8 = 0xD9;
    pub const GET_DAQ_EVENT_INFO: u8 = 0xD7;
    pub const FREE_DAQ: u8 = 0xD6;
    pub const ALLOC_DAQ: u8 = 0xD5;
    pub const ALLOC_ODT: u8 = 0xD4;
    pub const ALLOC_ODT_ENTRY: u8 = 0xD3;
}

/// Why a command is refused (protocol layer specification, "table of error codes").
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Refusal {
    /// Not an error: the answer to SYNCH.
    Synchronised = 0x00,
    /// The command is not known, or optional and not there.
    UnknownCommand = 0x20,
    /// The frame is too short for the command.
    Syntax = 0x21,
    /// A parameter of the command, or a value that is to be written, is outside of its range.
    OutOfRange = 0x22,
    /// This build does not write.
    WriteProtected = 0x23,
    /// There is nothing at this address.
    AccessDenied = 0x24,
    /// The mode that was asked for does not exist here.
    ModeNotValid = 0x27,
    /// The command does not follow from those before.
    Sequence = 0x29,
    /// The lists cannot be sent as they are: an ODT is too long, or the bus has no room.
    DaqConfiguration = 0x2A,
    /// A list is being sent, and cannot be changed.
    DaqActive = 0x11,
    /// There is no memory for so many lists, ODTs or entries.
    MemoryOverflow = 0x30,
    /// The values cannot be written now: a valve may be open.
    TemporarilyNotAccessible = 0x33,
}

/// The data of a command, read without a way to read beyond its end.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a>(pub &'a [u8]);

impl Request<'_> {
    /// Whether the frame has at least so many bytes.
    pub fn needs(self, bytes: usize) -> Result<Self, Refusal> {
        if self.0.len() >= bytes {
            Ok(self)
        } else {
            Err(Refusal::Syntax)
        }
    }

    /// The byte at a place; 0 beyond the end, which `needs` has ruled out.
    pub fn byte(self, at: usize) -> u8 {
        self.0.get(at).copied().unwrap_or(0)
    }

    /// Two bytes.
    pub fn word(self, at: usize) -> u16 {
        u16::from_le_bytes([self.byte(at), self.byte(at + 1)])
    }

    /// Four bytes.
    pub fn double_word(self, at: usize) -> u32 {
        u32::from_le_bytes([self.byte(at), self.byte(at + 1), self.byte(at + 2), self.byte(at + 3)])
    }
}

/// A packet of these bytes. What does not fit is left out, which happens nowhere in this crate.
pub(crate) fn packet(bytes: &[u8]) -> Packet {
    let mut packet = Packet::new();
    for byte in bytes.iter().take(MOST_BYTES) {
        // There is room: eight bytes at most.
        let _ = packet.push(*byte);
    }
    packet
}

/// The refusal of a command.
pub(crate) fn refused(why: Refusal) -> Packet {
    packet(&[NEGATIVE, why as u8])
}
