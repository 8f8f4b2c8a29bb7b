//! Times in ticks, and what must hold for the tick period.
//!
//! The controller never reads a clock: one call of [`crate::tick()`] is one period. Filters, time-outs and bus load are all
//! derived from [`TICK_MS`]; what a wrong period would break is checked here, by the compiler.

use oleo_interface::tick::{TICK_MS, TICKS_PER_SECOND};

/// Corner frequency of the strut speed's differentiating filter, Hz: above wheel hop's use for valves of 40 to 90 ms, low
/// enough for the 0.01 mm step of the displacement signal (`vehicle.md`: 15 to 20 Hz).
pub const SPEED_CORNER_HZ: f32 = 18.0;

const _: () = assert!(
    SPEED_CORNER_HZ * 8.0 <= TICKS_PER_SECOND as f32,
    "fastest filter: at least eight ticks a period of its corner, or its discrete form is not what was designed"
);
const _: () = assert!(TICK_MS <= 10, "fastest valve: 40 ms must be at least four ticks");

/// Whole ticks nearest to a time in ms (compile time only, so that no rounding happens in the loop).
pub const fn ticks(time_ms: u32) -> u16 {
    let n = (time_ms + TICK_MS / 2) / TICK_MS;
    assert!(n > 0 && n <= u16::MAX as u32, "time is not representable in ticks");
    n as u16
}
