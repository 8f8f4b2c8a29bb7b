//! Whose turn it is: one corner a tick is compared, each corner every 20 ms.
//!
//! The comparisons look at means over a second and at spans within half a second. The fastest motion in them is the wheels' at 10 to
//! 15 Hz, so 50 samples a second are enough, and a tick has a fourth of the work.

use oleo_interface::Corner;
use oleo_interface::tick::{TICK_MS, TICK_S_F32};

/// Ticks from one turn of a corner to its next.
const TICKS: u32 = Corner::ALL.len() as u32;
/// Time from one turn of a corner to its next, s.
pub const TURN_S: f32 = TICKS as f32 * TICK_S_F32;

/// The whole number of turns of a corner nearest to a time in ms, at compile time.
pub const fn turns(time_ms: u32) -> u8 {
    let turn_ms = TICKS * TICK_MS;
    let n = (time_ms + turn_ms / 2) / turn_ms;
    assert!(n > 0 && n <= u8::MAX as u32, "time is not representable in turns");
    n as u8
}

/// The corner after another one, in a circle.
pub fn next(corner: Corner) -> Corner {
    match corner {
        Corner::FrontLeft => Corner::FrontRight,
        Corner::FrontRight => Corner::RearLeft,
        Corner::RearLeft => Corner::RearRight,
        Corner::RearRight => Corner::FrontLeft,
    }
}
