//! What reads the bytes that a tool gives to a node on CAN (FMI-LS-BUS).

use oleo_fmu::ls_bus::{Identifier, Malformed, Operation, operations};

/// Any bytes: each belongs to one operation or to one that is none, what is read is within its limits, and writing it again gives the bytes that
/// it was read from. Only the data of remote requests, which say nothing, are not kept.
pub fn bus_operations(bytes: &[u8]) {
    let (mut again, mut has_remote) = (Vec::new(), false);
    for read in operations(bytes) {
        match read {
            Ok(operation) => {
                match operation {
                    Operation::CanTransmit { id, remote, data } => {
                        assert!(data.len() <= 8 && is_within(id));
                        has_remote |= remote;
                    }
                    Operation::CanFdTransmit { id, data, .. } => assert!(data.len() <= 64 && is_within(id)),
                    Operation::CanXlTransmit { id, data, .. } => {
                        assert!((1..=2048).contains(&data.len()) && is_within(id))
                    }
                    _ => {}
                }
                operation.write(&mut again);
            }
            Err(Malformed { bytes }) => {
                assert!(!bytes.is_empty());
                again.extend(bytes);
            }
        }
    }
    assert!(has_remote || again == bytes);
}

fn is_within(id: Identifier) -> bool {
    match id {
        Identifier::Standard(id) => id < 1 << 11,
        Identifier::Extended(id) => id < 1 << 29,
    }
}
