//! The message about the board itself: why it was reset, what its clock runs from, what its bus has suffered.

use strum::FromRepr;

use super::frame::FRAME_BYTES;
use super::signals::field;

/// What the processor's clock runs from. See [`BoardMessage`] for an example.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, FromRepr)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(u8)]
pub enum ClockSource {
    /// The crystal.
    #[default]
    Crystal = 0,
    /// The internal oscillator, because the crystal has failed.
    Internal = 1,
    /// The internal oscillator without the PLL, because that has failed too.
    InternalWithoutPll = 2,
}

/// Whether the flash holds what was built. See [`BoardMessage`] for an example.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, FromRepr)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(u8)]
pub enum ImageState {
    /// The image has no check value: it was flashed as the compiler made it.
    #[default]
    Unsealed = 0,
    /// The check value is right. An image with a wrong one does not run.
    Sealed = 1,
}

/// How far the CAN peripheral is from leaving the bus. See [`BoardMessage`] for an example.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, FromRepr)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(u8)]
pub enum BusState {
    /// Few errors.
    #[default]
    Active = 0,
    /// An error counter is at 96 or above.
    Warning = 1,
    /// An error counter is above 127.
    Passive = 2,
    /// The peripheral has left the bus.
    Off = 3,
}

/// What a board says of itself, once a second. Counts stay at 255 once they are there.
///
/// ```
/// use oleo_controller::can::{BoardMessage, BusState, ClockSource, ImageState};
/// let sent = BoardMessage {
///     clock: ClockSource::Internal,
///     image: ImageState::Sealed,
///     bus: BusState::Passive,
///     overruns: 3,
///     ..BoardMessage::default()
/// };
/// assert_eq!(BoardMessage::decode(&sent.encode()), Some(sent));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BoardMessage {
    /// Why the board was reset, bit 0 up: brown-out, reset pin, supply, software, independent watchdog, window watchdog, low power.
    pub reset_causes: u8,
    /// What the clock runs from.
    pub clock: ClockSource,
    /// Brown-out level of the option bytes: 3 off, 2 level 1 (2.1 V), 1 level 2 (2.4 V), 0 level 3 (2.7 V).
    pub brown_out_level: u8,
    /// Whether the reset has not ended a latched safe state.
    pub latch_kept: bool,
    /// Whether the flash was checked.
    pub image: ImageState,
    /// State of the CAN peripheral.
    pub bus: BusState,
    /// Ticks at whose end the next one was due already.
    pub overruns: u8,
    /// How often the peripheral has left the bus.
    pub bus_off: u8,
    /// Receive and transmit errors of the driver.
    pub port_errors: u8,
    /// Frames that were not sent in time.
    pub port_dropped: u8,
}

impl BoardMessage {
    /// The payload, without its protection.
    pub fn encode(&self) -> [u8; FRAME_BYTES] {
        let bits = u64::from(self.reset_causes & 0x7F) << 12
            | u64::from(self.clock as u8) << 19
            | u64::from(self.brown_out_level & 3) << 21
            | u64::from(self.latch_kept) << 23
            | u64::from(self.image as u8) << 24
            | u64::from(self.bus as u8) << 26
            | u64::from(self.overruns) << 28
            | u64::from(self.bus_off) << 36
            | u64::from(self.port_errors) << 44
            | u64::from(self.port_dropped) << 52;
        bits.to_le_bytes()
    }

    /// The content of a payload that has passed its check; `None` if clock or image have a state that does not exist.
    pub fn decode(data: &[u8; FRAME_BYTES]) -> Option<Self> {
        let bits = u64::from_le_bytes(*data);
        Some(Self {
            reset_causes: field(bits, 12, 7) as u8,
            clock: ClockSource::from_repr(field(bits, 19, 2) as u8)?,
            brown_out_level: field(bits, 21, 2) as u8,
            latch_kept: field(bits, 23, 1) == 1,
            image: ImageState::from_repr(field(bits, 24, 2) as u8)?,
            bus: BusState::from_repr(field(bits, 26, 2) as u8)?,
            overruns: field(bits, 28, 8) as u8,
            bus_off: field(bits, 36, 8) as u8,
            port_errors: field(bits, 44, 8) as u8,
            port_dropped: field(bits, 52, 8) as u8,
        })
    }
}
