//! Points at which the tables of laws are fitted.

pub mod fine;

/// Unit of the pressures below: 1 MPa in Pa.
const P: f64 = 1e6;
/// Displacement, m, dense about the static position.
pub const STROKE_M: &[f64] = &[
    -0.06, -0.04, -0.026, -0.017, -0.009, 0.0, 0.009, 0.017, 0.026, 0.04, 0.06,
];
/// Displacement over the whole travel, m.
pub const TRAVEL_M: &[f64] = &[-0.09, -0.06, -0.03, 0.0, 0.03, 0.06, 0.09];
/// The same, every 2 mm where stops are.
pub const STOPS_M: &[f64] = &stops();

/// Travel on either side of which stops are looked for, m, and the distance of the points, m.
const STOPS_END_M: f64 = 0.12;
const STOPS_EVERY_M: f64 = 0.002;
/// Points on either side.
const STOPS: usize = 60;

const fn stops() -> [f64; 2 * STOPS + 1] {
    let mut travel = [0.0; 2 * STOPS + 1];
    let mut k = 0;
    while k <= 2 * STOPS {
        travel[k] = k as f64 * STOPS_EVERY_M - STOPS_END_M;
        k += 1;
    }
    travel
}

/// Speed, m/s, dense about rest.
pub const SPEED_M_S: &[f64] = &[-0.6, -0.2, -0.05, -0.005, 0.0, 0.005, 0.05, 0.2, 0.6];
/// Gauge pressure of the main chamber, Pa.
pub const P1_PA: &[f64] = &[0.0, 2.0 * P, 4.0 * P, 6.0 * P, 9.0 * P, 13.0 * P];
/// Flow in a path, m3/s.
pub const FLOW_M3_S: &[f64] = &[-1.5e-3, -5e-4, -1.5e-4, 0.0, 1.5e-4, 5e-4, 1.5e-3];
/// Flow in the larger direction at which the points of a power of the flow end, m3/s.
const FLOW_END_M3_S: f64 = 2e-3;
/// The same, as densely as a parabola needs: on either side the squares of equal steps.
pub const FLOW_FINE_M3_S: &[f64] = &of_power(FLOW_END_M3_S);
/// Speed up to 1 m/s, as densely as a parabola needs.
pub const SPEED_FINE_M_S: &[f64] = &of_power(1.0);

/// Points of a power on either side.
const POWERS: usize = 20;

const fn of_power(end: f64) -> [f64; 2 * POWERS + 1] {
    let mut argument = [0.0; 2 * POWERS + 1];
    let mut k = 1;
    while k <= POWERS {
        let part = k as f64 / POWERS as f64;
        argument[POWERS + k] = end * part * part;
        argument[POWERS - k] = -argument[POWERS + k];
        k += 1;
    }
    argument
}

/// Pressure drop across a damper pack, Pa.
pub const PACK_PA: &[f64] = &[
    -2.5 * P,
    -1.6 * P,
    -P,
    -0.5 * P,
    -0.2 * P,
    0.0,
    0.2 * P,
    0.5 * P,
    0.8 * P,
    1.2 * P,
    2.0 * P,
];
/// Pressure drop across an open valve, Pa: every half octave.
pub const VALVE_PA: &[f64] = &[
    0.0,
    0.02 * P,
    0.03 * P,
    0.045 * P,
    0.07 * P,
    0.1 * P,
    0.14 * P,
    0.2 * P,
    0.28 * P,
    0.4 * P,
    0.56 * P,
    0.8 * P,
    1.1 * P,
    1.6 * P,
    2.2 * P,
    3.2 * P,
    4.5 * P,
    6.4 * P,
    9.0 * P,
    13.0 * P,
];
/// Displacement, m: every 4 mm where a strut mostly is.
pub const GROOVE_M: &[f64] = &[
    -0.1, -0.08, -0.064, -0.056, -0.048, -0.04, -0.036, -0.032, -0.028, -0.024, -0.02, -0.016, -0.012, -0.008, -0.004,
    0.0, 0.004, 0.008, 0.012, 0.016, 0.02, 0.024, 0.028, 0.032, 0.036, 0.04, 0.048, 0.056, 0.064, 0.08, 0.1,
];
/// Gauge pressure of the main chamber, Pa, dense where air shows.
pub const CHAMBER_PA: &[f64] = &[
    0.0,
    0.2 * P,
    0.45 * P,
    0.8 * P,
    1.3 * P,
    2.0 * P,
    4.0 * P,
    7.0 * P,
    13.0 * P,
];
/// The same, dense enough for a law that bends within a tenth of a megapascal.
pub const CHAMBER_FINE_PA: &[f64] = &[
    0.0,
    0.02 * P,
    0.04 * P,
    0.06 * P,
    0.08 * P,
    0.1 * P,
    0.14 * P,
    0.2 * P,
    0.28 * P,
    0.4 * P,
    0.56 * P,
    0.8 * P,
    1.1 * P,
    1.6 * P,
    2.2 * P,
    3.2 * P,
    4.5 * P,
    6.4 * P,
    9.0 * P,
    13.0 * P,
];
/// Gas volume over the static one.
pub const RELATIVE_VOLUME: &[f64] = &[0.3, 0.5, 0.7, 0.85, 1.0, 1.2, 1.5, 2.0];
/// Density of a gas over the static one: dense enough for what is a hundredth of the pressure.
pub const RELATIVE_DENSITY: &[f64] = &[
    0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5, 2.75, 3.0, 3.25, 3.5, 3.75, 4.0, 4.5, 5.0, 6.0,
];
/// Gas volume over the static one, dense enough for a power.
pub const RELATIVE_VOLUME_FINE: &[f64] = &[
    0.15, 0.2, 0.25, 0.3, 0.36, 0.43, 0.5, 0.6, 0.7, 0.85, 1.0, 1.2, 1.5, 2.0, 2.5, 3.0,
];
/// Acceleration, m/s2: a line.
pub const ACCELERATION_M_S2: &[f64] = &[-100.0, 100.0];
/// Time since the start, s: dense enough for an exponential of 0.1 s and more.
pub const TIME_S: &[f64] = &[
    0.0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.5, 10.0, 12.0, 14.0, 17.0, 20.0,
    24.0, 28.0, 34.0, 40.0, 48.0, 56.0, 67.0, 80.0, 110.0, 160.0, 220.0, 320.0, 450.0, 640.0, 900.0, 1300.0, 1800.0,
    2600.0, 3600.0,
];
/// What has changed of a relative gas volume: dense enough for a power.
pub const VOLUME_CHANGE: &[f64] = &[
    -0.9, -0.8, -0.7, -0.6, -0.5, -0.4, -0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0, 1.3, 1.6, 2.0, 3.0,
];
/// Pressure difference across a valve as its signal switches, Pa. The first is below all, so that the value at zero is free.
pub const EDGE_PA: &[f64] = &[-1.0, 0.0, 0.5 * P, P, 2.0 * P, 4.0 * P, 8.0 * P, 13.0 * P];
/// The same, dense enough for a parabola.
pub const EDGE_FINE_PA: &[f64] = &[
    0.0,
    0.5 * P,
    P,
    1.5 * P,
    2.0 * P,
    2.5 * P,
    3.0 * P,
    3.5 * P,
    4.0 * P,
    4.5 * P,
    5.0 * P,
    6.0 * P,
    7.0 * P,
    8.0 * P,
    9.0 * P,
    10.0 * P,
    11.5 * P,
    13.0 * P,
];
/// Thresholds that are tried of what depends on p1, and the largest p1, Pa.
pub const P1_THRESHOLDS_PA: &[f64] = &[2.0 * P, 4.0 * P, 5.0 * P, 6.0 * P, 8.0 * P, 13.0 * P];
/// The same of the pressure difference across a valve as its signal switches, Pa.
pub const EDGE_THRESHOLDS_PA: &[f64] = &[0.0, 0.1 * P, 0.3 * P, P, 2.0 * P, 4.0 * P, 13.0 * P];
/// Rate of flow, m3/s2: a line.
pub const FLOW_RATE_M3_S2: &[f64] = &[-1.0, 1.0];
/// Energy held by a gas over its static pressure times its static volume: a line.
pub const GAS_ENERGY: &[f64] = &[-1.0, 1.0];
/// Energy held by the oil of a pack, J, dense enough for a factor that falls by a fraction of itself.
pub const PACK_J: &[f64] = &energies();

/// Points of energies, the first of them after none, J, and each over the one before.
const ENERGIES: usize = 64;
const FIRST_J: f64 = 20.0;
const ENERGY_RATIO: f64 = 1.15;

const fn energies() -> [f64; ENERGIES + 1] {
    let mut energy = [0.0; ENERGIES + 1];
    let (mut k, mut next) = (1, FIRST_J);
    while k <= ENERGIES {
        energy[k] = next;
        next *= ENERGY_RATIO;
        k += 1;
    }
    energy
}

/// Force on the mount above the static one, N: a line.
pub const MOUNT_N: &[f64] = &[-1.0, 1.0];
/// The same for a mount that yields as it likes.
pub const MOUNT_TABLE_N: &[f64] = &[-1e4, -5e3, -2e3, 0.0, 2e3, 5e3, 1e4, 2e4];
/// What a reading has changed lately: a line.
pub const CHANGE: &[f64] = &[-1.0, 1.0];
/// Time of a drift at a constant rate, s: a line.
pub const DRIFT_S: &[f64] = &[0.0, 3600.0];
/// Force of the load cell, N.
pub const FORCE_N: &[f64] = &[0.0, 5e3, 1e4, 1.5e4, 2.5e4, 4e4];
/// Intervals into which one turn of an oscillation is divided. A sine is linear over each of them to a thousandth of its amplitude.
const TURN: usize = 64;
/// Phase of an oscillation, turns.
pub const PHASE_TURNS: &[f64] = &one_turn();

const fn one_turn() -> [f64; TURN + 1] {
    let mut turns = [0.0; TURN + 1];
    let mut k = 0;
    while k <= TURN {
        turns[k] = k as f64 / TURN as f64;
        k += 1;
    }
    turns
}

/// Rate of a reading: a line.
pub const RATE: &[f64] = &[-1.0, 1.0];
