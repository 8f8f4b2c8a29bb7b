//! Types on which the controller and the plant must agree: corners, axles, valves, pressures and the tick.
//!
//! | module | what it holds |
//! |---|---|
//! | [`corner`] | the four corners of the vehicle, its axles and sides, and one value for each of them |
//! | [`valve`] | the three solenoid valves of a strut, and one value for each of them |
//! | [`strut_pressures`] | the four places at which a strut's pressure is measured, and one value for each of them |
//! | [`pressure`] | gauge and absolute pressure, so that one is never taken for the other |
//! | [`tick`] | the period at which sensors are read and valves are commanded |
//!
//! The crate computes nothing. It is `no_std`, because the controller is.
#![no_std]
#![forbid(unsafe_code)]

pub mod corner;
pub mod pressure;
pub mod strut_pressures;
pub mod tick;
pub mod valve;

pub use corner::{Axle, Axles, Corner, Corners, Side};
pub use pressure::{Absolute, Gauge};
pub use strut_pressures::{PressurePoint, StrutPressures};
pub use valve::{StrutValves, Valve};
