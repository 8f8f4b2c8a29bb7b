//! The state of a strut before its first step: at rest at a displacement that it has been brought to slowly, or in the middle of a drive.

use oleo_interface::Gauge;

use super::law_memory::LawMemory;
use super::layout::Network;
use super::state::State;
use crate::strut::beginning::InMotion;
use crate::strut::gas::GasState;
use crate::strut::pressure::ATMOSPHERE_PA;
use crate::strut::settled::settled;

/// Gauge pressures between which a strut may begin, Pa.
const LOWEST_PA: f64 = -0.9 * ATMOSPHERE_PA;
const HIGHEST_PA: f64 = 60e6;
/// Temperatures between which the gas may begin, over ambient temperature.
const COLDEST: f64 = 0.3;
const HOTTEST: f64 = 3.0;

impl Network {
    /// The state at rest: ambient temperature (K), valves open for long, no flow. Both accumulators are connected.
    pub fn at_rest(&self, displacement_m: f64, ambient_k: f64) -> State {
        let p1 = self.rest_pressure(displacement_m);
        let gas = [0, 1].map(|i| GasState {
            volume_m3: self.paths[i].gas.volume_at(p1.absolute()),
            temperature_k: ambient_k,
        });
        self.without_flow(displacement_m, p1, gas)
    }

    /// The state in the middle of a drive, at an ambient temperature (K). What is impossible is moved to the nearest possible state, since a fit
    /// may ask for it.
    pub fn in_motion(&self, displacement_m: f64, ambient_k: f64, begins: &InMotion) -> State {
        let possible = |pa: f64| Gauge(pa.clamp(LOWEST_PA, HIGHEST_PA));
        let warmed = |by_k: f64| (1.0 + by_k / ambient_k).max(COLDEST);
        let [at_ambient_1, at_ambient_2] =
            [0, 1].map(|i| self.paths[i].gas.volume_at(possible(begins.gas_pa[i]).absolute()));
        let chamber = possible(begins.chamber_pa);
        let together = self.gas_at_static().iter().sum::<f64>()
            - (self.chamber.area_m2 * displacement_m - self.oil_by_pressure(chamber.pa()));
        let first = warmed(begins.first_above_ambient_k);
        let of_rest = (together - first * at_ambient_1) / at_ambient_2 - 1.0;
        let second = warmed(ambient_k * of_rest + begins.second_beyond_k).min(HOTTEST);
        let gas = [(first, at_ambient_1), (second, at_ambient_2)].map(|(warmed, at_ambient)| {
            let temperature = if self.paths[0].gas.is_isothermal() { 1.0 } else { warmed };
            GasState {
                volume_m3: temperature * at_ambient,
                temperature_k: temperature * ambient_k,
            }
        });
        self.without_flow(displacement_m, chamber, gas)
    }

    /// A state in which no oil flows and nothing has been heated.
    fn without_flow(&self, displacement_m: f64, p1: Gauge<f64>, gas: [GasState; 2]) -> State {
        State {
            p1_pa: p1.pa(),
            gas,
            held_m3: self.chamber.held_m3::<true>(p1.pa(), displacement_m).0,
            compressed: self.chamber.compressed::<true>(p1.pa()).0,
            q2_m3_s: 0.0,
            shear: [0.0; 2],
            heat_j: [0.0; 2],
            laws: LawMemory::at_rest([0, 1].map(|i| gas[i].volume_m3 / self.paths[i].static_gas_m3)),
        }
    }

    /// Volume of the gas in accumulators 1 and 2 at static pressure and ambient temperature, m3.
    fn gas_at_static(&self) -> [f64; 2] {
        [0, 1].map(|i| self.paths[i].gas.volume_at(Gauge(self.chamber.static_pa).absolute()))
    }

    /// Volume that the oil of the main chamber gives way by at a gauge pressure (Pa) beyond the static one, m3.
    fn oil_by_pressure(&self, pa: f64) -> f64 {
        self.chamber.oil_volume_m3 * self.chamber.compressibility_1_pa * (pa - self.chamber.static_pa)
    }

    /// Pressure at which the gas charges and the oil have taken up the volume that the piston has pushed in since the
    /// static position. Newton's method on a monotone function.
    fn rest_pressure(&self, displacement_m: f64) -> Gauge<f64> {
        let at_static = Gauge(self.chamber.static_pa);
        if displacement_m == 0.0 {
            return at_static;
        }
        let static_m3 = self.gas_at_static();
        let taken_up = |p: f64| {
            let gas = |i: usize| static_m3[i] - self.paths[i].gas.volume_at(Gauge(p).absolute());
            gas(0) + gas(1) + self.oil_by_pressure(p)
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
