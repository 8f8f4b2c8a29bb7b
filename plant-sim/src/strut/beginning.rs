//! The state of a strut at the first sample of a recording.

/// How a recording begins.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Beginning {
    /// At rest at the first displacement, which was reached slowly with both accumulators connected; the gas has ambient temperature.
    #[default]
    AtRest,
    /// In the middle of a drive.
    InMotion(InMotion),
}

/// What is known or assumed of a strut in the middle of a drive. Its valves have settled, and nothing flows yet: what flows follows from the
/// pressures within milliseconds. No oil was lost, so that the displacement says what volume both gases have together; that of the first follows from
/// its pressure and temperature, and the second has the rest. Gas that is believed to stay at ambient temperature has the volume that follows from its
/// pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InMotion {
    /// Gauge pressure of the main chamber, Pa.
    pub chamber_pa: f64,
    /// Gauge pressure of the gas in accumulators 1 and 2, Pa. For a real gas this is what it would be if it were ideal from ambient temperature on.
    pub gas_pa: [f64; 2],
    /// Temperature of the gas in accumulator 1 above ambient, K.
    pub first_above_ambient_k: f64,
    /// Temperature of the gas in accumulator 2 beyond what follows from its volume, K: what the volume of the oil leaves open.
    pub second_beyond_k: f64,
}
