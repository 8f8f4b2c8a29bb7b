//! Times in ticks, and the requirements on the tick period.
//!
//! The controller never reads a clock: one call of [`crate::tick()`] is one period. Filters, time-outs and bus load are all
//! derived from [`TICK_MS`]; what a wrong period would break is checked by the compiler, here and beside the fastest filter.

use oleo_interface::tick::TICK_MS;

const _: () = assert!(TICK_MS <= 10, "fastest valve: 40 ms must be at least four ticks");

/// The whole number of ticks nearest to a time in ms. It is used at compile time only, so that nothing is rounded in the loop.
pub const fn ticks(time_ms: u32) -> u16 {
    let n = (time_ms + TICK_MS / 2) / TICK_MS;
    assert!(n > 0 && n <= u16::MAX as u32, "time is not representable in ticks");
    n as u16
}
