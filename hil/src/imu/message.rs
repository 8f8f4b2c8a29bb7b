//! Three readings as the bits of a frame: signed numbers of 16 bits behind the 12 bits of the protection, the last four bits free.

use oleo_controller::Reading;
use oleo_controller::can::FRAME_BYTES;

/// Step of a specific force, m/s2; it reaches from -65.534 to 65.534.
pub const SPECIFIC_FORCE_STEP_M_S2: f64 = 0.002;
/// Step of a rate, rad/s; it reaches from -3.2767 to 3.2767.
pub const RATE_STEP_RAD_S: f64 = 0.0001;

/// First bit of each axis.
const STARTS: [u32; 3] = [12, 28, 44];
/// What stands for a reading outside its range.
const ERROR: i16 = i16::MIN;

/// What the unit has said in a tick, in its own axes. An axis that was not received or is outside its range is [`Reading::INVALID`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InertialReadings {
    /// Specific force along x, y, z, m/s2.
    pub specific_force_m_s2: [Reading; 3],
    /// Angular velocity about x, y, z, rad/s.
    pub rate_rad_s: [Reading; 3],
}

/// The payload of three values, without protection. What is out of range is sent as an error, never clipped.
pub fn encode_axes(values: [f64; 3], step: f64) -> [u8; FRAME_BYTES] {
    let raw = |value: f64| {
        let steps = libm::rint(value / step);
        if steps.abs() <= f64::from(i16::MAX) {
            steps as i16
        } else {
            ERROR
        }
    };
    let bits = values.into_iter().zip(STARTS).fold(0u64, |bits, (value, start)| {
        bits | u64::from(raw(value).cast_unsigned()) << start
    });
    bits.to_le_bytes()
}

/// The three values of a payload.
pub fn decode_axes(data: &[u8; FRAME_BYTES], step: f64) -> [Reading; 3] {
    let bits = u64::from_le_bytes(*data);
    STARTS.map(|start| match ((bits >> start) as u16).cast_signed() {
        ERROR => Reading::INVALID,
        steps => Reading::new((f64::from(steps) * step) as f32),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_sent_is_read_to_half_a_step(values in prop::array::uniform3(-70.0..70.0f64)) {
            let data = encode_axes(values, SPECIFIC_FORCE_STEP_M_S2);
            for (sent, read) in values.into_iter().zip(decode_axes(&data, SPECIFIC_FORCE_STEP_M_S2)) {
                match read.value() {
                    Some(read) => prop_assert!((f64::from(read) - sent).abs() < 0.001_01),
                    None => prop_assert!(sent.abs() > 65.534),
                }
            }
            prop_assert_eq!((data[0], data[1] & 0x0F, data[7] >> 4), (0, 0, 0));
        }
    }

    #[test]
    fn no_number_is_an_error() {
        let data = encode_axes([f64::NAN, f64::INFINITY, 1.0], RATE_STEP_RAD_S);
        let read = decode_axes(&data, RATE_STEP_RAD_S);
        assert_eq!(read, [Reading::INVALID, Reading::INVALID, Reading::new(1.0)]);
    }
}
