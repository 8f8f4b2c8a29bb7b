//! When and where a stage of the integrator ends.

use oleo_interface::StrutValves;

/// The end of one implicit stage, as the integrator knows it beforehand.
#[derive(Debug, Clone, Copy)]
pub(in crate::strut) struct StageEnd<N = f64> {
    /// Length of the stage, s.
    pub duration_s: N,
    /// Time since the end of the stage that was solved before, s.
    pub since_last_s: N,
    /// Time since the start, s.
    pub time_s: N,
    /// Displacement of the strut, m.
    pub displacement_m: N,
    /// Speed of the strut, m/s.
    pub speed_m_s: N,
    /// Openings of the valves, 0 to 1.
    pub opening: StrutValves<N>,
}
