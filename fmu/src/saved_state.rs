//! The state of an instance as bytes, which a tool may write to a file and give to another instance.

use crc::{CRC_32_ISCSI, Crc};
use serde::{Deserialize, Serialize};

use crate::complaint::Complaint;
use crate::exchange::Exchange;
use crate::phase::Phase;

/// Tells whether the bytes are whole.
const CHECKSUM: Crc<u32> = Crc::<u32>::new(&CRC_32_ISCSI);

/// What is to be known beside the resources to go on.
#[derive(Serialize, Deserialize)]
pub struct SavedState {
    pub phase: Phase,
    pub has_begun: bool,
    pub start_s: f64,
    pub values: Vec<f64>,
    pub exchange: Exchange,
    pub model: Vec<u8>,
}

impl SavedState {
    /// Token, checksum, and the state.
    pub fn to_bytes(&self, token: &str) -> Result<Vec<u8>, Complaint> {
        let body = postcard::to_allocvec(self).map_err(Complaint::new)?;
        let mut bytes = token.as_bytes().to_vec();
        bytes.extend(CHECKSUM.checksum(&body).to_le_bytes());
        bytes.extend(body);
        Ok(bytes)
    }

    /// A state of the FMU with a token and as many values.
    ///
    /// # Errors
    /// The bytes are not whole, or are of another FMU.
    pub fn from_bytes(bytes: &[u8], token: &str, values: usize) -> Result<Self, Complaint> {
        let damaged =
            || Complaint::new("the serialized state is damaged or cut off: give the bytes as they were written");
        let Some(rest) = bytes.strip_prefix(token.as_bytes()) else {
            return Err(Complaint::new(
                "the serialized state is of another FMU: give one that this file has written",
            ));
        };
        let (checksum, body) = rest.split_first_chunk().ok_or_else(damaged)?;
        if CHECKSUM.checksum(body) != u32::from_le_bytes(*checksum) {
            return Err(damaged());
        }
        let saved: Self = postcard::from_bytes(body).map_err(|_| damaged())?;
        if saved.values.len() == values {
            Ok(saved)
        } else {
            Err(damaged())
        }
    }
}
