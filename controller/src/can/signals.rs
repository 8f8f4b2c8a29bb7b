//! Signals to bits and back.
//!
//! A frame has 64 bits, of which protection takes 12; every message's signals fill the other 52 as one little-endian
//! number, so packing is shifts of a `u64` and cannot overlap unnoticed. Raw values that are reserved for "no value" come
//! out as [`Reading::INVALID`], and a value outside the range of its signal goes in as an error, never as a clipped number.

use oleo_interface::StrutPressures;

use super::frame::FRAME_BYTES;
use crate::failsafe::{FaultCode, Mode};
use crate::reading::Reading;
use crate::sensor_message::MessageSet;
use crate::valves::ValveCommand;

/// Step of a pressure signal, Pa.
pub const PRESSURE_STEP_PA: f32 = 5_000.0;
/// Pressure of raw value 0, Pa gauge. Far below vacuum on purpose: a dead sensor is not mistaken for an empty strut, and
/// simulated oil, which knows no cavitation, can be sent as it is (a fast rebound pulls p1 some MPa below p2).
pub const PRESSURE_OFFSET_PA: f32 = -5_000_000.0;
/// Largest raw pressure that is a measurement: 35.945 MPa.
pub const PRESSURE_RAW_MAX: u16 = 8_189;
/// Raw pressure of a sensor that reports an error. 8191 is "not available".
pub const PRESSURE_RAW_ERROR: u16 = 8_190;
/// Step of a displacement signal, m.
pub const DISPLACEMENT_STEP_M: f32 = 1e-5;
/// Step of the status message's accelerations, m/s2.
pub const ACCELERATION_STEP_M_S2: f32 = 0.02;

/// Displacement status: 0 is a measurement, 1 a sensor error, 3 not available.
const STATUS_VALID: u64 = 0;
const STATUS_ERROR: u64 = 1;

const fn field(bits: u64, start: u32, length: u32) -> u64 {
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

/// (raw, status)
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

/// Non-negative, saturating.
fn acceleration_to_raw(acceleration_m_s2: f32) -> u64 {
    u64::from(libm::rintf(acceleration_m_s2 / ACCELERATION_STEP_M_S2).clamp(0.0, 1023.0) as u16)
}

/// Pressures p1 to p4 of one strut, gauge, Pa. Resolution 5 kPa (9.8 N on the 50 mm piston).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PressureMessage {
    /// Readings at the four points.
    pub pressure: StrutPressures<Reading>,
}

impl PressureMessage {
    /// Payload, unprotected.
    pub fn encode(&self) -> [u8; FRAME_BYTES] {
        let StrutPressures { p1, p2, p3, p4 } = self.pressure.map(pressure_to_raw);
        (p1 << 12 | p2 << 25 | p3 << 38 | p4 << 51).to_le_bytes()
    }

    /// From a payload that passed its check.
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

/// Displacements of an axle's struts, m, compression positive, resolution 0.01 mm, and the sender's tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DisplacementMessage {
    /// Sender's tick, modulo 65536; the command echoes it.
    pub plant_tick: u16,
    /// Left strut.
    pub left: Reading,
    /// Right strut.
    pub right: Reading,
}

impl DisplacementMessage {
    /// Payload, unprotected.
    pub fn encode(&self) -> [u8; FRAME_BYTES] {
        let (left, left_status) = displacement_to_raw(self.left);
        let (right, right_status) = displacement_to_raw(self.right);
        let bits = u64::from(self.plant_tick) << 12 | left << 28 | right << 44 | left_status << 60 | right_status << 62;
        bits.to_le_bytes()
    }

    /// From a payload that passed its check.
    pub fn decode(data: &[u8; FRAME_BYTES]) -> Self {
        let bits = u64::from_le_bytes(*data);
        Self {
            plant_tick: field(bits, 12, 16) as u16,
            left: displacement_from_raw(field(bits, 28, 16), field(bits, 60, 2)),
            right: displacement_from_raw(field(bits, 44, 16), field(bits, 62, 2)),
        }
    }
}

/// The valve command. The word travels twice, once complemented, so that a fault in the sender's memory is seen too.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CommandMessage {
    /// Valve positions.
    pub command: ValveCommand,
    /// Tick of the displacement message this answers.
    pub echo_tick: u16,
    /// Mode of the controller.
    pub mode: Mode,
    /// First cause of a mode other than normal.
    pub fault: FaultCode,
}

impl CommandMessage {
    /// Payload, unprotected.
    pub fn encode(&self) -> [u8; FRAME_BYTES] {
        let word = u64::from(self.command.word());
        let bits = word << 12
            | (word ^ 0xFFF) << 24
            | u64::from(self.echo_tick) << 36
            | u64::from(self.mode.raw()) << 52
            | u64::from(self.fault.raw()) << 56;
        bits.to_le_bytes()
    }

    /// From a payload that passed its check; `None` where word and complement disagree or mode or fault do not exist.
    pub fn decode(data: &[u8; FRAME_BYTES]) -> Option<Self> {
        let bits = u64::from_le_bytes(*data);
        let word = field(bits, 12, 12);
        if word ^ 0xFFF != field(bits, 24, 12) {
            return None;
        }
        Some(Self {
            command: ValveCommand::from_word(word as u16),
            echo_tick: field(bits, 36, 16) as u16,
            mode: Mode::from_repr(field(bits, 52, 4) as u8)?,
            fault: FaultCode::from_repr(field(bits, 56, 8) as u8)?,
        })
    }
}

/// State of the controller, every 100 ms.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StatusMessage {
    /// Mode of the controller.
    pub mode: Mode,
    /// First cause of a mode other than normal.
    pub fault: FaultCode,
    /// The strategy is in handling mode.
    pub handling: bool,
    /// The roll-over guard is active.
    pub rollover_guard: bool,
    /// Running RMS of the lateral acceleration's surrogate, m/s2, 0 to 20.46.
    pub lateral_rms_m_s2: f32,
    /// Running RMS of the body's vertical acceleration, m/s2, 0 to 20.46.
    pub vertical_rms_m_s2: f32,
    /// Readings that are invalid at present, 0 to 20.
    pub invalid_readings: u8,
    /// Sensor messages that are late or not trusted, see [`crate::Inputs::lost_messages`].
    pub lost_messages: MessageSet,
}

impl StatusMessage {
    /// Payload, unprotected.
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

    /// From a payload that passed its check; `None` where mode or fault do not exist.
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
