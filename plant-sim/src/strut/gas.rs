//! The gas of an accumulator: equation of state and energy equation, advanced implicitly with the flow.
//!
//! `dV/dt = -Q` with `p V = m R T` or the real gas's equation of state ([`Nitrogen`]). The temperature follows from the
//! energy equation with a thermal time constant (the term `gas_heat_transfer`); without one the gas stays at ambient
//! temperature.

use serde::{Deserialize, Serialize};

use oleo_interface::Absolute;

use super::equation_of_state::{EquationOfState, NITROGEN_R_J_KG_K};
use super::nitrogen::Nitrogen;
use super::settled::settled;
use super::terms::EnergyStep;
use crate::lanes::{Mask, Number};

/// Isochoric specific heat of nitrogen, J/kg/K (recordings README).
pub const NITROGEN_CV_J_KG_K: f64 = 743.0;

/// Lowest and highest temperature that a charge can have, over ambient temperature.
const POSSIBLE_TEMPERATURE: [f64; 2] = [0.5, 2.0];

/// Volume and temperature of a gas charge.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GasState<N = f64> {
    /// Volume of the gas, m3.
    pub volume_m3: N,
    /// Temperature of the gas, K.
    pub temperature_k: N,
}

/// A gas charge: what does not change while the strut works.
///
/// ```
/// use oleo_interface::Absolute;
/// use oleo_plant_sim::strut::{Gas, GasState};
/// // 0.1 l of ideal nitrogen at 4 MPa and 20 degrees Celsius, without a thermal time constant: Boyle's law.
/// let gas = Gas::charged(Absolute(4.0e6), 1.0e-4, 293.15, None, None);
/// assert!((gas.volume_at(Absolute(8.0e6)) - 0.5e-4).abs() < 1e-18);
/// let half = GasState { volume_m3: 0.5e-4, temperature_k: 293.15 };
/// assert!((gas.pressure(half).pa() - 8.0e6).abs() < 1e-6);
/// ```
#[derive(Debug, Clone)]
pub struct Gas<N: Number = f64> {
    mass_kg: N,
    ambient_k: N,
    /// Inverse of the thermal time constant, 1/s; none: isothermal.
    cooling_rate_1_s: Option<N>,
    real: Option<N::Each<EquationOfState>>,
    gas_constant: N,
    inverse_heat_capacity: N,
    /// The volume below which a state makes no sense; the gas law is continued by its tangent there.
    least_volume_m3: N,
}

impl Gas {
    /// The charge that has a volume (m3) at a pressure and the ambient temperature (K). Without a thermal time constant
    /// (s) it stays at that temperature; without an equation of state of the real gas it is ideal.
    #[must_use]
    pub fn charged(
        pressure: Absolute<f64>,
        volume_m3: f64,
        ambient_k: f64,
        time_constant_s: Option<f64>,
        real: Option<Nitrogen>,
    ) -> Self {
        let real = EquationOfState::of(real, None, pressure, ambient_k);
        Self::obeying(real, pressure, volume_m3, ambient_k, time_constant_s)
    }

    /// The same of a gas that obeys an equation of state; none for an ideal one.
    pub(super) fn obeying(
        real: Option<EquationOfState>,
        pressure: Absolute<f64>,
        volume_m3: f64,
        ambient_k: f64,
        time_constant_s: Option<f64>,
    ) -> Self {
        let density = match &real {
            None => pressure.pa() / (NITROGEN_R_J_KG_K * ambient_k),
            Some(gas) => gas.density(pressure, ambient_k),
        };
        let mass_kg = density * volume_m3;
        Self {
            mass_kg,
            ambient_k,
            cooling_rate_1_s: time_constant_s.map(|tau| 1.0 / tau),
            gas_constant: real.as_ref().map_or(NITROGEN_R_J_KG_K, EquationOfState::gas_constant),
            inverse_heat_capacity: 1.0 / (mass_kg * NITROGEN_CV_J_KG_K),
            real: real.map(|gas| [gas]),
            least_volume_m3: 0.02 * volume_m3,
        }
    }

    /// Mass of the charge, kg.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.mass_kg
    }

    /// Whether the gas has ambient temperature whatever is done to it.
    #[must_use]
    pub fn is_isothermal(&self) -> bool {
        self.cooling_rate_1_s.is_none()
    }

    /// Volume at a pressure and ambient temperature, m3.
    #[must_use]
    pub fn volume_at(&self, pressure: Absolute<f64>) -> f64 {
        self.warm_volume_at(pressure, self.ambient_k)
    }

    /// Volume at a pressure and a temperature (K), m3.
    pub(super) fn warm_volume_at(&self, pressure: Absolute<f64>, temperature_k: f64) -> f64 {
        let density = match &self.real {
            None => pressure.pa() / (NITROGEN_R_J_KG_K * temperature_k),
            Some([gas]) => gas.density(pressure, temperature_k),
        };
        self.mass_kg / density
    }

    /// Temperature at a pressure and a volume (m3), K, as far as it is possible. A volume is nearly proportional to its temperature, so that a few rounds settle.
    pub(super) fn temperature_at(&self, pressure: Absolute<f64>, volume_m3: f64) -> f64 {
        settled(self.ambient_k, 30, |k| {
            self.possible_k(k * volume_m3 / self.warm_volume_at(pressure, k))
        })
    }

    /// A temperature, K, moved to where that of a charge can be; one that is no number becomes the ambient one.
    pub(super) fn possible_k(&self, temperature_k: f64) -> f64 {
        let [coldest, hottest] = POSSIBLE_TEMPERATURE.map(|part| part * self.ambient_k);
        if temperature_k.is_nan() {
            self.ambient_k
        } else {
            temperature_k.max(coldest).min(hottest)
        }
    }

    /// Pressure of a state.
    #[must_use]
    pub fn pressure(&self, state: GasState) -> Absolute<f64> {
        match &self.real {
            None => Absolute(self.mass_kg * NITROGEN_R_J_KG_K * state.temperature_k / state.volume_m3),
            Some([gas]) => gas.state(self.mass_kg / state.volume_m3, state.temperature_k).pressure,
        }
    }

    /// The charges of several accumulators side by side, `like` any number of their kind; none where they differ in kind: cooled or
    /// not, real or ideal.
    pub fn abreast<N: Number>(gases: &N::Each<&Self>, like: N) -> Option<Gas<N>> {
        let all = gases.as_ref();
        let of = |value: fn(&Self) -> f64| like.gather(|lane| value(all[lane]));
        let same = |kind: fn(&Self) -> bool| all.iter().all(|gas| kind(gas) == kind(all[0]));
        let alike = same(|gas| gas.cooling_rate_1_s.is_some()) && same(|gas| gas.real.is_some());
        alike.then(|| Gas {
            mass_kg: of(|gas| gas.mass_kg),
            ambient_k: of(|gas| gas.ambient_k),
            cooling_rate_1_s: (all[0].cooling_rate_1_s).map(|_| of(|gas| gas.cooling_rate_1_s.unwrap_or_default())),
            real: N::each_of(|lane| all[lane].real.as_ref().map(|[gas]| gas.clone())),
            gas_constant: of(|gas| gas.gas_constant),
            inverse_heat_capacity: of(|gas| gas.inverse_heat_capacity),
            least_volume_m3: of(|gas| gas.least_volume_m3),
        })
    }
}

impl<N: Number> Gas<N> {
    /// Make `real` fit for a step of `duration_s` (s) from `base` with about `flow` (m3/s). It is looked up anew where the
    /// gas has moved by two per cent or four kelvin since the last time: within that, the real gas's curvature is below 1e-5
    /// of the pressure.
    #[inline(always)]
    pub fn refresh(&self, real: &mut Departure<N>, base: GasState<N>, duration_s: N, flow: N) {
        if let Some(gases) = &self.real {
            let volume = (base.volume_m3 - duration_s * flow).at_least(self.least_volume_m3);
            // Of mass and not of density: a division costs more than the rest.
            let moved = (self.mass_kg - real.density * volume).abs().above(self.mass_kg * 2e-2)
                | (base.temperature_k - real.temperature_k).abs().above(volume.of(4.0));
            if moved.any() {
                let moved = N::each(|lane| moved.lane(lane));
                *real = real.looked_up(gases, &moved, self.mass_kg / volume, base.temperature_k);
            }
        }
    }

    /// Where there is no more room for oil than the gas law is followed to.
    #[inline(always)]
    pub(super) fn is_full(&self, state: GasState<N>) -> N::Mask {
        state.volume_m3.up_to(self.least_volume_m3)
    }

    /// One implicit step of `duration_s` with a flow of oil into the accumulator, `flow` (m3/s), from `base`.
    #[inline(always)]
    #[must_use]
    pub fn implicit(&self, base: GasState<N>, duration_s: N, flow: N, real: &Departure<N>) -> GasStep<N> {
        let free = base.volume_m3 - duration_s * flow;
        // Below the least volume the pressure goes on rising linearly, so that a hopeless trial (more oil than the
        // accumulator holds) still has a solution instead of a division by zero.
        let volume_m3 = free.at_least(self.least_volume_m3);
        let excess_volume = volume_m3 - free;
        let inverse_volume = volume_m3.recip();
        let density = self.mass_kg * inverse_volume;
        // (dp/dT) at constant volume, Pa/K.
        let heating = density * (self.gas_constant + density * real.by_temperature);
        let (temperature_k, temperature_by_flow) = match self.cooling_rate_1_s {
            None => (self.ambient_k, flow.of(0.0)),
            Some(rate) => {
                let step = EnergyStep {
                    duration_s,
                    flow_m3_s: flow,
                    heating_pa_k: heating,
                    inverse_heat_capacity_k_j: self.inverse_heat_capacity,
                    volume_before_m3: base.volume_m3,
                    inverse_volume_1_m3: inverse_volume,
                    temperature_before_k: base.temperature_k,
                    ambient_k: self.ambient_k,
                };
                step.temperature(rate)
            }
        };
        let f = real.excess
            + real.by_density * (density - real.density)
            + real.by_temperature * (temperature_k - real.temperature_k);
        let rt = self.gas_constant * temperature_k;
        let p = density * (rt + density * f);
        let stiffening = rt + density * (f * 2.0 + density * real.by_density);
        GasStep {
            state: GasState {
                volume_m3,
                temperature_k,
            },
            pressure: Absolute(p * (excess_volume * inverse_volume + 1.0)),
            pressure_by_flow: heating * temperature_by_flow + stiffening * density * duration_s * inverse_volume,
            temperature_by_flow,
        }
    }
}

/// Result of an implicit step.
#[derive(Debug, Clone, Copy)]
pub struct GasStep<N = f64> {
    /// State at its end.
    pub state: GasState<N>,
    /// Pressure at its end.
    pub pressure: Absolute<N>,
    /// Its derivative by the flow, Pa s/m3.
    pub pressure_by_flow: N,
    /// Derivative of the temperature by the flow, K s/m3.
    pub temperature_by_flow: N,
}

/// `p = rho R T + rho^2 f`, `f` linear around a state: exact for the ideal gas (`f = 0`), and for the real one to the square
/// of the change within a step, which the next step does not inherit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Departure<N = f64> {
    density: N,
    temperature_k: N,
    excess: N,
    by_density: N,
    by_temperature: N,
}

impl<N: Number> Departure<N> {
    /// What stands in a lane.
    #[inline(always)]
    pub(super) fn part(&self, lane: usize) -> Departure {
        Departure {
            density: self.density.lane(lane),
            temperature_k: self.temperature_k.lane(lane),
            excess: self.excess.lane(lane),
            by_density: self.by_density.lane(lane),
            by_temperature: self.by_temperature.lane(lane),
        }
    }

    /// The same, but what the real gases of some lanes add is looked up around another density and temperature.
    #[cold]
    #[inline(never)]
    fn looked_up(&self, gases: &N::Each<EquationOfState>, moved: &N::Each<bool>, density: N, temperature_k: N) -> Self {
        let lane = |lane: usize| {
            if !moved.as_ref()[lane] {
                return self.part(lane);
            }
            let (density, temperature_k) = (density.lane(lane), temperature_k.lane(lane));
            let (excess, by_density, by_temperature) = gases.as_ref()[lane].excess(density, temperature_k);
            Departure {
                density,
                temperature_k,
                excess,
                by_density,
                by_temperature,
            }
        };
        let lanes = N::each(lane);
        Self::side_by_side(&N::each(|lane| &lanes.as_ref()[lane]), density)
    }

    /// Several side by side, `like` any number of their kind.
    #[inline(always)]
    pub(super) fn side_by_side(each: &N::Each<&Departure>, like: N) -> Self {
        let each = each.as_ref();
        Self {
            density: like.gather_from(each, |d| d.density),
            temperature_k: like.gather_from(each, |d| d.temperature_k),
            excess: like.gather_from(each, |d| d.excess),
            by_density: like.gather_from(each, |d| d.by_density),
            by_temperature: like.gather_from(each, |d| d.by_temperature),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compression in many small implicit steps; the pressure at the end.
    fn compress(gas: &Gas, from: f64, to: f64, total_s: f64, steps: usize) -> f64 {
        let mut s = GasState {
            volume_m3: from,
            temperature_k: 293.15,
        };
        let h = total_s / steps as f64;
        let mut p = 0.0;
        for _ in 0..steps {
            let flow = (from - to) / total_s;
            let mut real = Departure::default();
            gas.refresh(&mut real, s, 0.0, 0.0);
            let step = gas.implicit(s, h, flow, &real);
            (s, p) = (step.state, step.pressure.pa());
        }
        p
    }

    #[test]
    fn a_temperature_follows_from_pressure_and_volume_as_far_as_it_is_possible() {
        let gas = Gas::charged(Absolute(4.0e6), 1.0e-4, 300.0, None, None);
        let at = |volume_m3: f64| gas.temperature_at(Absolute(8.0e6), volume_m3);
        assert!((at(0.5e-4) - 300.0).abs() < 1e-9 && (at(0.6e-4) - 360.0).abs() < 1e-9);
        // Half of ambient temperature at least, and twice at most; nothing that a fit asks for is no number.
        assert_eq!([at(-1e-4), at(1.0), at(f64::NAN)], [150.0, 600.0, 300.0]);
    }

    #[test]
    fn isothermal_limit_is_boyle() {
        let gas = Gas::charged(Absolute(4e6), 1e-4, 293.15, None, None);
        assert!((compress(&gas, 1e-4, 5e-5, 1.0, 10) / 8e6 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn adiabatic_limit_is_poisson() {
        let gas = Gas::charged(Absolute(4e6), 1e-4, 293.15, Some(1e9), None);
        let kappa = 1.0 + NITROGEN_R_J_KG_K / NITROGEN_CV_J_KG_K;
        let exact = 4e6 * libm::pow(2.0, kappa);
        assert!((compress(&gas, 1e-4, 5e-5, 1.0, 40_000) / exact - 1.0).abs() < 1e-4);
    }

    #[test]
    fn relaxes_with_the_time_constant() {
        let gas = Gas::charged(Absolute(4e6), 1e-4, 293.15, Some(3.0), None);
        let mut s = GasState {
            volume_m3: 1e-4,
            temperature_k: 350.0,
        };
        for _ in 0..30_000 {
            s = gas.implicit(s, 1e-4, 0.0, &Departure::default()).state;
        }
        let left = (s.temperature_k - 293.15) / (350.0 - 293.15);
        assert!((left - libm::exp(-1.0)).abs() < 1e-4);
    }

    #[test]
    fn derivative_by_flow_is_the_difference_quotient() {
        for real in [None, Some(Nitrogen::reference())] {
            for tau in [None, Some(2.0)] {
                let gas = Gas::charged(Absolute(4e6), 1e-4, 293.15, tau, real.clone());
                let base = GasState {
                    volume_m3: 0.8e-4,
                    temperature_k: if tau.is_some() { 300.0 } else { 293.15 },
                };
                let mut around = Departure::default();
                gas.refresh(&mut around, base, 0.0, 0.0);
                let at = |q: f64| gas.implicit(base, 1e-3, q, &around);
                let slope = at(1e-3).pressure_by_flow;
                let quotient = (at(1.001e-3).pressure - at(0.999e-3).pressure) / 2e-6;
                assert!((slope / quotient - 1.0).abs() < 0.02, "{slope} {quotient}");
            }
        }
    }
}
