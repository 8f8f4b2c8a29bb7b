//! The state in which a strut rests at a displacement that it has been brought to slowly.

use oleo_interface::Gauge;

use super::law_memory::LawMemory;
use super::layout::Network;
use super::state::State;
use crate::strut::gas::GasState;
use crate::strut::pressure::ATMOSPHERE_PA;
use crate::strut::settled::settled;

impl Network {
    /// The state at rest: ambient temperature (K), valves open for long, no flow. Both accumulators are connected.
    pub fn at_rest(&self, displacement_m: f64, ambient_k: f64) -> State {
        let p1 = self.rest_pressure(displacement_m);
        let gas = |i: usize| GasState {
            volume_m3: self.paths[i].gas.volume_at(p1.absolute()),
            temperature_k: ambient_k,
        };
        State {
            p1_pa: p1.pa(),
            gas: [gas(0), gas(1)],
            held_m3: self.chamber.held_m3::<true>(p1.pa(), displacement_m).0,
            compressed: self.chamber.compressed::<true>(p1.pa()).0,
            q2_m3_s: 0.0,
            shear: [0.0; 2],
            heat_j: [0.0; 2],
            laws: LawMemory::at_rest([0, 1].map(|i| gas(i).volume_m3 / self.paths[i].static_gas_m3)),
        }
    }

    /// Pressure at which the gas charges and the oil have taken up the volume that the piston has pushed in since the
    /// static position. Newton's method on a monotone function.
    fn rest_pressure(&self, displacement_m: f64) -> Gauge<f64> {
        const LOWEST_PA: f64 = -0.9 * ATMOSPHERE_PA;
        const HIGHEST_PA: f64 = 60e6;
        let at_static = Gauge(self.chamber.static_pa);
        if displacement_m == 0.0 {
            return at_static;
        }
        let static_m3 = [0, 1].map(|i| self.paths[i].gas.volume_at(at_static.absolute()));
        let taken_up = |p: f64| {
            let gas = |i: usize| static_m3[i] - self.paths[i].gas.volume_at(Gauge(p).absolute());
            let oil_by_pressure = self.chamber.oil_volume_m3 * self.chamber.compressibility_1_pa;
            gas(0) + gas(1) + oil_by_pressure * (p - at_static.pa())
        };
        let pushed_in = self.chamber.area_m2 * displacement_m;
        Gauge(settled(at_static.pa(), 30, |p| {
            let dp = 1e-4 * Gauge(p).absolute().pa();
            let here = taken_up(p);
            let slope = (taken_up(p + dp) - here) / dp;
            (p + (pushed_in - here) / slope).clamp(LOWEST_PA, HIGHEST_PA)
        }))
    }
}
