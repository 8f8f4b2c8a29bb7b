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
/// Smallest share of both gas volumes that the second gas has.
const LEAST_SHARE: f64 = 0.01;
/// Both gases together have at most so many times the volume that they have at ambient temperature, or this part of it. Fast compression warms them by less.
const MOST_OF_AMBIENT: f64 = 1.3;

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
        let chamber = possible(begins.chamber_pa);
        let shear = begins.seal_shear.map(|shear| shear.clamp(-1.0, 1.0));
        let gas_pa = [0, 1].map(|i| {
            let held_back_pa = self.paths[i].piston_seal.breakaway_pa * shear[i];
            possible(begins.accumulator_pa[i] - held_back_pa).absolute()
        });
        let gas = |i: usize, temperature_k: f64| {
            let gas = &self.paths[i].gas;
            let temperature_k = if gas.is_isothermal() {
                ambient_k
            } else {
                gas.possible_k(temperature_k)
            };
            GasState {
                volume_m3: gas.warm_volume_at(gas_pa[i], temperature_k),
                temperature_k,
            }
        };
        let rest = self.at_rest(0.0, ambient_k);
        let taken_up = self
            .chamber
            .taken_up::<true>(&rest, chamber.pa(), displacement_m)
            .volume_m3;
        let pushed_in = self.chamber.area_m2 * displacement_m - taken_up;
        let by_displacement = rest.gas[0].volume_m3 + rest.gas[1].volume_m3 - pushed_in;
        let at_ambient: f64 = (0..2).map(|i| self.paths[i].gas.volume_at(gas_pa[i])).sum();
        // Not `clamp`, which panics where a law of the gas that a fit tries has no volume at these pressures.
        let likely = by_displacement
            .max(at_ambient / MOST_OF_AMBIENT)
            .min(at_ambient * MOST_OF_AMBIENT);
        let together = (1.0 + begins.volume_beyond) * likely;
        let first = gas(0, ambient_k * together / at_ambient + begins.first_beyond_k);
        // What is left is never nothing, whatever a fit asks for.
        let left = (together - first.volume_m3).max(LEAST_SHARE * together);
        let second = gas(1, self.paths[1].gas.temperature_at(gas_pa[1], left));
        State {
            shear,
            ..self.without_flow(displacement_m, chamber, [first, second])
        }
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

    /// Pressure at which the gas charges and the oil have taken up the volume that the piston has pushed in since the
    /// static position. Newton's method on a monotone function.
    fn rest_pressure(&self, displacement_m: f64) -> Gauge<f64> {
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
