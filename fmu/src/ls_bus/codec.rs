//! Bus operations of CAN as bytes (chapters 4.2 and 4.5.1 of FMI-LS-BUS 1.0, headers `fmi3LsBus.h` and `fmi3LsBusCan.h`).
//!
//! ```text
//!   4 bytes     4 bytes                              little-endian, nothing between operations
//!   op code     length of all, with these eight      arguments
//! ```
//!
//! What comes from a tool is not trusted. Each operation is judged by itself: one whose content is wrong is [`Malformed`] and the next is read behind
//! it; where the length itself cannot be right, the rest of the bytes is. A node answers with a Format Error that has these bytes in it.
//!
//! ```
//! use oleo_fmu::ls_bus::{Identifier, Operation, operations};
//! let mut bytes = Vec::new();
//! let frame = Operation::CanTransmit { id: Identifier::Standard(0x110), remote: false, data: &[1, 2, 3] };
//! frame.write(&mut bytes);
//! Operation::Confirm { id: 0xA0 }.write(&mut bytes);
//! assert_eq!(bytes.len(), 16 + 3 + 12);
//! assert_eq!(operations(&bytes).collect::<Vec<_>>(), [Ok(frame), Ok(Operation::Confirm { id: 0xA0 })]);
//! ```

use super::operation::{ArbitrationLost, ErrorCode, ErrorFlag, Identifier, NodeStatus, Operation, Setting};

/// Bytes of op code and length.
const HEADER: usize = 8;
/// Longest data of a CAN frame.
const CAN_DATA: usize = 8;
/// Lengths of data that a CAN FD frame can have beyond eight.
const CAN_FD_LONG: [usize; 7] = [12, 16, 20, 24, 32, 48, 64];
/// Longest data of a CAN FD frame.
const CAN_FD_DATA: usize = 64;
/// Longest data of a CAN XL frame.
const CAN_XL_DATA: usize = 2048;

const FORMAT_ERROR: u32 = 0x01;
const CAN_TRANSMIT: u32 = 0x10;
const CAN_FD_TRANSMIT: u32 = 0x11;
const CAN_XL_TRANSMIT: u32 = 0x12;
const CONFIRM: u32 = 0x20;
const ARBITRATION_LOST: u32 = 0x30;
const BUS_ERROR: u32 = 0x31;
const CONFIGURATION: u32 = 0x40;
const STATUS: u32 = 0x41;
const WAKEUP: u32 = 0x42;

/// Bytes that are no operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Malformed<'a> {
    /// The whole operation, as far as its end is known.
    pub bytes: &'a [u8],
}

impl Malformed<'_> {
    /// Whether somebody's answer to bytes that were wrong is wrong itself. It must not be answered again, or two nodes would never stop.
    pub fn is_answer(&self) -> bool {
        self.bytes
            .first_chunk()
            .is_some_and(|code| u32::from_le_bytes(*code) == FORMAT_ERROR)
    }
}

/// The operations in bytes, in their order. Every byte is in one of them, or in one that is malformed.
pub fn operations(bytes: &[u8]) -> impl Iterator<Item = Result<Operation<'_>, Malformed<'_>>> {
    let mut rest = bytes;
    std::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        let Some((operation, behind)) = first(rest) else {
            return Some(Err(Malformed {
                bytes: std::mem::take(&mut rest),
            }));
        };
        rest = behind;
        Some(parse(operation).ok_or(Malformed { bytes: operation }))
    })
}

/// The bytes of the first operation, and what is behind them.
fn first(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let length = usize::try_from(u32::from_le_bytes(*bytes.get(4..)?.first_chunk()?)).ok()?;
    (length >= HEADER).then(|| bytes.split_at_checked(length)).flatten()
}

/// Arguments that are read one after the other. Whatever is not there makes the whole operation none.
struct Arguments<'a>(&'a [u8]);

impl<'a> Arguments<'a> {
    fn bytes<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (head, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*head)
    }

    fn byte(&mut self) -> Option<u8> {
        self.bytes().map(|[byte]| byte)
    }

    fn word(&mut self) -> Option<u32> {
        self.bytes().map(u32::from_le_bytes)
    }

    fn switch(&mut self) -> Option<bool> {
        match self.byte()? {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        }
    }

    fn identifier(&mut self) -> Option<Identifier> {
        let id = self.word()?;
        if self.switch()? {
            (id < 1 << 29).then_some(Identifier::Extended(id))
        } else {
            (id < 1 << 11).then_some(Identifier::Standard(id as u16))
        }
    }

    /// A length of data, and all that is left, which must be as long.
    fn data(&mut self) -> Option<&'a [u8]> {
        let length = usize::from(u16::from_le_bytes(self.bytes()?));
        let data = std::mem::take(&mut self.0);
        (data.len() == length).then_some(data)
    }
}

fn parse(operation: &[u8]) -> Option<Operation<'_>> {
    let mut arguments = Arguments(operation);
    let code = arguments.word()?;
    let _length = arguments.word()?;
    let parsed = match code {
        FORMAT_ERROR => Operation::FormatError {
            data: arguments.data()?,
        },
        CAN_TRANSMIT => {
            let (id, remote) = (arguments.identifier()?, arguments.switch()?);
            let data = if remote && arguments.0.len() == 2 {
                // Version 1.0.1 of the headers sends the length that is asked for, and no data.
                let length = usize::from(u16::from_le_bytes(arguments.bytes()?));
                (length <= CAN_DATA).then_some(&[][..])?
            } else {
                arguments.data().filter(|data| data.len() <= CAN_DATA)?
            };
            Operation::CanTransmit {
                id,
                remote,
                data: if remote { &[] } else { data },
            }
        }
        CAN_FD_TRANSMIT => Operation::CanFdTransmit {
            id: arguments.identifier()?,
            bit_rate_switch: arguments.switch()?,
            error_state: arguments.switch()?,
            data: (arguments.data()).filter(|data| data.len() <= CAN_DATA || CAN_FD_LONG.contains(&data.len()))?,
        },
        CAN_XL_TRANSMIT => Operation::CanXlTransmit {
            id: arguments.identifier()?,
            extended_content: arguments.switch()?,
            content: arguments.byte()?,
            network: arguments.byte()?,
            acceptance: arguments.word()?,
            data: arguments
                .data()
                .filter(|data| (1..=CAN_XL_DATA).contains(&data.len()))?,
        },
        CONFIRM => Operation::Confirm { id: arguments.word()? },
        ARBITRATION_LOST => Operation::ArbitrationLost { id: arguments.word()? },
        BUS_ERROR => Operation::BusError {
            id: arguments.word()?,
            code: match arguments.byte()? {
                1 => ErrorCode::Bit,
                2 => ErrorCode::BitStuffing,
                3 => ErrorCode::Form,
                4 => ErrorCode::Crc,
                5 => ErrorCode::Ack,
                6 => ErrorCode::BrokenErrorFrame,
                _ => return None,
            },
            flag: match arguments.byte()? {
                1 => ErrorFlag::Primary,
                2 => ErrorFlag::Secondary,
                _ => return None,
            },
            is_sender: arguments.switch()?,
        },
        CONFIGURATION => Operation::Configuration(match arguments.byte()? {
            1 => Setting::CanBitRate(arguments.word()?),
            2 => Setting::CanFdBitRate(arguments.word()?),
            3 => Setting::CanXlBitRate(arguments.word()?),
            4 => Setting::ArbitrationLost(match arguments.byte()? {
                1 => ArbitrationLost::BufferAndRetransmit,
                2 => ArbitrationLost::DiscardAndNotify,
                _ => return None,
            }),
            _ => return None,
        }),
        STATUS => Operation::Status(match arguments.byte()? {
            1 => NodeStatus::ErrorActive,
            2 => NodeStatus::ErrorPassive,
            3 => NodeStatus::BusOff,
            _ => return None,
        }),
        WAKEUP => Operation::Wakeup,
        _ => return None,
    };
    arguments.0.is_empty().then_some(parsed)
}

impl Operation<'_> {
    /// Writes the operation behind bytes that are there. Data that are too long for it are cut.
    pub fn write(&self, bytes: &mut Vec<u8>) {
        let start = bytes.len();
        bytes.extend(self.code().to_le_bytes());
        bytes.extend([0; 4]);
        match *self {
            Self::FormatError { data } => write_data(bytes, data, usize::from(u16::MAX)),
            Self::CanTransmit { id, remote, data } => {
                write_identifier(bytes, id);
                bytes.push(remote.into());
                write_data(bytes, data, if remote { 0 } else { CAN_DATA });
            }
            Self::CanFdTransmit {
                id,
                bit_rate_switch,
                error_state,
                data,
            } => {
                write_identifier(bytes, id);
                bytes.extend([u8::from(bit_rate_switch), u8::from(error_state)]);
                write_data(bytes, data, CAN_FD_DATA);
            }
            Self::CanXlTransmit {
                id,
                extended_content,
                content,
                network,
                acceptance,
                data,
            } => {
                write_identifier(bytes, id);
                bytes.extend([extended_content.into(), content, network]);
                bytes.extend(acceptance.to_le_bytes());
                write_data(bytes, data, CAN_XL_DATA);
            }
            Self::Confirm { id } | Self::ArbitrationLost { id } => bytes.extend(id.to_le_bytes()),
            Self::BusError {
                id,
                code,
                flag,
                is_sender,
            } => {
                bytes.extend(id.to_le_bytes());
                bytes.extend([code as u8, flag as u8, is_sender.into()]);
            }
            Self::Configuration(setting) => {
                let (kind, rate) = match setting {
                    Setting::CanBitRate(rate) => (1, rate),
                    Setting::CanFdBitRate(rate) => (2, rate),
                    Setting::CanXlBitRate(rate) => (3, rate),
                    Setting::ArbitrationLost(_) => (4, 0),
                };
                bytes.push(kind);
                match setting {
                    Setting::ArbitrationLost(behaviour) => bytes.push(behaviour as u8),
                    _ => bytes.extend(rate.to_le_bytes()),
                }
            }
            Self::Status(status) => bytes.push(status as u8),
            Self::Wakeup => {}
        }
        let length = u32::try_from(bytes.len() - start).unwrap_or(u32::MAX);
        if let Some(place) = bytes.get_mut(start + 4..start + HEADER) {
            place.copy_from_slice(&length.to_le_bytes());
        }
    }

    fn code(&self) -> u32 {
        match self {
            Self::FormatError { .. } => FORMAT_ERROR,
            Self::CanTransmit { .. } => CAN_TRANSMIT,
            Self::CanFdTransmit { .. } => CAN_FD_TRANSMIT,
            Self::CanXlTransmit { .. } => CAN_XL_TRANSMIT,
            Self::Confirm { .. } => CONFIRM,
            Self::ArbitrationLost { .. } => ARBITRATION_LOST,
            Self::BusError { .. } => BUS_ERROR,
            Self::Configuration(_) => CONFIGURATION,
            Self::Status(_) => STATUS,
            Self::Wakeup => WAKEUP,
        }
    }
}

fn write_identifier(bytes: &mut Vec<u8>, id: Identifier) {
    bytes.extend(id.number().to_le_bytes());
    bytes.push(matches!(id, Identifier::Extended(_)).into());
}

fn write_data(bytes: &mut Vec<u8>, data: &[u8], most: usize) {
    let data = data.get(..most).unwrap_or(data);
    bytes.extend(u16::try_from(data.len()).unwrap_or(u16::MAX).to_le_bytes());
    bytes.extend(data);
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// As the structures of `fmi3LsBus.h` and `fmi3LsBusCan.h` lie in memory, written down by hand.
    #[test]
    fn the_bytes_are_those_of_the_headers() {
        let cases: [(Operation, &[u8]); 9] = [
            (
                Operation::FormatError { data: &[0xAB, 0xCD] },
                &[1, 0, 0, 0, 12, 0, 0, 0, 2, 0, 0xAB, 0xCD],
            ),
            (
                Operation::CanTransmit {
                    id: Identifier::Standard(0x0A0),
                    remote: false,
                    data: &[7, 8],
                },
                &[0x10, 0, 0, 0, 18, 0, 0, 0, 0xA0, 0, 0, 0, 0, 0, 2, 0, 7, 8],
            ),
            (
                Operation::CanFdTransmit {
                    id: Identifier::Extended(0x1234_5678),
                    bit_rate_switch: true,
                    error_state: false,
                    data: &[9],
                },
                &[0x11, 0, 0, 0, 18, 0, 0, 0, 0x78, 0x56, 0x34, 0x12, 1, 1, 0, 1, 0, 9],
            ),
            (
                Operation::CanXlTransmit {
                    id: Identifier::Standard(1),
                    extended_content: true,
                    content: 3,
                    network: 4,
                    acceptance: 5,
                    data: &[6],
                },
                &[0x12, 0, 0, 0, 23, 0, 0, 0, 1, 0, 0, 0, 0, 1, 3, 4, 5, 0, 0, 0, 1, 0, 6],
            ),
            (
                Operation::Confirm { id: 0x110 },
                &[0x20, 0, 0, 0, 12, 0, 0, 0, 0x10, 1, 0, 0],
            ),
            (
                Operation::BusError {
                    id: 0x110,
                    code: ErrorCode::Ack,
                    flag: ErrorFlag::Secondary,
                    is_sender: true,
                },
                &[0x31, 0, 0, 0, 15, 0, 0, 0, 0x10, 1, 0, 0, 5, 2, 1],
            ),
            (
                Operation::Configuration(Setting::CanBitRate(500_000)),
                &[0x40, 0, 0, 0, 13, 0, 0, 0, 1, 0x20, 0xA1, 7, 0],
            ),
            (
                Operation::Configuration(Setting::ArbitrationLost(ArbitrationLost::DiscardAndNotify)),
                &[0x40, 0, 0, 0, 10, 0, 0, 0, 4, 2],
            ),
            (Operation::Wakeup, &[0x42, 0, 0, 0, 8, 0, 0, 0]),
        ];
        for (operation, bytes) in cases {
            assert_eq!(written(&[operation]), bytes, "{operation:?}");
            assert_eq!(operations(bytes).collect::<Vec<_>>(), [Ok(operation)]);
        }
    }

    fn written(all: &[Operation]) -> Vec<u8> {
        let mut bytes = Vec::new();
        all.iter().for_each(|operation| operation.write(&mut bytes));
        bytes
    }

    fn identifier() -> impl Strategy<Value = Identifier> {
        prop_oneof![
            (0_u16..1 << 11).prop_map(Identifier::Standard),
            (0_u32..1 << 29).prop_map(Identifier::Extended),
        ]
    }

    /// Makes an operation of what was chosen and of data.
    type Make = fn(&Chosen, &'static [u8]) -> Operation<'static>;

    /// Any operation over some data, as a function of them.
    fn operation() -> impl Strategy<Value = (Vec<u8>, Make, Chosen)> {
        let data = prop::collection::vec(any::<u8>(), 0..=70);
        let kinds: Vec<Make> = vec![
            |_, data| Operation::FormatError { data },
            |c, data| Operation::CanTransmit {
                id: c.id,
                remote: c.one,
                data: if c.one { &[] } else { &data[..data.len().min(8)] },
            },
            |c, data| Operation::CanFdTransmit {
                id: c.id,
                bit_rate_switch: c.one,
                error_state: c.two,
                data: &data[..(0..=8)
                    .chain(CAN_FD_LONG)
                    .rfind(|length| *length <= data.len())
                    .unwrap()],
            },
            |c, data| Operation::CanXlTransmit {
                id: c.id,
                extended_content: c.one,
                content: c.byte,
                network: c.byte / 2,
                acceptance: c.word,
                data: if data.is_empty() { &[0] } else { data },
            },
            |c, _| Operation::Confirm { id: c.word },
            |c, _| Operation::ArbitrationLost { id: c.word },
            |c, _| Operation::BusError {
                id: c.word,
                code: [
                    ErrorCode::Bit,
                    ErrorCode::BitStuffing,
                    ErrorCode::Form,
                    ErrorCode::Crc,
                    ErrorCode::Ack,
                    ErrorCode::BrokenErrorFrame,
                ][usize::from(c.byte % 6)],
                flag: if c.two {
                    ErrorFlag::Primary
                } else {
                    ErrorFlag::Secondary
                },
                is_sender: c.one,
            },
            |c, _| {
                Operation::Configuration(match c.byte % 5 {
                    0 => Setting::CanBitRate(c.word),
                    1 => Setting::CanFdBitRate(c.word),
                    2 => Setting::CanXlBitRate(c.word),
                    3 => Setting::ArbitrationLost(ArbitrationLost::BufferAndRetransmit),
                    _ => Setting::ArbitrationLost(ArbitrationLost::DiscardAndNotify),
                })
            },
            |c, _| {
                Operation::Status(
                    [NodeStatus::ErrorActive, NodeStatus::ErrorPassive, NodeStatus::BusOff][usize::from(c.byte % 3)],
                )
            },
            |_, _| Operation::Wakeup,
        ];
        let chosen = (identifier(), any::<bool>(), any::<bool>(), any::<u8>(), any::<u32>()).prop_map(
            |(id, one, two, byte, word)| Chosen {
                id,
                one,
                two,
                byte,
                word,
            },
        );
        (data, prop::sample::select(kinds), chosen)
    }

    #[derive(Debug, Clone)]
    struct Chosen {
        id: Identifier,
        one: bool,
        two: bool,
        byte: u8,
        word: u32,
    }

    /// The bytes of one operation, and whether they are read as just this one.
    fn bytes_of((data, make, chosen): (Vec<u8>, Make, Chosen)) -> Vec<u8> {
        // A test may leak: the data outlive every comparison.
        let operation = make(&chosen, data.leak());
        let bytes = written(&[operation]);
        assert_eq!(operations(&bytes).collect::<Vec<_>>(), [Ok(operation)]);
        bytes
    }

    proptest! {
        #[test]
        fn what_is_written_is_read_also_behind_another(one in operation(), two in operation()) {
            let (one, two) = (bytes_of(one), bytes_of(two));
            let both = [&one[..], &two[..]].concat();
            let read: Vec<_> = operations(&both).map(Result::unwrap).collect();
            prop_assert_eq!(read.len(), 2);
            prop_assert_eq!(written(&read), both);
        }

        /// What is cut off is one malformed operation of all that is there.
        #[test]
        fn a_part_of_an_operation_is_malformed(whole in operation(), cut in any::<prop::sample::Index>()) {
            let bytes = bytes_of(whole);
            let part = &bytes[..1 + cut.index(bytes.len() - 1)];
            prop_assert_eq!(operations(part).collect::<Vec<_>>(), [Err(Malformed { bytes: part })]);
        }

        /// A wrong length spoils its own operation: never is what was written read as something longer or shorter.
        #[test]
        fn a_wrong_length_is_malformed(whole in operation(), length in any::<u32>()) {
            let mut bytes = bytes_of(whole);
            prop_assume!(length as usize != bytes.len());
            bytes[4..8].copy_from_slice(&length.to_le_bytes());
            let first = operations(&bytes).next().unwrap();
            prop_assert!(first.is_err(), "{:?}", first);
        }

        /// Whatever bytes come, each is accounted for once, and what is read is written as it came, but for data of remote requests.
        #[test]
        fn no_bytes_are_lost(bytes in prop::collection::vec(prop_oneof![Just(0_u8), 0_u8..0x45, any::<u8>()], 0..200)) {
            let mut again = Vec::new();
            let mut remote = false;
            for read in operations(&bytes) {
                match read {
                    Ok(operation) => {
                        remote |= matches!(operation, Operation::CanTransmit { remote: true, .. });
                        operation.write(&mut again);
                    }
                    Err(Malformed { bytes }) => again.extend(bytes),
                }
            }
            prop_assert!(remote || again == bytes);
        }
    }
}
