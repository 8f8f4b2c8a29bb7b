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
/// pressures within milliseconds. As long as no oil is lost, the displacement says what volume both gases have together; that of the first follows from
/// its pressure and temperature, and the second has the rest, from which its temperature follows. Where oil has been lost, so that the gas would be hotter or
/// colder than it can be, its pressures say what volume it has. Gas that is believed to stay at ambient temperature
/// has the volume that follows from its pressure.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct InMotion {
    /// Gauge pressure of the main chamber, Pa.
    pub chamber_pa: f64,
    /// Gauge pressure of the oil in accumulators 1 and 2, Pa; the gas behind a piston that rubs has what the seal does not hold back.
    pub accumulator_pa: [f64; 2],
    /// Shear of the seals of both floating pistons, -1 to 1. It matters where they rub.
    pub seal_shear: [f64; 2],
    /// Temperature of the gas in accumulator 1 beyond that which both would have if they were equally warm, K.
    pub first_beyond_k: f64,
    /// Volume of both gases together beyond what displacement and pressures say, relative. The recordings' equation does not conserve oil: what the dampers
    /// have turned into heat, divided by the bulk modulus, is lost.
    pub volume_beyond: f64,
    /// Mean power that the dampers of paths 1 and 2 turned into heat before, W. It matters where they fade.
    pub heating_w: [f64; 2],
    /// Time for which they did, s.
    pub heated_s: f64,
}
