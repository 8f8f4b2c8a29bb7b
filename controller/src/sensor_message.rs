//! The six messages by which sensors report, and sets of them.

use oleo_interface::{Axle, Axles, Corner, Corners};

/// A message by which sensors report, once a tick.
///
/// ```
/// use oleo_controller::{Axle, SensorMessage};
/// let last = SensorMessage::Displacement(Axle::Rear);
/// assert_eq!(SensorMessage::ALL.last(), Some(&last));
/// assert_eq!(last.contract().id, 0x115);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SensorMessage {
    /// The four pressures of the strut at one corner.
    Pressure(Corner),
    /// The displacements of both struts of an axle, and the sender's tick.
    Displacement(Axle),
}

impl SensorMessage {
    /// All messages in sending order. The last one completes the readings of a tick.
    pub const ALL: [Self; 6] = [
        Self::Pressure(Corner::FrontLeft),
        Self::Pressure(Corner::FrontRight),
        Self::Pressure(Corner::RearLeft),
        Self::Pressure(Corner::RearRight),
        Self::Displacement(Axle::Front),
        Self::Displacement(Axle::Rear),
    ];

    /// Place of the message's bit in the status message: 0 to 3 for the pressures, 4 and 5 for the displacements.
    const fn bit(self) -> usize {
        match self {
            Self::Pressure(corner) => corner.index(),
            Self::Displacement(Axle::Front) => 4,
            Self::Displacement(Axle::Rear) => 5,
        }
    }
}

/// A set of sensor messages.
///
/// ```
/// use oleo_controller::{Corner, MessageSet, SensorMessage};
/// let mut lost = MessageSet::EMPTY;
/// lost.insert(SensorMessage::Pressure(Corner::RearLeft));
/// assert!(lost.contains(SensorMessage::Pressure(Corner::RearLeft)));
/// assert_eq!(lost.bits(), 0b000_100);
/// assert_ne!(lost, MessageSet::ALL);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MessageSet(u8);

impl MessageSet {
    /// A set that contains no message.
    pub const EMPTY: Self = Self(0);
    /// A set that contains all six sensor messages.
    pub const ALL: Self = Self(0x3F);

    /// From the six bits of the status message; higher bits are ignored.
    pub const fn from_bits(bits: u8) -> Self {
        Self(bits & Self::ALL.0)
    }

    /// The six bits of the status message, 0 to 63: 0 to 3 for the pressures of the four corners, 4 and 5 for the
    /// displacements of the front and the rear axle.
    pub const fn bits(self) -> u8 {
        self.0
    }

    /// Puts a message into the set.
    pub const fn insert(&mut self, message: SensorMessage) {
        self.0 |= 1 << message.bit();
    }

    /// Whether a message is in the set.
    pub const fn contains(self, message: SensorMessage) -> bool {
        self.0 >> message.bit() & 1 == 1
    }
}

/// One value for each sensor message.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PerSensorMessage<T> {
    pub pressure: Corners<T>,
    pub displacement: Axles<T>,
}

impl<T> PerSensorMessage<T> {
    /// The value of a message, to change it.
    pub fn get_mut(&mut self, message: SensorMessage) -> &mut T {
        match message {
            SensorMessage::Pressure(corner) => &mut self.pressure[corner],
            SensorMessage::Displacement(axle) => &mut self.displacement[axle],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_message_has_a_bit_of_its_own() {
        let mut all = MessageSet::EMPTY;
        for (bit, message) in SensorMessage::ALL.into_iter().enumerate() {
            assert!(!all.contains(message));
            let mut one = MessageSet::EMPTY;
            one.insert(message);
            assert_eq!(one.bits(), 1 << bit);
            all.insert(message);
            assert!(all.contains(message));
        }
        assert_eq!(all, MessageSet::ALL);
        assert_eq!(MessageSet::from_bits(0xFF), MessageSet::ALL);
    }
}
