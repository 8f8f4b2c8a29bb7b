//! What force a strut makes at a speed, for each setting of its bypass valves: the small hydraulic network of the strut, for
//! strategies that predict.
//!
//! ```text
//!   flow        A w = q1 + q2                                        w   speed, compression positive
//!   path 1      p1 - p2 = d1(q1)            valve 1 open    d1 = q |q| / c1^2, laminar below the transition pressure
//!                                           closed          d1 = the table of damper pack 1
//!   path 2      p1 - p4 = d2(q2) + q2 |q2| / c3^2           d2 likewise, valve 3 open
//!   gas         dp = p^2 / (V k) q dt       isothermal; V static volume, k static pressure
//!   force       F = A p1
//! ```
//!
//! `p2` and `p4` are measured, so a step of no duration gives the force that another setting would make now. Source: the network of
//! the seed report (3.3, figure 10). Valve coefficients and the tables of the packs are those of the vehicle's strut preset, where they
//! are *assumed*. What is left out is the compressibility of the oil, the heat of the gas and the flow that a pack passes beside its open
//! valve (some 6 %). The forces are compared with those of the simulated strut (`strut_force/simulated.csv`, which `hil/tests/predicted_force.rs`
//! holds to the plant).

use oleo_interface::{Absolute, Gauge, StrutPressures};

use crate::filter::at_least;
use crate::vehicle::VehicleDescription;

/// Square of the flow coefficient of each bypass valve of two valves in parallel, m6/s2/Pa: preset, `2 x 1.6e-6`.
const BYPASS_2: f32 = 3.2e-6 * 3.2e-6;
/// The same of valve 3: preset, `2 x 1.9e-6`.
const SPRING_VALVE_2: f32 = 3.8e-6 * 3.8e-6;
/// Pressure drop below which an orifice becomes laminar, Pa: preset.
const TRANSITION_PA: f32 = 2.0e4;
/// Flows at the points of both packs' tables, m3/s, the same in both directions: preset.
const FLOW_M3_S: [f32; 4] = [1.2e-4, 4.0e-4, 1.0e-3, 2.0e-3];
/// Pressure drop of each pack at these flows, Pa, in jounce and in rebound: preset.
const PACKS_PA: [[[f32; 4]; 2]; 2] = [
    [[2.05e5, 5.6e5, 1.04e6, 1.73e6], [3.9e5, 1.25e6, 1.9e6, 2.8e6]],
    [[1.82e5, 5.0e5, 9.2e5, 1.535e6], [3.45e5, 1.1e6, 1.68e6, 2.5e6]],
];
/// Newton steps for the division of the flow. Both drops are convex in the size of the flow, so it converges from outside.
const STEPS: usize = 5;
/// Absolute pressures between which a gas is believed, Pa: from empty to five times the report's greatest.
const GAS_PA: (f32, f32) = (2.0e4, 1.0e8);

/// Whether bypass valves 1 and 2 of a strut are open.
pub(crate) type Bypass = [bool; 2];

/// Dimensions of the strut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StrutForce {
    area_m2: f32,
    per_gas_volume: [f32; 2],
}

/// Absolute pressures of both gases, and what they are compared with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gases {
    pressure_pa: [f32; 2],
    per_charge: f32,
}

impl Gases {
    /// Of a strut whose pressures were measured, and whose gas has the pressure `charge` at the static position.
    pub fn measured(pressure: &StrutPressures<Gauge<f32>>, charge: Absolute<f32>) -> Self {
        Self {
            pressure_pa: [pressure.p2, pressure.p4].map(|p| believed(p.absolute().pa())),
            per_charge: 1.0 / believed(charge.pa()),
        }
    }
}

impl StrutForce {
    /// From a description that has been checked.
    pub fn new(vehicle: &VehicleDescription) -> Self {
        Self {
            area_m2: vehicle.piston_area_m2,
            per_gas_volume: [1.0 / vehicle.gas_volume_1_m3, 1.0 / vehicle.gas_volume_2_m3],
        }
    }

    /// Piston area, m2.
    pub fn area_m2(&self) -> f32 {
        self.area_m2
    }

    /// Moves the gases by a time, s (0 for the force now), at a speed, m/s, compression positive; returns the force on the body at its
    /// end, N, of the oil over the atmosphere.
    pub fn step(&self, gases: &mut Gases, speed_m_s: f32, open: Bypass, duration_s: f32) -> f32 {
        let flow = self.area_m2 * speed_m_s;
        // Within the step each gas is a stiffness: implicit, so that no step is too long.
        let [stiff_1, stiff_2] = self.stiffnesses(gases).map(|stiffness| stiffness * duration_s);
        let [p2, p4] = gases.pressure_pa;
        let [open_1, open_2] = open;
        // As the gases would divide it if nothing resisted; then Newton.
        let mut first = 0.2 * flow;
        let mut p1 = p2;
        for _ in 0..STEPS {
            let second = flow - first;
            let (drop_1, slope_1) = drop(0, open_1, first);
            let (drop_2, slope_2) = drop(1, open_2, second);
            let (drop_3, slope_3) = orifice(SPRING_VALVE_2, second);
            p1 = p2 + stiff_1 * first + drop_1;
            let apart = p1 - (p4 + stiff_2 * second + drop_2 + drop_3);
            first -= apart / (slope_1 + stiff_1 + slope_2 + slope_3 + stiff_2);
        }
        gases.pressure_pa = [p2 + stiff_1 * first, p4 + stiff_2 * (flow - first)].map(believed);
        self.area_m2 * Absolute(p1).gauge().pa()
    }

    /// Rise of each gas's pressure for the oil that enters it, Pa/m3.
    fn stiffnesses(&self, gases: &Gases) -> [f32; 2] {
        let ([p2, p4], [per_1, per_2]) = (gases.pressure_pa, self.per_gas_volume);
        [p2 * p2 * per_1, p4 * p4 * per_2].map(|stiffness| stiffness * gases.per_charge)
    }
}

/// A pressure within its bounds, Pa.
fn believed(pressure_pa: f32) -> f32 {
    let (least, most) = GAS_PA;
    let bounded = at_least(pressure_pa, least);
    if bounded < most { bounded } else { most }
}

/// Pressure drop of a damper with its bypass valve, Pa, and its slope, Pa s/m3.
fn drop(path: usize, open: bool, flow: f32) -> (f32, f32) {
    if open {
        orifice(BYPASS_2, flow)
    } else {
        pack(path, flow)
    }
}

/// The root of `d^2 = q^2 / c^2 (|d| + p_t)` with the sign of the flow `q`, and its slope.
fn orifice(coefficient_2: f32, flow: f32) -> (f32, f32) {
    let (square, size) = (flow * flow / coefficient_2, flow.abs());
    let root = libm::sqrtf(square * square + 4.0 * TRANSITION_PA * square);
    let drop = 0.5 * (square + root);
    // d = (s + root) / 2 with s = q^2 / c^2, of which the slope at rest is that of the laminar orifice.
    let laminar = libm::sqrtf(TRANSITION_PA / coefficient_2);
    let slope = size / coefficient_2
        + at_least(
            (square + 2.0 * TRANSITION_PA) * size / (coefficient_2 * at_least(root, 1.0)),
            0.0,
        );
    (if flow < 0.0 { -drop } else { drop }, at_least(slope, laminar))
}

/// The table of a pack, straight between its points and beyond the last.
fn pack(path: usize, flow: f32) -> (f32, f32) {
    let rebound = flow < 0.0;
    let table = PACKS_PA.get(path).and_then(|pack| pack.get(usize::from(rebound)));
    let [mut before, mut slope, mut drop] = [0.0, 0.0, 0.0];
    let (mut from, size) = (0.0, flow.abs());
    for (at, pressure) in FLOW_M3_S.into_iter().zip(table.into_iter().flatten()) {
        if from == 0.0 || size > from {
            slope = (pressure - before) / (at - from);
            drop = before + slope * (size - from);
        }
        (from, before) = (at, *pressure);
    }
    (if rebound { -drop } else { drop }, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: f32 = 1.963_495_4e-3;
    /// Of damping forces up to 3.5 kN.
    const RMS_N: f32 = 25.0;
    const WORST_N: f32 = 110.0;

    fn at_rest() -> Gases {
        let pressure = StrutPressures::splat(Gauge(2.0e6));
        Gases::measured(&pressure, Absolute(2.101_325e6))
    }

    fn force(speed_m_s: f32, open: Bypass) -> f32 {
        let strut = StrutForce::new(&VehicleDescription::default());
        strut.step(&mut at_rest(), speed_m_s, open, 0.0) - 2.0e6 * AREA
    }

    /// Both valves closed and equal gases: the flow divides so that both drops are equal. By hand at 0.2 m/s: 3.93e-4 m3/s is
    /// 1.87e-4 through pack 1 and 2.06e-4 through pack 2 and valve 3 (2.90e5 and 2.80e5 + 0.08e5 Pa).
    #[test]
    fn packs_share_the_flow_and_orifices_pass_it() {
        assert_eq!(force(0.0, [false, false]), 0.0);
        let closed = force(0.2, [false, false]);
        assert!((closed / AREA / 2.9e5 - 1.0).abs() < 0.02, "{} Pa", closed / AREA);
        // Pack 1 in rebound, by its table at the same flow: 5.96e5 Pa.
        let rebound = force(-0.2, [false, false]);
        assert!((-rebound / closed - 2.05).abs() < 0.05, "{rebound} N, {closed} N");
        // With both open most of it is the square law of the bypass valves: less than a tenth.
        let open = force(0.2, [true, true]);
        assert!(open > 0.0 && open < 0.1 * closed, "{open} N of {closed} N");
    }

    #[test]
    fn tables_pass_through_their_points_and_go_on_straight() {
        for (path, rebound) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let sign = if rebound == 1 { -1.0 } else { 1.0 };
            for (flow, pressure) in FLOW_M3_S.into_iter().zip(PACKS_PA[path][rebound]) {
                assert!((pack(path, sign * flow).0 - sign * pressure).abs() < 1.0);
            }
        }
        assert!((pack(0, 3.0e-3).0 - (1.73e6 + 0.69e6)).abs() < 10.0);
        assert!((pack(0, 0.6e-4).0 - 1.025e5).abs() < 10.0);
    }

    /// `q = c d / sqrt(|d| + p_t)`, the plant's law, solved for the flow.
    #[test]
    fn the_orifice_inverts_its_law() {
        for drop in [1.0e3_f32, 2.0e4, 3.0e5, -5.0e5] {
            let flow = 3.2e-6 * drop / (drop.abs() + TRANSITION_PA).sqrt();
            let (found, slope) = orifice(BYPASS_2, flow);
            assert!((found / drop - 1.0).abs() < 1e-4, "{found} Pa, expected {drop}");
            let step = 1e-3 * flow;
            let difference = (orifice(BYPASS_2, flow + step).0 - orifice(BYPASS_2, flow - step).0) / (2.0 * step);
            assert!((slope / difference - 1.0).abs() < 0.02, "{slope}, {difference}");
        }
    }

    /// At rest it is laminar: `dd / dq = sqrt(p_t) / c`, by hand 141.4 / 3.2e-6 Pa s/m3.
    #[test]
    fn the_orifice_is_laminar_at_rest() {
        let (drop, slope) = orifice(BYPASS_2, 0.0);
        assert_eq!(drop, 0.0);
        assert!((slope / 4.419e7 - 1.0).abs() < 1e-3, "{slope} Pa s/m3");
    }

    /// No step is too long: at its end the pressures are those that let the oil flow as it does, so that the force there is that of the gases
    /// as they are then. The oil that has come in is in the two gases, `V k dp / p^2` each.
    #[test]
    fn a_long_step_ends_in_balance() {
        let strut = StrutForce::new(&VehicleDescription::default());
        for (p2, p4) in [(2.0e6, 2.0e6), (2.6e6, 1.9e6), (1.7e6, 2.3e6)] {
            for (speed_m_s, open) in [
                (0.0, [true, true]),
                (0.03, [true, true]),
                (-0.05, [false, true]),
                (0.08, [false, false]),
            ] {
                let pressure = StrutPressures {
                    p1: Gauge(0.0),
                    p2: Gauge(p2),
                    p3: Gauge(0.0),
                    p4: Gauge(p4),
                };
                let before = Gases::measured(&pressure, Absolute(2.101_325e6));
                let mut gases = before;
                let force_n = strut.step(&mut gases, speed_m_s, open, 0.1);
                let then_n = strut.step(&mut gases.clone(), speed_m_s, open, 0.0);
                assert!(
                    (force_n - then_n).abs() < 2.0,
                    "{force_n} N, {then_n} N at {speed_m_s} m/s from {p2} and {p4} Pa"
                );
                let oil_m3 = |volume_m3: f32, gas: usize| {
                    let (from_pa, to_pa) = (before.pressure_pa[gas], gases.pressure_pa[gas]);
                    volume_m3 * 2.101_325e6 * (to_pa - from_pa) / (from_pa * from_pa)
                };
                let oil_m3 = oil_m3(1.0e-4, 0) + oil_m3(4.0e-4, 1);
                assert!(
                    (oil_m3 - AREA * speed_m_s * 0.1).abs() < 1e-8,
                    "{oil_m3} m3 at {speed_m_s} m/s"
                );
            }
        }
    }

    /// A slow compression by 10 mm with all valves open: both gases share one pressure, `p = k V / (V - A x)`.
    #[test]
    fn slow_compression_is_that_of_both_gases() {
        let strut = StrutForce::new(&VehicleDescription::default());
        let (mut gases, mut force_n) = (at_rest(), 0.0);
        for _ in 0..1_000 {
            force_n = strut.step(&mut gases, 0.01, [true, true], 0.001);
        }
        let expected = AREA * (2.101_325e6 * 5.0e-4 / (5.0e-4 - AREA * 0.01) - 101_325.0);
        assert!((force_n / expected - 1.0).abs() < 2e-3, "{force_n} N, {expected} N");
    }

    /// The forces of the simulated strut, whose equations are others (oil that is compressible, bubbles, warm gas, no common code): from p2, p4
    /// and the speed alone, over all settings and both motions.
    #[test]
    fn forces_are_those_of_the_simulated_strut() {
        let strut = StrutForce::new(&VehicleDescription::default());
        let (mut rows, mut error_2, mut worst) = (0, 0.0, 0.0_f32);
        for row in include_str!("strut_force/simulated.csv").lines().skip(1) {
            let mut numbers = row.split(',').map(|number| number.parse::<f32>().expect("a number"));
            let mut next = || numbers.next().expect("six columns");
            let (open, speed_m_s) = ([next() > 0.5, next() > 0.5], next());
            let [p1, p2, p4] = [next(), next(), next()];
            let pressure = StrutPressures {
                p1: Gauge(0.0),
                p2: Gauge(p2),
                p3: Gauge(0.0),
                p4: Gauge(p4),
            };
            let mut gases = Gases::measured(&pressure, Absolute(2.1e6));
            let error_n = strut.step(&mut gases, speed_m_s, open, 0.0) - AREA * p1;
            (rows, error_2, worst) = (rows + 1, error_2 + error_n * error_n, worst.max(error_n.abs()));
        }
        let rms_n = libm::sqrtf(error_2 / rows as f32);
        assert!(
            rows > 50 && rms_n < RMS_N && worst < WORST_N,
            "{rows} rows, {rms_n} N RMS, {worst} N"
        );
    }

    /// Nothing that can be read makes a force that is not a number.
    #[test]
    fn empty_gases_and_wild_speeds_stay_finite() {
        let strut = StrutForce::new(&VehicleDescription::default());
        for pressure in [-4.9e6, 0.0, 3.5e7] {
            for speed in [-50.0, -1.0e-9, 0.0, 50.0] {
                for open in [[true, true], [true, false], [false, true], [false, false]] {
                    let pressure = StrutPressures::splat(Gauge(pressure));
                    let mut gases = Gases::measured(&pressure, Absolute(0.0));
                    for _ in 0..20 {
                        assert!(strut.step(&mut gases, speed, open, 0.01).is_finite());
                    }
                }
            }
        }
    }
}
