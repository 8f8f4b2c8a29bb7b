//! The oil column of line 2 between the main chamber and accumulator 2: a mass between two springs.

use super::layout::Network;
use super::state::State;

/// The column's oscillation.
#[derive(Debug, Clone, Copy)]
pub(in crate::strut) struct ColumnOscillator {
    /// Inertance of the line, kg/m4.
    pub inertance_kg_m4: f64,
    /// Natural angular frequency without damping, rad/s.
    pub frequency_rad_s: f64,
    /// Amplitude of the pressure after a sudden change of the piston's speed, Pa s/m.
    pub kick_pa_s_m: f64,
}

impl Network {
    /// The oil column of line 2 as an oscillator around a state of rest; none if its oil has no mass.
    pub fn column_oscillator(&self, rest: &State) -> Option<ColumnOscillator> {
        let inertance_kg_m4 = self.inertance_kg_m4;
        if inertance_kg_m4 <= 0.0 {
            return None;
        }
        // By Boyle's law, which is soft enough: gas takes up so much more than oil that its exponent hardly matters.
        let [gas_1, gas_2] = [0, 1].map(|i| rest.gas[i].volume_m3 / self.paths[i].gas.pressure(rest.gas[i]).pa());
        // Rigid oil takes up nothing; behind it is the other accumulator.
        let held = self.chamber.taken_up::<true>(rest, rest.p1_pa, 0.0).slope;
        let chamber = if held > 0.0 { held } else { gas_1 };
        let volume_per_pressure = 1.0 / (1.0 / chamber + 1.0 / gas_2);
        Some(ColumnOscillator {
            inertance_kg_m4,
            frequency_rad_s: 1.0 / (inertance_kg_m4 * volume_per_pressure).sqrt(),
            kick_pa_s_m: self.chamber.area_m2 * (inertance_kg_m4 / volume_per_pressure).sqrt(),
        })
    }
}
