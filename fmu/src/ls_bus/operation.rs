//! Bus operations of CAN: what the nodes of a network and its bus tell each other (chapter 4.5.1 of FMI-LS-BUS 1.0).

/// Identifier of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Identifier {
    /// 11 bits.
    Standard(u16),
    /// 29 bits.
    Extended(u32),
}

impl Identifier {
    /// Its number, whichever kind it is of: confirmations and errors name a frame by it.
    pub fn number(self) -> u32 {
        match self {
            Self::Standard(id) => id.into(),
            Self::Extended(id) => id,
        }
    }
}

/// What was wrong with a frame on the bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum ErrorCode {
    /// A bit was read other than it was sent.
    Bit = 1,
    /// Six equal bits.
    BitStuffing = 2,
    /// A fixed bit is wrong.
    Form = 3,
    /// The check value is wrong.
    Crc = 4,
    /// Nobody has acknowledged.
    Ack = 5,
    /// The error frame itself was disturbed.
    BrokenErrorFrame = 6,
}

/// Who has seen an error first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum ErrorFlag {
    /// This node.
    Primary = 1,
    /// Another one.
    Secondary = 2,
}

/// State of a node on the bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[repr(u8)]
pub enum NodeStatus {
    /// Few errors.
    ErrorActive = 1,
    /// Many errors: the node does not disturb others any more.
    ErrorPassive = 2,
    /// Too many errors of its own frames: the node sends nothing.
    BusOff = 3,
}

/// What a bus does with a frame that has lost its arbitration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[repr(u8)]
pub enum ArbitrationLost {
    /// It keeps the frame and sends it later.
    BufferAndRetransmit = 1,
    /// It drops the frame and says so; the node sends it again.
    DiscardAndNotify = 2,
}

/// A setting of the bus that a node asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Setting {
    /// bit/s.
    CanBitRate(u32),
    /// bit/s of the data phase.
    CanFdBitRate(u32),
    /// bit/s of the data phase.
    CanXlBitRate(u32),
    /// What happens to a frame that has lost its arbitration.
    ArbitrationLost(ArbitrationLost),
}

/// A bus operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operation<'a> {
    /// Somebody could not read these bytes.
    FormatError {
        /// At most 65,535 bytes.
        data: &'a [u8],
    },
    /// A frame. That of a remote request has no data here: its length is not used by anybody.
    CanTransmit {
        /// Its identifier.
        id: Identifier,
        /// It asks another node to send.
        remote: bool,
        /// At most eight bytes.
        data: &'a [u8],
    },
    /// A CAN FD frame.
    CanFdTransmit {
        /// Its identifier.
        id: Identifier,
        /// The data are sent at the faster bit rate.
        bit_rate_switch: bool,
        /// The sender is error-passive.
        error_state: bool,
        /// At most 64 bytes.
        data: &'a [u8],
    },
    /// A CAN XL frame.
    CanXlTransmit {
        /// Its identifier.
        id: Identifier,
        /// Simple extended content.
        extended_content: bool,
        /// Type of the content.
        content: u8,
        /// Virtual network.
        network: u8,
        /// Acceptance field.
        acceptance: u32,
        /// 1 to 2048 bytes.
        data: &'a [u8],
    },
    /// A frame was received by somebody.
    Confirm {
        /// Its identifier.
        id: u32,
    },
    /// A frame has lost its arbitration and was dropped by the bus.
    ArbitrationLost {
        /// Its identifier.
        id: u32,
    },
    /// A frame was destroyed.
    BusError {
        /// Its identifier.
        id: u32,
        /// What was wrong.
        code: ErrorCode,
        /// Who has seen it first.
        flag: ErrorFlag,
        /// The frame was this node's own.
        is_sender: bool,
    },
    /// A node asks for a setting of the bus.
    Configuration(Setting),
    /// A node tells its state.
    Status(NodeStatus),
    /// A node wakes the others.
    Wakeup,
}
