//! The period at which sensors are read and valves are commanded.
//!
//! The valves need 40 to 90 ms, so 5 ms resolves their movement; six sensor messages and one command fit into it on a
//! CAN bus of 500 kbit/s. Everything that depends on the period is derived from [`TICK_MS`].

/// Period of one tick, ms.
pub const TICK_MS: u32 = 5;

/// Period of one tick, s.
pub const TICK_S: f64 = TICK_MS as f64 * 1e-3;

/// Period of one tick in single precision, s, as the controller computes with it.
///
/// It is the product in single precision and lies one bit above the nearest number to 0.005. The coefficients of the
/// controller's filters, and with them the valve words, depend on that bit.
pub const TICK_S_F32: f32 = TICK_MS as f32 * 0.001;

/// Period of one tick, microseconds.
pub const TICK_US: u32 = TICK_MS * 1000;

/// Number of ticks in one second.
pub const TICKS_PER_SECOND: u32 = 1000 / TICK_MS;

const _: () = assert!(1000 % TICK_MS == 0, "a second must hold a whole number of ticks");
