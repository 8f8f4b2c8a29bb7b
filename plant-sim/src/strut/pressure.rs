//! The atmosphere in `f64`, and pressures of several lanes counted from it or from vacuum.

use oleo_interface::{Absolute, Gauge};

use crate::lanes::Number;

/// Standard atmosphere, Pa, for arithmetic in `f64`. It is the one of [`oleo_interface::pressure`].
pub const ATMOSPHERE_PA: f64 = oleo_interface::pressure::ATMOSPHERE_PA as f64;

/// The same pressure counted from vacuum.
#[inline(always)]
pub fn absolute<N: Number>(pressure: Gauge<N>) -> Absolute<N> {
    Absolute(pressure.pa() + ATMOSPHERE_PA)
}

/// The same pressure counted from the atmosphere.
#[inline(always)]
pub fn gauge<N: Number>(pressure: Absolute<N>) -> Gauge<N> {
    Gauge(pressure.pa() - ATMOSPHERE_PA)
}
