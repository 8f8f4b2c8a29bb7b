//! Points of tables in fine steps, with which a law is fitted again that leaves much behind.

use super::P;

/// Speed of the strut, m/s.
pub const SPEED_M_S: &[f64] = &[
    -1.2, -0.9, -0.6, -0.4, -0.25, -0.15, -0.1, -0.05, -0.02, -0.01, -0.005, -0.002, 0.0, 0.002, 0.005, 0.01, 0.02,
    0.05, 0.1, 0.15, 0.25, 0.4, 0.6, 0.9, 1.2,
];
/// Gauge pressure, Pa.
pub const PRESSURE_PA: &[f64] = &[
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
    5.5 * P,
    6.0 * P,
    6.5 * P,
    7.0 * P,
    8.0 * P,
    9.0 * P,
    10.0 * P,
    12.0 * P,
    15.0 * P,
];
/// Flow in a path, m3/s.
pub const FLOW_M3_S: &[f64] = &[
    -2e-3, -1.4e-3, -1e-3, -7e-4, -5e-4, -3.5e-4, -2.5e-4, -1.5e-4, -1e-4, -6e-5, -3e-5, -1.5e-5, 0.0, 1.5e-5, 3e-5,
    6e-5, 1e-4, 1.5e-4, 2.5e-4, 3.5e-4, 5e-4, 7e-4, 1e-3, 1.4e-3, 2e-3,
];
/// Pressure drop across a damper pack, Pa.
pub const PACK_PA: &[f64] = &[
    -4.0 * P,
    -3.0 * P,
    -2.2 * P,
    -1.6 * P,
    -1.2 * P,
    -0.9 * P,
    -0.7 * P,
    -0.5 * P,
    -0.35 * P,
    -0.2 * P,
    -0.1 * P,
    -0.05 * P,
    0.0,
    0.05 * P,
    0.1 * P,
    0.2 * P,
    0.35 * P,
    0.5 * P,
    0.7 * P,
    0.9 * P,
    1.2 * P,
    1.6 * P,
    2.2 * P,
    3.0 * P,
    4.0 * P,
];
/// Gas volume over the static one.
pub const RELATIVE_VOLUME: &[f64] = &[
    0.15, 0.2, 0.25, 0.3, 0.36, 0.43, 0.5, 0.57, 0.64, 0.7, 0.76, 0.82, 0.88, 0.94, 1.0, 1.06, 1.12, 1.2, 1.3, 1.4,
    1.5, 1.7, 2.0, 2.5,
];
/// What has changed lately of a relative gas volume.
pub const VOLUME_CHANGE: &[f64] = &[
    -0.7, -0.5, -0.35, -0.25, -0.18, -0.12, -0.08, -0.05, -0.03, -0.015, 0.0, 0.015, 0.03, 0.05, 0.08, 0.12, 0.18,
    0.25, 0.35, 0.5, 0.8, 1.2,
];
/// Energy held by the oil of a pack, J.
pub const PACK_J: &[f64] = &[
    0.0, 50.0, 100.0, 200.0, 300.0, 500.0, 750.0, 1e3, 1.5e3, 2e3, 3e3, 4e3, 6e3, 8e3, 1.2e4, 2e4,
];
/// Force between strut and mount above the static one, N.
pub const MOUNT_N: &[f64] = &[
    -1e4, -7e3, -5e3, -3.5e3, -2.5e3, -1.8e3, -1.2e3, -800.0, -400.0, 0.0, 400.0, 800.0, 1.2e3, 1.8e3, 2.5e3, 3.5e3,
    5e3, 7e3, 1e4, 1.5e4, 2e4,
];
/// Force of the load cell, N.
pub const FORCE_N: &[f64] = &[
    0.0, 1e3, 2e3, 3e3, 4e3, 5e3, 6e3, 7e3, 7.5e3, 8e3, 8.5e3, 9e3, 1e4, 1.1e4, 1.2e4, 1.3e4, 1.5e4, 1.7e4, 2e4, 2.5e4,
    3e4,
];
/// What a pressure has changed lately, Pa.
pub const PRESSURE_CHANGE_PA: &[f64] = &[
    -4.0 * P,
    -2.5 * P,
    -1.6 * P,
    -P,
    -0.6 * P,
    -0.35 * P,
    -0.2 * P,
    -0.1 * P,
    -0.05 * P,
    0.0,
    0.05 * P,
    0.1 * P,
    0.2 * P,
    0.35 * P,
    0.6 * P,
    P,
    1.6 * P,
    2.5 * P,
    4.0 * P,
];
/// What a force has changed lately, N.
pub const FORCE_CHANGE_N: &[f64] = &[
    -8e3, -5e3, -3e3, -2e3, -1.2e3, -700.0, -400.0, -200.0, -100.0, 0.0, 100.0, 200.0, 400.0, 700.0, 1.2e3, 2e3, 3e3,
    5e3, 8e3,
];
/// Pressure difference across a valve as its signal switches, Pa. The first is below all, so that the value at zero is free.
pub const EDGE_PA: &[f64] = &[
    -1.0,
    0.0,
    0.1 * P,
    0.2 * P,
    0.35 * P,
    0.5 * P,
    0.75 * P,
    P,
    1.5 * P,
    2.0 * P,
    2.5 * P,
    3.0 * P,
    4.0 * P,
    5.0 * P,
    6.0 * P,
    8.0 * P,
    13.0 * P,
];
