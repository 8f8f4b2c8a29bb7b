//! Encodes signals into the bits of a frame and decodes them.
//!
//! A frame has 64 bits, of which the protection takes 12. The signals of every message fill the other 52 bits as one little-endian
//! number, so that packing them is shifting a `u64`. Raw values that are reserved for "no value" are decoded to
//! [`Reading::INVALID`]. A value outside the range of its signal is encoded as an error, never as the nearest number.

use oleo_interface::StrutPressures;

use super::frame::FRAME_BYTES;
use crate::failsafe::{FaultCode, Mode};
use crate::reading::Reading;
use crate::sensor_message::MessageSet;
use crate::valves::ValveCommand;

/// Step of a pressure signal, Pa.
pub const PRESSURE_STEP_PA: f32 = 5_000.0;
/// Pressure of raw value 0, Pa gauge. It is far below vacuum on purpose, so that a dead sensor is not mistaken for an empty strut.
/// It also lets a simulation without cavitation, in which a fast rebound pulls p1 some MPa below p2, send its pressures as they
/// are.
pub const PRESSURE_OFFSET_PA: f32 = -5_000_000.0;
/// Largest raw pressure that is a measurement; it means 35.945 MPa.
pub const PRESSURE_RAW_MAX: u16 = 8_189;
/// Raw pressure of a sensor that reports an error. The next one, 8191, means "not available".
pub const PRESSURE_RAW_ERROR: u16 = 8_190;
/// Step of a displacement signal, m.
pub const DISPLACEMENT_STEP_M: f32 = 1e-5;
/// Step of the status message's accelerations, m/s2.
pub const ACCELERATION_STEP_M_S2: f32 = 0.02;

/// Displacement status: 0 is a measurement, 1 a sensor error, 3 not available.
const STATUS_VALID: u64 = 0;
const STATUS_ERROR: u64 = 1;

pub(super) const fn field(bits: u64, start: u32, length: u32) -> u64 {
    (bits >> start) & ((1 << length) - 1)
}

fn pressure_to_raw(reading: Reading) -> u64 {
    let Some(pressure_pa) = reading.value() else {
        return u64::from(PRESSURE_RAW_ERROR);
    };
    let raw = libm::rintf((pressure_pa - PRESSURE_OFFSET_PA) / PRESSURE_STEP_PA);
    if raw >= 0.0 && raw <= f32::from(PRESSURE_RAW_MAX) {
        u64::from(raw as u16)
    } else {
        u64::from(PRESSURE_RAW_ERROR)
    }
}

fn pressure_from_raw(raw: u64) -> Reading {
    if raw > u64::from(PRESSURE_RAW_MAX) {
        return Reading::INVALID;
    }
    Reading::new(raw as u16 as f32 * PRESSURE_STEP_PA + PRESSURE_OFFSET_PA)
}

/// The raw displacement and its status.
fn displacement_to_raw(reading: Reading) -> (u64, u64) {
    let Some(displacement_m) = reading.value() else {
        return (0, STATUS_ERROR);
    };
    let raw = libm::rintf(displacement_m / DISPLACEMENT_STEP_M);
    if raw >= f32::from(i16::MIN) && raw <= f32::from(i16::MAX) {
        (u64::from(raw as i16 as u16), STATUS_VALID)
    } else {
        (0, STATUS_ERROR)
    }
}

fn displacement_from_raw(raw: u64, status: u64) -> Reading {
    if status == STATUS_VALID {
        Reading::new(f32::from(raw as u16 as i16) * DISPLACEMENT_STEP_M)
    } else {
        Reading::INVALID
    }
}

/// The raw value of an acceleration that is not negative; it saturates.
fn acceleration_to_raw(acceleration_m_s2: f32) -> u64 {
    u64::from(libm::rintf(acceleration_m_s2 / ACCELERATION_STEP_M_S2).clamp(0.0, 1023.0) as u16)
}

/// Pressures p1 to p4 of one strut, Pa gauge. Their resolution is 5 kPa, which is 9.8 N on the piston of 50 mm.
///
/// ```
/// use oleo_controller::can::PressureMessage;
/// use oleo_controller::{Reading, StrutPressures};
/// let mut pressure = StrutPressures::splat(Reading::new(2.0e6));
/// pressure.p3 = Reading::new(9.0e7); // outside the signal's range
/// let received = PressureMessage::decode(&PressureMessage { pressure }.encode());
/// assert_eq!(received.pressure.p1.value(), Some(2.0e6));
/// assert_eq!(received.pressure.p3.value(), None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PressureMessage {
    /// Readings at the four points, Pa.
    pub pressure: StrutPressures<Reading>,
}

impl PressureMessage {
    /// The payload, without its protection.
    pub fn encode(&self) -> [u8; FRAME_BYTES] {
        let StrutPressures { p1, p2, p3, p4 } = self.pressure.map(pressure_to_raw);
        (p1 << 12 | p2 << 25 | p3 << 38 | p4 << 51).to_le_bytes()
    }

    /// The content of a payload that has passed its check.
    pub fn decode(data: &[u8; FRAME_BYTES]) -> Self {
        let bits = u64::from_le_bytes(*data);
        Self {
            pressure: StrutPressures {
                p1: 12,
                p2: 25,
                p3: 38,
                p4: 51,
            }
            .map(|start| pressure_from_raw(field(bits, start, 13))),
        }
    }
}

/// Displacements of the struts of an axle, m, compression positive, with a resolution of 0.01 mm. With them come the sender's
/// tick and its answer to the command's challenge, from which the controller knows how old they are.
///
/// ```
/// use oleo_controller::Reading;
/// use oleo_controller::can::DisplacementMessage;
/// let sent = DisplacementMessage { plant_tick: 7, answer: 6, left: Reading::new(0.012_34), right: Reading::INVALID };
/// let received = DisplacementMessage::decode(&sent.encode());
/// assert!((received.left.value().unwrap() - 0.012_34).abs() < 1e-6);
/// assert_eq!((received.plant_tick, received.right), (7, Reading::INVALID));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DisplacementMessage {
    /// The sender's tick, modulo 256. The command echoes it.
    pub plant_tick: u8,
    /// Challenge of the last command that the sender has received.
    pub answer: u8,
    /// Displacement of the left strut, m.
    pub left: Reading,
    /// Displacement of the right strut, m.
    pub right: Reading,
}

impl DisplacementMessage {
    /// The payload, without its protection.
    pub fn encode(&self) -> [u8; FRAME_BYTES] {
        let (left, left_status) = displacement_to_raw(self.left);
        let (right, right_status) = displacement_to_raw(self.right);
        let bits = u64::from(self.plant_tick) << 12
            | u64::from(self.answer) << 20
            | left << 28
            | right << 44
            | left_status << 60
            | right_status << 62;
        bits.to_le_bytes()
    }

    /// The content of a payload that has passed its check.
    pub fn decode(data: &[u8; FRAME_BYTES]) -> Self {
        let bits = u64::from_le_bytes(*data);
        Self {
            plant_tick: field(bits, 12, 8) as u8,
            answer: field(bits, 20, 8) as u8,
            left: displacement_from_raw(field(bits, 28, 16), field(bits, 60, 2)),
            right: displacement_from_raw(field(bits, 44, 16), field(bits, 62, 2)),
        }
    }
}

/// The valve command. Its word is sent twice, once inverted, so that a fault in the sender's memory is seen too.
///
/// ```
/// use oleo_controller::ValveCommand;
/// use oleo_controller::can::CommandMessage;
/// let sent = CommandMessage { command: ValveCommand::SOFT, echo_tick: 7, ..CommandMessage::default() };
/// let mut payload = sent.encode();
/// assert_eq!(CommandMessage::decode(&payload), Some(sent));
/// payload[2] ^= 1; // now word and inverted word disagree
/// assert_eq!(CommandMessage::decode(&payload), None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CommandMessage {
    /// Commanded positions of the twelve valves.
    pub command: ValveCommand,
    /// The plant's tick of the last displacement message that was received, modulo 256.
    pub echo_tick: u8,
    /// A number that looks drawn at random. The next displacement messages answer with it.
    pub challenge: u8,
    /// Mode of the controller.
    pub mode: Mode,
    /// First cause of a mode other than [`Mode::Normal`].
    pub fault: FaultCode,
}

impl CommandMessage {
    /// The payload, without its protection.
    pub fn encode(&self) -> [u8; FRAME_BYTES] {
        let word = u64::from(self.command.word());
        let bits = word << 12
            | (word ^ 0xFFF) << 24
            | u64::from(self.echo_tick) << 36
            | u64::from(self.challenge) << 44
            | u64::from(self.mode.raw()) << 52
            | u64::from(self.fault.raw()) << 56;
        bits.to_le_bytes()
    }

    /// The content of a payload that has passed its check; `None` if word and inverted word disagree, or if mode or fault do not
    /// exist.
    pub fn decode(data: &[u8; FRAME_BYTES]) -> Option<Self> {
        let bits = u64::from_le_bytes(*data);
        let word = field(bits, 12, 12);
        if word ^ 0xFFF != field(bits, 24, 12) {
            return None;
        }
        Some(Self {
            command: ValveCommand::from_word(word as u16),
            echo_tick: field(bits, 36, 8) as u8,
            challenge: field(bits, 44, 8) as u8,
            mode: Mode::from_repr(field(bits, 52, 4) as u8)?,
            fault: FaultCode::from_repr(field(bits, 56, 8) as u8)?,
        })
    }
}

/// State of the controller, sent every 100 ms for people and loggers.
///
/// ```
/// use oleo_controller::Mode;
/// use oleo_controller::can::StatusMessage;
/// let sent = StatusMessage { mode: Mode::Normal, vertical_rms_m_s2: 1.5, ..StatusMessage::default() };
/// assert_eq!(StatusMessage::decode(&sent.encode()), Some(sent));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StatusMessage {
    /// Mode of the controller.
    pub mode: Mode,
    /// First cause of a mode other than [`Mode::Normal`].
    pub fault: FaultCode,
    /// Whether the strategy is in handling mode.
    pub handling: bool,
    /// Whether the roll-over guard is active.
    pub rollover_guard: bool,
    /// Running RMS of the estimated lateral acceleration, m/s2, 0 to 20.46.
    pub lateral_rms_m_s2: f32,
    /// Running RMS of the body's estimated vertical acceleration, m/s2, 0 to 20.46.
    pub vertical_rms_m_s2: f32,
    /// Number of readings that are invalid at present, 0 to 20.
    pub invalid_readings: u8,
    /// Sensor messages that are late or not trusted, see [`crate::Inputs::lost_messages`].
    pub lost_messages: MessageSet,
}

impl StatusMessage {
    /// The payload, without its protection.
    pub fn encode(&self) -> [u8; FRAME_BYTES] {
        let bits = u64::from(self.mode.raw()) << 12
            | u64::from(self.fault.raw()) << 16
            | u64::from(self.handling) << 24
            | u64::from(self.rollover_guard) << 25
            | acceleration_to_raw(self.lateral_rms_m_s2) << 28
            | acceleration_to_raw(self.vertical_rms_m_s2) << 38
            | u64::from(self.invalid_readings.min(31)) << 48
            | u64::from(self.lost_messages.bits()) << 53;
        bits.to_le_bytes()
    }

    /// The content of a payload that has passed its check; `None` if mode or fault do not exist.
    pub fn decode(data: &[u8; FRAME_BYTES]) -> Option<Self> {
        let bits = u64::from_le_bytes(*data);
        Some(Self {
            mode: Mode::from_repr(field(bits, 12, 4) as u8)?,
            fault: FaultCode::from_repr(field(bits, 16, 8) as u8)?,
            handling: field(bits, 24, 1) == 1,
            rollover_guard: field(bits, 25, 1) == 1,
            lateral_rms_m_s2: field(bits, 28, 10) as u16 as f32 * ACCELERATION_STEP_M_S2,
            vertical_rms_m_s2: field(bits, 38, 10) as u16 as f32 * ACCELERATION_STEP_M_S2,
            invalid_readings: field(bits, 48, 5) as u8,
            lost_messages: MessageSet::from_bits(field(bits, 53, 6) as u8),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_pressure_is_a_measurement_and_the_next_raw_value_is_not() {
        assert_eq!(pressure_from_raw(u64::from(PRESSURE_RAW_MAX)).value(), Some(35.945e6));
        assert_eq!(pressure_from_raw(u64::from(PRESSURE_RAW_ERROR)).value(), None);
    }
}
