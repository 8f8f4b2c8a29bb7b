//! Addresses of buses as on the command line and in scenarios: `inproc`, `socketcan:IFACE`, `slcan:PATH`.

use std::fmt;
use std::str::FromStr;

use super::{Bus, BusError, SerialLine, SocketCan};

/// Address of a bus. Nothing is open yet.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum BusAddress {
    /// Queues in the memory of this process.
    #[default]
    InProcess,
    /// A Linux CAN interface.
    SocketCan(String),
    /// A serial device, pseudo-terminal or `tcp:HOST:PORT` that speaks slcan.
    SerialLine(String),
}

/// A text that is not the address of a bus.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{0:?} is not a bus: give inproc, socketcan:IFACE (such as socketcan:vcan0), slcan:DEVICE or slcan:tcp:HOST:PORT"
)]
pub struct AddressError(String);

impl BusAddress {
    /// Opens one end; `None` for a bus in memory, which has both ends in this process.
    ///
    /// # Errors
    /// The bus does not exist or may not be used.
    pub fn open(&self) -> Result<Option<Box<dyn Bus>>, BusError> {
        Ok(match self {
            Self::InProcess => None,
            Self::SocketCan(interface) => Some(Box::new(SocketCan::open(interface)?)),
            Self::SerialLine(path) => Some(Box::new(SerialLine::open(path)?)),
        })
    }
}

impl FromStr for BusAddress {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        match text.split_once(':') {
            None if text == "inproc" => Ok(Self::InProcess),
            // IFNAMSIZ is 16 with the terminating zero.
            Some(("socketcan", name)) if (1..16).contains(&name.len()) && !name.contains(['/', ' ']) => {
                Ok(Self::SocketCan(name.into()))
            }
            Some(("slcan", path)) if !path.is_empty() => Ok(Self::SerialLine(path.into())),
            _ => Err(AddressError(text.into())),
        }
    }
}

impl fmt::Display for BusAddress {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InProcess => out.write_str("inproc"),
            Self::SocketCan(interface) => write!(out, "socketcan:{interface}"),
            Self::SerialLine(path) => write!(out, "slcan:{path}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_read_back_and_nonsense_is_refused() {
        for text in [
            "inproc",
            "socketcan:vcan0",
            "slcan:/dev/ttyACM0",
            "slcan:tcp:localhost:4444",
        ] {
            assert_eq!(text.parse::<BusAddress>().unwrap().to_string(), text);
        }
        for text in [
            "",
            "vcan0",
            "inproc:",
            "socketcan:",
            "socketcan:../../etc",
            "socketcan:name-of-16-chars",
            "slcan:",
        ] {
            let error = text.parse::<BusAddress>().unwrap_err().to_string();
            assert!(error.contains("socketcan:vcan0"), "{error}");
        }
    }
}
