//! The tick period, and what must hold for it.
//!
//! The controller never reads a clock: one call of [`crate::tick`] is one period. Filters, time-outs and bus load
//! are all derived from this constant, and those that a wrong value would break are checked here, by the compiler.

/// Period of [`crate::tick`], ms.
pub const TICK_MS: u32 = 5;

/// Period of [`crate::tick`], s.
pub const TICK_S: f32 = TICK_MS as f32 * 0.001;

/// Ticks a second.
pub const TICKS_A_SECOND: u32 = 1000 / TICK_MS;

/// Corner frequency of the strut speed's differentiating filter, Hz: above wheel hop's use for valves of 40 to 90 ms, low enough
/// for the 0.01 mm step of the displacement signal (`vehicle.md`: 15 to 20 Hz).
pub const SPEED_CORNER_HZ: f32 = 18.0;

const _: () = assert!(
    1000 % TICK_MS == 0,
    "the tick must divide a second: periods in ticks are whole numbers"
);
const _: () = assert!(
    SPEED_CORNER_HZ * 8.0 <= TICKS_A_SECOND as f32,
    "fastest filter: at least eight ticks a period of its corner, or its discrete form is not what was designed"
);
const _: () = assert!(TICK_MS <= 10, "fastest valve: 40 ms must be at least four ticks");

/// Whole ticks nearest to a time in ms (compile time only, so that no rounding happens in the loop).
pub(crate) const fn ticks(time_ms: u32) -> u16 {
    let n = (time_ms + TICK_MS / 2) / TICK_MS;
    assert!(n > 0 && n <= u16::MAX as u32, "time is not representable in ticks");
    n as u16
}
