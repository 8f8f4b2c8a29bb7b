//! A CAN network as FMI-LS-BUS 1.0 has it ("Network Abstraction"): frames, confirmations and errors as bytes, and the terminal that a tool connects.
//!
//! The standard: <https://modelica.github.io/fmi-ls-bus/v1.0.0/>. Its chapter 4.2 is the protocol, 4.3 the variables, 4.4 the terminal, 4.5.1 CAN.
//!
//! | file | what it holds |
//! |---|---|
//! | `operation` | the bus operations |
//! | `codec` | the operations as bytes, and what becomes of bytes that are none |
//! | `confinement` | the error counters of a node, and what follows from them (ISO 11898-1) |
//! | `transceiver` | the CAN peripheral of a node whose bus is a tool |
//! | `terminal` | the four variables of a network, and the files that tell a tool of them |

mod codec;
mod confinement;
pub(crate) mod operation;
pub(crate) mod terminal;
pub(crate) mod transceiver;

pub use codec::{Malformed, operations};
pub use operation::{ArbitrationLost, ErrorCode, ErrorFlag, Identifier, NodeStatus, Operation, Setting};
