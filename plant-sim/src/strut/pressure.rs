//! The atmosphere in `f64`.

/// Standard atmosphere, Pa, for arithmetic in `f64`. It is the one of [`oleo_interface::pressure`].
pub const ATMOSPHERE_PA: f64 = oleo_interface::pressure::ATMOSPHERE_PA as f64;
